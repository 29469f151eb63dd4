"""Cuts a stream of rows into overlapping segments, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt


class SegmentBuffer:
    """Collect rows as they come and hand out every complete segment once.

    Parameters
    ----------
    length : int
        Rows in a segment.
    hop : int
        Rows from the start of one segment to the start of the next, 1 to length.
    columns : int
        Columns of a row.
    dtype : data type
        Of the segments.
    """

    def __init__(
        self, length: int, hop: int, columns: int, dtype: npt.DTypeLike = np.float64
    ) -> None:
        if not 1 <= hop <= length:
            raise ValueError(f'hop is {hop}: it must be from 1 to the segment length {length}')
        self._rows = np.empty((length, columns), dtype)
        self._hop = hop
        self._filled = 0

    def push(self, rows: np.ndarray) -> Iterator[np.ndarray]:
        """Take rows, shape (any, columns), and yield segments, shape (length, columns).

        A segment is valid until the next one is asked for; copy what must live longer.
        """
        length = len(self._rows)
        start = 0
        while start < len(rows):
            taken = min(length - self._filled, len(rows) - start)
            self._rows[self._filled : self._filled + taken] = rows[start : start + taken]
            self._filled += taken
            start += taken
            if self._filled == length:
                yield self._rows
                self._filled = length - self._hop
                self._rows[: self._filled] = self._rows[self._hop :].copy()


def hop_of(length: int, overlap: float) -> int:
    """Return the hop [rows] of segments that overlap by the fraction `overlap` of their length.

    Raises
    ------
    ValueError
        If the overlap is not in [0, 1).
    """
    if not 0 <= overlap < 1:
        raise ValueError(f'overlap is {overlap:g}: it must be at least 0 and below 1')
    return max(1, round(length * (1 - overlap)))
