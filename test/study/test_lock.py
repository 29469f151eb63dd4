import errno
import fcntl
import os

import pytest

from gear_dynamics.study.cache import alone
from gear_dynamics.study.command import main


def assert_held(output, study):
    words = f'{output}: another study {study} is at work there: wait for its end, or name another'
    with pytest.raises(ValueError, match=words), alone(output, study):
        pass


def test_lock_is_one_study_s_in_one_folder_and_leaves_nothing(tmp_path):
    with alone(tmp_path, 'basins'):
        assert_held(tmp_path, 'basins')
        with alone(tmp_path, 'response'), alone(tmp_path / 'other', 'basins'):
            assert_held(tmp_path, 'basins')
    with alone(tmp_path, 'basins'):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ['other']


def test_file_without_a_lock_is_no_hindrance(tmp_path):
    (tmp_path / '.basins_lock').touch()
    with alone(tmp_path, 'basins'):
        assert_held(tmp_path, 'basins')
    assert not any(tmp_path.iterdir())


def test_lock_on_a_file_that_was_removed_meanwhile_does_not_count(tmp_path, monkeypatch):
    """Another study ends, and removes the file, between opening and locking."""
    path, lock = tmp_path / '.basins_lock', fcntl.flock

    def removed_before(*arguments):
        monkeypatch.setattr(fcntl, 'flock', lock)
        path.unlink()
        return lock(*arguments)

    monkeypatch.setattr(fcntl, 'flock', removed_before)
    with alone(tmp_path, 'basins'):
        assert path.exists()
        assert_held(tmp_path, 'basins')


def test_file_system_without_locks_is_told_in_one_line(tmp_path, monkeypatch, capsys):
    def none(*arguments):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, 'flock', none)
    assert main(['basins', '--output', str(tmp_path)]) == 2
    error = f'study: {tmp_path}: No locks available: name another directory with --output\n'
    assert capsys.readouterr().err == error


@pytest.mark.skipif(os.geteuid() == 0, reason='root may write everywhere')
def test_folder_that_cannot_be_written_is_told_in_one_line(tmp_path, capsys):
    tmp_path.chmod(0o555)
    assert main(['basins', '--output', str(tmp_path)]) == 2
    error = f'study: {tmp_path}/.basins_lock: Permission denied: name another directory with '
    assert capsys.readouterr().err == f'{error}--output\n'
