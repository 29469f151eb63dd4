"""File operations that some systems lack, and what stands in for them there."""

from __future__ import annotations

import os
import shutil
import threading
from collections.abc import Sequence
from pathlib import Path

_PRIVATE = getattr(os, 'O_CLOEXEC', 0) | getattr(os, 'O_BINARY', 0)
READ = os.O_RDONLY | _PRIVATE | getattr(os, 'O_NONBLOCK', 0)
"""Flags of `os.open` to read bytes; a pipe that nobody writes to does not block."""

WRITE_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _PRIVATE
"""Flags of `os.open` to write bytes into a file that must not exist."""

_seeking = threading.Lock()


def pread(file: int, length: int, offset: int) -> bytes:
    """Return bytes of a file from an offset on; other threads may do the same."""
    if hasattr(os, 'pread'):
        return os.pread(file, length, offset)
    with _seeking:
        os.lseek(file, offset, os.SEEK_SET)
        return os.read(file, length)


def writev(file: int, parts: Sequence[bytes | memoryview]) -> int:
    """Write parts one after the other; return the number of bytes that were written."""
    if hasattr(os, 'writev'):
        return os.writev(file, parts)
    return os.write(file, b''.join(parts))


def sync_data(file: int) -> None:
    """Put the content of a file on the disk."""
    getattr(os, 'fdatasync', os.fsync)(file)


def sync_folder(folder: Path) -> None:
    """Make new and renamed files in a folder outlive a power loss, where a folder can be synced."""
    if os.name == 'nt':
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def free_space(path: Path) -> int:
    """Return what is free on the disk of a file or folder [bytes]."""
    return shutil.disk_usage(path).free
