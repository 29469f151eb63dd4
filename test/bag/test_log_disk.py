"""Disks that fill, refuse or go away: logging stops cleanly, says so, and resumes."""

import contextlib
import errno
import itertools
import os
import resource
import shutil
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import bag_support
import pytest

import gear_dynamics.bag.writer
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.reader import read_messages
from gear_dynamics.bag.writer import LogWriter

ROOT = Path(__file__).resolve().parents[2]


def wait_for(writer, state, patience=20.0):
    end = time.monotonic() + patience
    while writer.status().state != state:
        assert time.monotonic() < end, writer.status()
        time.sleep(0.05)
    return writer.status()


def feed(writer, published, state):
    """Hand messages in until the writer is in the state."""
    end = time.monotonic() + 30.0
    for message in itertools.cycle(published):
        bag_support.hand_in(writer, message)
        if writer.status().state == state:
            return writer.status()
        if writer.status().waiting > 200:
            time.sleep(0.01)
        assert time.monotonic() < end, writer.status()
    raise AssertionError('there is nothing to hand in')


@contextlib.contextmanager
def tmpfs(folder, size, options=''):
    """Mount a small disk; skip the test where that is not permitted."""
    folder.mkdir()
    if shutil.which('mount') is None:
        pytest.skip('there is no mount command')
    done = subprocess.run(
        ['mount', '-t', 'tmpfs', '-o', f'size={size}{options}', 'tmpfs', str(folder)],
        capture_output=True,
        text=True,
    )
    if done.returncode:
        pytest.skip(f'a tmpfs cannot be mounted: {done.stderr.strip()}')
    try:
        yield folder
    finally:
        subprocess.run(['umount', '--lazy', str(folder)], check=True)


def test_a_disk_that_fills_stops_the_log_whole_and_room_resumes_it(tmp_path):
    published = bag_support.messages(200)
    with tmpfs(tmp_path / 'disk', '40m') as disk:
        ballast = disk / 'ballast'
        ballast.write_bytes(bytes(16 << 20))
        writer = LogWriter(disk, {}, compression='none', free_floor=0.0)
        stopped = feed(writer, published, 'stopped')
        assert 'are free' in stopped.reason
        first = log_info(stopped.path)
        assert first.whole
        assert first.messages > 0
        ballast.unlink()
        wait_for(writer, 'writing')
        for message in published:
            bag_support.hand_in(writer, message)
        final = writer.close()
        assert final.reason == ''
        assert final.dropped > 0
        info = log_info(final.path)
        assert info.whole
        assert len(info.files) > len(first.files)
        assert info.messages == final.messages
        assert not info.damage


def test_another_process_that_fills_the_disk(tmp_path):
    """Then the write itself fails, and the file ends with its last whole chunk."""
    published = bag_support.messages(200)
    with tmpfs(tmp_path / 'disk', '24m') as disk:
        writer = LogWriter(disk, {}, compression='none', free_floor=0.0)
        for message in published:
            bag_support.hand_in(writer, message)
        with contextlib.suppress(OSError), (disk / 'ballast').open('wb') as stream:
            while True:
                stream.write(bytes(1 << 16))
                stream.flush()
        stopped = feed(writer, published, 'stopped')
        final = writer.close()
        assert 'No space left' in stopped.reason or 'are free' in stopped.reason
        found = [m.data for m in read_messages(final.path, on_damage=lambda damage: None)]
        assert len(found) == final.messages
        assert found[: len(published)] == [m.data for m in published][: len(found)]


def test_a_read_only_disk_and_then_a_writable_one(tmp_path):
    published = bag_support.messages(10)
    with tmpfs(tmp_path / 'disk', '40m', ',ro') as disk:
        writer = LogWriter(disk, {}, free_floor=0.0)
        for message in published:
            bag_support.hand_in(writer, message)
        status = wait_for(writer, 'stopped')
        assert 'Read-only file system' in status.reason
        subprocess.run(['mount', '-o', 'remount,rw', str(disk)], check=True)
        wait_for(writer, 'writing')
        for message in published:
            bag_support.hand_in(writer, message)
        final = writer.close()
        assert (final.reason, final.messages) == ('', len(published))
        assert log_info(final.path).messages == len(published)


def test_a_folder_that_is_deleted_is_noticed_and_made_again(tmp_path):
    published = bag_support.messages(10)
    writer = LogWriter(tmp_path, {}, free_floor=0.0)
    folder = Path(writer.status().path)
    for message in published:
        bag_support.hand_in(writer, message)
    shutil.rmtree(folder)
    status = wait_for(writer, 'stopped')
    assert 'was deleted' in status.reason
    wait_for(writer, 'writing')
    for message in published:
        bag_support.hand_in(writer, message)
    final = writer.close()
    assert final.reason == ''
    assert log_info(folder).messages == len(published)


