"""Systems without the calls of Linux: what stands in for them does the same."""

import os

import pytest

from gear_dynamics import portable
from gear_dynamics.parameters.run_settings import RunSettings


@pytest.fixture(params=[True, False], ids=['all calls', 'few calls'])
def system(request, monkeypatch):
    if not request.param:
        for name in ('pread', 'writev', 'fdatasync', 'sysconf'):
            monkeypatch.delattr(os, name)
    return request.param


def test_bytes_are_written_and_read_at_any_offset(system, tmp_path):
    path = tmp_path / 'file'
    file = os.open(path, portable.WRITE_NEW)
    assert portable.writev(file, [b'one ', memoryview(b'two '), b'three']) == 13
    portable.sync_data(file)
    os.close(file)
    portable.sync_folder(tmp_path)
    with pytest.raises(FileExistsError):
        os.open(path, portable.WRITE_NEW)
    file = os.open(path, portable.READ)
    assert portable.pread(file, 3, 4) == b'two'
    assert portable.pread(file, 3, 0) == b'one'
    assert portable.pread(file, 3, 100) == b''
    os.close(file)


def test_memory_that_is_not_known_limits_nothing(system):
    settings = RunSettings()
    assert settings.sample_count(1.0, 104) == 51200
    if not system:
        assert settings.sample_count(1e9, 104) == 51_200_000_000_000


def test_the_free_space_of_a_disk_is_that_of_the_system(tmp_path):
    disk = os.statvfs(tmp_path)
    assert abs(portable.free_space(tmp_path) - disk.f_bavail * disk.f_frsize) < 1 << 30
