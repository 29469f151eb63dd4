"""Low-pass and decimation of a stream, block by block; NumPy alone, so that it loads at once."""

from __future__ import annotations

import functools

import numpy as np

PASS_BAND = 0.4
"""Edge of the pass band, as a fraction of the decimated rate; content above 1 - PASS_BAND = 0.6 of
that rate is aliased into it."""

ATTENUATION = 60.0
"""Least attenuation of content that is aliased into the pass band [dB]."""


@functools.lru_cache(maxsize=4)
def lowpass_taps(ratio: int) -> np.ndarray:
    """Return a linear-phase low-pass for decimation: a sinc under a Kaiser window.

    Order and shape of the window are those of Kaiser (1974) for `ATTENUATION` and for a
    transition from `PASS_BAND` to 1 - `PASS_BAND` of the decimated rate. SciPy has the same
    formulas; they are written here because SciPy takes longer to load than the `sim` may wait.

    Parameters
    ----------
    ratio : int
        Input samples for one output sample.

    Returns
    -------
    ndarray
        Of odd length and sum 1.
    """
    attenuation = ATTENUATION + 2  # the formulas are up to 1 dB off
    transition = 2 * np.pi * (1 - 2 * PASS_BAND) / ratio
    half = int(np.ceil((attenuation - 7.95) / (2.285 * transition) / 2))
    beta = 0.1102 * (attenuation - 8.7)
    taps = np.sinc(np.arange(-half, half + 1) / ratio) * np.kaiser(2 * half + 1, beta)
    return taps / taps.sum()


class Decimator:
    """Low-pass, then every `ratio`-th sample.

    The filter has zero phase: each output belongs to the sample number returned with it, and is
    complete only when half the filter's length of later samples has arrived.

    Parameters
    ----------
    ratio : int
        Input samples for one output sample; 1 passes all through unchanged.
    """

    def __init__(self, ratio: int) -> None:
        self.ratio = ratio
        self._past: np.ndarray | None = None
        self._begin = 0

    def reset(self) -> None:
        """Forget the past; the next block begins as if its first sample had lasted for ever."""
        self._past = None

    @property
    def delay(self) -> int:
        """Samples by which what is handed out is behind what was fed."""
        return len(lowpass_taps(self.ratio)) // 2 if self.ratio > 1 else 0

    def feed(self, block: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray]:
        """Filter a block and return the output samples that are now complete.

        Parameters
        ----------
        block : ndarray, shape (n, channels)
            With n at least 1.
        first : int
            Number of the first sample in the stream.

        Returns
        -------
        numbers : ndarray of int
            Numbers of the output samples: multiples of `ratio`.
        values : ndarray, shape (len(numbers), channels)
        """
        taps = lowpass_taps(self.ratio) if self.ratio > 1 else np.ones(1)
        length = len(taps)
        if self._past is None:
            self._past = np.repeat(block[:1], length - 1, axis=0)
            self._begin = first
        samples = np.concatenate([self._past, block])
        self._past = samples[len(samples) - (length - 1) :]
        delay = length // 2
        earliest = max(first - delay, self._begin)
        numbers = np.arange(-(-earliest // self.ratio) * self.ratio, first + len(block) - delay)
        numbers = numbers[:: self.ratio]
        windows = np.lib.stride_tricks.sliding_window_view(samples, length, axis=0)
        return numbers, windows[numbers - (first - delay)] @ taps