def test_a_directory_that_goes_away_is_not_made_again(tmp_path):
    """It may have been the mount point of a disk that was pulled out."""
    directory = tmp_path / 'disk'
    writer = LogWriter(directory, {}, free_floor=0.0)
    shutil.rmtree(directory)
    wait_for(writer, 'stopped')
    time.sleep(1.5)
    assert writer.status().state == 'stopped'
    assert not directory.exists()
    directory.mkdir()
    wait_for(writer, 'writing')
    assert writer.close().reason == ''


def test_a_directory_that_cannot_be_made_stops_the_log_and_nothing_else(tmp_path):
    (tmp_path / 'file').write_text('in the way')
    writer = LogWriter(tmp_path / 'file' / 'logs', {}, free_floor=0.0)
    for message in bag_support.messages(3):
        bag_support.hand_in(writer, message)
    status = wait_for(writer, 'stopped')
    assert 'Not a directory' in status.reason
    final = writer.close()
    assert final.state == 'off'
    assert (final.messages, final.dropped) == (0, len(bag_support.messages(3)))


@pytest.mark.skipif(os.geteuid() == 0, reason='root may write anywhere')
def test_no_permission(tmp_path):
    tmp_path.chmod(0o500)
    writer = LogWriter(tmp_path, {}, free_floor=0.0)
    assert 'Permission denied' in wait_for(writer, 'stopped').reason
    tmp_path.chmod(0o700)
    wait_for(writer, 'writing')
    writer.close()


def test_no_permission_in_a_process_that_is_not_root(tmp_path):
    """Root may write anywhere, so that a child gives its rights up."""
    if os.geteuid() != 0:
        pytest.skip('only root can become somebody else')
    tmp_path.chmod(0o755)
    code = f"""
        import os, sys
        sys.path.insert(0, {str(ROOT)!r})
        from gear_dynamics.bag.writer import LogWriter
        os.setuid(65534)
        print(LogWriter({str(tmp_path)!r}, {{}}, free_floor=0.0).status().reason)
    """
    done = subprocess.run(
        [sys.executable, '-c', textwrap.dedent(code)], capture_output=True, text=True
    )
    if 'Permission denied' in done.stderr:
        pytest.skip('that user may not read the interpreter')
    assert 'Permission denied' in done.stdout, done.stderr


def test_a_limit_on_the_file_size_stops_at_the_last_whole_chunk(tmp_path):
    """As a quota does: the write fails though the disk has room."""
    published = bag_support.messages(200)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    writer = LogWriter(tmp_path, {}, compression='none', free_floor=0.0)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (3_000_000, limits[1]))
        stopped = feed(writer, published, 'stopped')
        assert 'File too large' in stopped.reason
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    wait_for(writer, 'writing')
    for message in published:
        bag_support.hand_in(writer, message)
    final = writer.close()
    assert final.reason == ''
    info = log_info(final.path)
    assert info.whole
    assert info.messages == final.messages
    assert len(info.files) >= 2


def test_an_error_of_the_sync_in_the_background_is_told(tmp_path, monkeypatch):
    errors = [OSError(errno.EIO, os.strerror(errno.EIO))]
    sync = os.fdatasync

    def fail_once(file):
        if errors:
            raise errors.pop()
        sync(file)

    published = bag_support.messages(10)
    monkeypatch.setattr(gear_dynamics.bag.writer, 'SYNC_INTERVAL', 1e6)
    monkeypatch.setattr(os, 'fdatasync', fail_once)
    writer = LogWriter(tmp_path, {}, free_floor=0.0)
    for message in published:
        bag_support.hand_in(writer, message)
    final = writer.close()
    assert 'Input/output error' in final.reason
    info = log_info(final.path)
    assert (info.whole, info.messages) == (True, final.messages)


def test_a_sync_that_hangs_is_told(tmp_path, monkeypatch):
    released = threading.Event()
    monkeypatch.setattr(os, 'fdatasync', lambda file: released.wait(20))
    writer = LogWriter(tmp_path, {}, free_floor=0.0)
    try:
        end = time.monotonic() + 20
        while writer.status().syncing <= 1.0:
            assert time.monotonic() < end
            time.sleep(0.05)
        assert writer.status().state == 'writing'
    finally:
        released.set()
    final = writer.close()
    assert (final.reason, final.syncing) == ('', 0.0)


def test_the_floor_on_free_space_is_on_by_default(tmp_path):
    """Where less than 5 GB is free, nothing is written."""
    with tmpfs(tmp_path / 'disk', '100m') as disk:
        writer = LogWriter(disk, {})
        status = wait_for(writer, 'stopped')
        assert 'the floor is 5.000 GB' in status.reason
        assert not list(disk.glob('*/*.mcap'))
        writer.close()
