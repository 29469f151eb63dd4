"""WAV files: 8, 16, 24 and 32 bit integers and floats, as shares of full scale."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from gear_dynamics.recordings.table import BLOCK, RecordingError, RowTable

_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE


class WavTable(RowTable):
    """A RIFF WAVE file; its columns are its channels, named 1, 2, ..."""

    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._path = path
        with path.open('rb') as stream:
            kind, channels, rate, self._width = self._format(stream)
        self.columns = tuple(str(number) for number in range(1, channels + 1))
        self._rate = float(rate)
        self._kind = kind
        self.relative = kind == _PCM
        self._frame = channels * self._width
        if self._frame == 0 or (kind, self._width) not in _READERS:
            raise RecordingError(
                f'{self.name} holds samples of {8 * self._width} bit of kind {kind}: integers of '
                '8 to 32 bit and floats can be read'
            )

    def rate(self, column: str) -> float:
        """Return the sample rate of the header [Hz]."""
        return self._rate

    def rows(self, columns: Sequence[str]) -> Iterator[np.ndarray]:
        """Yield blocks of rows, as shares of full scale."""
        wanted = [list(self.columns).index(column) for column in columns]
        read = _READERS[self._kind, self._width]
        with self._path.open('rb') as stream:
            stream.seek(self._offset)
            left = self._size // self._frame
            while left:
                data = stream.read(min(left, BLOCK) * self._frame)
                count = len(data) // self._frame
                if count == 0:
                    break
                left -= count
                values = read(np.frombuffer(data[: count * self._frame], np.uint8))
                yield values.reshape(count, -1)[:, wanted]

    def _format(self, stream) -> tuple[int, int, int, int]:  # type: ignore[no-untyped-def]
        """Return kind, channels, rate and bytes of a sample; note where the samples are."""
        head = stream.read(12)
        if head[:4] not in (b'RIFF', b'RF64') or head[8:12] != b'WAVE':
            raise RecordingError(f'{self.name} is no WAV file')
        found = None
        large = None
        total = os.fstat(stream.fileno()).st_size
        while len(chunk := stream.read(8)) == 8:
            name, size = struct.unpack('<4sI', chunk)
            if name == b'ds64':
                content = stream.read(size)
                large = struct.unpack_from('<Q', content, 8)[0]
            elif name == b'fmt ':
                content = stream.read(size)
                kind, channels, rate, _, _, bits = struct.unpack_from('<HHIIHH', content)
                if kind == _EXTENSIBLE and len(content) >= 26:
                    kind = struct.unpack_from('<H', content, 24)[0]
                found = kind, channels, rate, (bits + 7) // 8
            elif name == b'data':
                if size == 0xFFFFFFFF and large is not None:
                    size = large
                self._offset = stream.tell()
                self._size = min(size, total - self._offset)
                if self._size < size:
                    self.notes[''] = (
                        f'{self.name} is cut short: {size - self._size} bytes are missing'
                    )
                break
            else:
                stream.seek(size, os.SEEK_CUR)
            if size % 2:
                stream.seek(1, os.SEEK_CUR)
        if found is None or not hasattr(self, '_offset'):
            raise RecordingError(f'{self.name} is no complete WAV file')
        return found


def _unsigned(data: np.ndarray) -> np.ndarray:
    return (data.astype(np.float64) - 128) / 128


def _three_bytes(data: np.ndarray) -> np.ndarray:
    # The lowest byte stays 0, so that the sign is where a 32 bit integer has it.
    wide = np.zeros((len(data) // 3, 4), np.uint8)
    wide[:, 1:] = data.reshape(-1, 3)
    return wide.view('<i4')[:, 0] / 2**31


_READERS = {
    (_PCM, 1): _unsigned,
    (_PCM, 2): lambda data: data.view('<i2') / 2**15,
    (_PCM, 3): _three_bytes,
    (_PCM, 4): lambda data: data.view('<i4') / 2**31,
    (_FLOAT, 4): lambda data: data.view('<f4').astype(np.float64),
    (_FLOAT, 8): lambda data: data.view('<f8').astype(np.float64),
}
