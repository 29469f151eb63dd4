"""Open a file of a log: unpack it if it is compressed, and recognise other kinds of logs."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from mcap.writer import MCAP0_MAGIC

from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.decompress import ZSTD_MAGIC, DecompressionError, decompress_file
from gear_dynamics.bag.walk import find_chunk
from gear_dynamics.portable import READ, pread

_FOREIGN = {
    b'SQLite format 3\0': 'this is an SQLite bag: `ros2 bag convert` makes an MCAP bag of it',
    b'#ROSBAG V': 'this is a bag of ROS 1: `rosbags-convert` makes a ROS 2 bag of it',
}
"""First bytes of other kinds of logs, and what to do with them."""


def open_file(path: Path) -> int:
    """Open a file; a compressed one is unpacked to a temporary file first.

    Raises
    ------
    LogError
        If it does not decompress.
    OSError
        If it cannot be opened, or there is no room for it.
    """
    file = os.open(path, READ)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise LogError(f'{path}: this is no file')
    if pread(file, len(ZSTD_MAGIC), 0) != ZSTD_MAGIC:
        return file
    with os.fdopen(file, 'rb') as compressed, tempfile.TemporaryFile() as plain:
        try:
            decompress_file(compressed, plain)
        except DecompressionError as error:
            raise LogError(f'{path}: {error}') from None
        plain.flush()
        return os.dup(plain.fileno())


def foreign_kind(file: int, size: int) -> str:
    """Return what a file is if nothing in it is of an MCAP file; empty if something is.

    Parameters
    ----------
    file, size : int
        Descriptor, and bytes of the file.
    """
    head = pread(file, 16, 0)
    if head.startswith(MCAP0_MAGIC) or find_chunk(file, 0, size) is not None:
        return ''
    hints = (hint for magic, hint in _FOREIGN.items() if head.startswith(magic))
    return next(hints, 'this is no MCAP file')
