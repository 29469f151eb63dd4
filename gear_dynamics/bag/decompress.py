"""The one place where bytes are decompressed: never into more than the caller allows."""

from __future__ import annotations

import io
import os
from typing import BinaryIO

import lz4.frame  # type: ignore[import-untyped]
import zstandard

LARGEST = 1 << 27
"""Bytes of a chunk or a message beyond which it is refused, lest it exhaust the memory."""

FREE_SIZE = 1 << 25
"""Bytes up to which any ratio of compression is believed: a constant signal shrinks to nothing."""

LARGEST_RATIO = 1000
"""Ratio of compression that is believed beyond `FREE_SIZE`."""

ZSTD_MAGIC = b'\x28\xb5\x2f\xfd'
"""First bytes of a zstd frame; no CDR message and no MCAP file begins like this."""

_BLOCK = 1 << 20
_SMALL = 1 << 23


class DecompressionError(ValueError):
    """Bytes do not decompress, or into too much; the message says which and the limit."""


def decompress(
    compression: str, data: bytes | memoryview, size: int
) -> bytes | bytearray | memoryview:
    """Return what compressed bytes hold.

    Parameters
    ----------
    compression : str
        '', 'lz4' or 'zstd', as a chunk of an MCAP file names it.
    data : bytes or memoryview
        One frame.
    size : int
        How many bytes it must give.

    Raises
    ------
    DecompressionError
        If the frame is damaged or gives another size, or the size is out of proportion.
    """
    if compression not in ('', 'lz4', 'zstd'):
        raise DecompressionError(f'its compression {compression[:20]!r} is not known')
    check_size(size, len(data))
    result: bytes | bytearray | memoryview
    try:
        if compression == 'zstd':
            claimed = zstandard.frame_content_size(data)
            if claimed not in (-1, size):
                raise DecompressionError(f'it claims {claimed} bytes instead of {size}')
            result = zstandard.ZstdDecompressor().decompress(data, max_output_size=size)
        elif compression == 'lz4':
            result = _decompress_lz4(data, size)
        else:
            result = data
    except (zstandard.ZstdError, RuntimeError, EOFError, MemoryError) as error:
        raise DecompressionError(f'it does not decompress: {error}') from None
    if len(result) != size:
        raise DecompressionError(f'it holds {len(result)} bytes instead of {size}')
    return result


def _decompress_lz4(data: bytes | memoryview, size: int) -> bytes | bytearray:
    """Return the bytes of a frame, at most one more than `size`, so that a longer one shows.

    In one go, the lz4 package takes ten times as long for a large frame; in blocks, for a small
    one.
    """
    if size <= _SMALL:
        plain = lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=size + 1)
        return bytes(plain)
    result = bytearray()
    with lz4.frame.LZ4FrameFile(io.BytesIO(data)) as reader:
        while len(result) <= size and (block := reader.read(min(_BLOCK, size + 1 - len(result)))):
            result += block
    return result


def decompress_message(data: bytes | memoryview) -> bytes:
    """Return the message in a zstd frame, as rosbag2 writes it with `--compression-mode message`.

    Raises
    ------
    DecompressionError
        If the frame is damaged, does not state its size, or is too large.
    """
    try:
        size = zstandard.frame_content_size(data)
    except zstandard.ZstdError as error:
        raise DecompressionError(f'it does not decompress: {error}') from None
    if size < 0:
        raise DecompressionError('its zstd frame does not state its size')
    return bytes(decompress('zstd', data, size))


def decompress_file(source: BinaryIO, target: BinaryIO) -> None:
    """Decompress a zstd file, as rosbag2 writes it with `--compression-mode file`.

    Raises
    ------
    DecompressionError
        If it is damaged or grows out of proportion; what came before is in `target`.
    OSError
        If there is no room.
    """
    compressed = os.fstat(source.fileno()).st_size
    allowed = FREE_SIZE + LARGEST_RATIO * compressed
    reader = zstandard.ZstdDecompressor().stream_reader(source, read_across_frames=True)
    written = 0
    try:
        while block := reader.read(_BLOCK):
            written += len(block)
            if written > allowed:
                raise DecompressionError(
                    f'{compressed} compressed bytes give more than {allowed}, which is the limit'
                )
            target.write(block)
    except (zstandard.ZstdError, MemoryError) as error:
        raise DecompressionError(f'it does not decompress: {error}') from None


def check_size(size: int, compressed: int) -> None:
    """Refuse a size that is too large, or out of proportion to its compressed bytes.

    Raises
    ------
    DecompressionError
        With the size and the limit.
    """
    allowed = min(LARGEST, max(FREE_SIZE, LARGEST_RATIO * compressed))
    if size > allowed:
        raise DecompressionError(
            f'it claims {size} bytes in {compressed}: the limit is {allowed} bytes'
        )
