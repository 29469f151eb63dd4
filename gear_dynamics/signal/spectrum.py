"""Calibrated one-sided amplitude spectra of many channels at once.

Arrays hold one row a sample and one column a channel.
"""

from __future__ import annotations

import functools

import numpy as np
from scipy import fft, signal

from gear_dynamics.signal.segments import SegmentBuffer, hop_of

AVERAGINGS = ('linear', 'exponential')
SCALES = ('peak', 'rms')

HFT90D = (1.0, 1.942604, 1.340318, 0.440811, 0.043097)
"""Flat-top window of 0.0039 dB greatest error, that is 0.05 % (Heinzel, Ruediger and Schilling
2002, Spectrum and spectral density estimation by the DFT, table C.9). SciPy's own flat-top is
0.11 % low half way between two lines."""


@functools.lru_cache(maxsize=16)
def window_samples(name: str, length: int) -> np.ndarray:
    """Return a window for spectra (periodic form), by its SciPy name; `flattop` is HFT90D.

    Raises
    ------
    ValueError
        If SciPy knows no such window, or it needs parameters of its own.
    """
    if name == 'flattop':
        window = signal.windows.general_cosine(length, HFT90D, sym=False)
    else:
        try:
            window = signal.get_window(name, length)
        except ValueError as error:
            raise ValueError(f'window is {name!r}: SciPy says: {error}') from error
    window.flags.writeable = False  # it is kept for the next call
    return window


def mean_square_lines(segment: np.ndarray, window: np.ndarray) -> np.ndarray:
    """Return the one-sided mean-square spectrum of a segment.

    A sine of amplitude A on a line gives A^2 / 2 there, a constant C gives C^2 at line 0.

    Parameters
    ----------
    segment : ndarray, shape (n, channels)
    window : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n // 2 + 1, channels)
    """
    lines = fft.rfft(segment * (window / window.sum())[:, np.newaxis], axis=0)
    square = lines.real**2 + lines.imag**2
    square[1 : (len(segment) + 1) // 2] *= 2
    return square


def amplitudes(mean_square: np.ndarray, length: int, scale: str = 'peak') -> np.ndarray:
    """Return amplitudes, peak or RMS, of a mean-square spectrum of segments of `length`.

    The lines at zero and at the Nyquist frequency are no pairs; there, peak and RMS agree.

    Raises
    ------
    ValueError
        If the scale is neither peak nor rms.
    """
    if scale not in SCALES:
        raise ValueError(f'scale is {scale!r}: it must be peak or rms')
    result = np.sqrt(mean_square)
    if scale == 'peak':
        result[1 : (length + 1) // 2] *= np.sqrt(2.0)
    return result


class PowerAverage:
    """Average of mean-square spectra, linear over all or exponential.

    Linear is the plain mean of all spectra added. Exponential gives the newest the weight
    1 / count, once `count` of them have been added, and is the plain mean until then.
    """

    def __init__(self, averaging: str, count: int) -> None:
        if averaging not in AVERAGINGS:
            raise ValueError(f'averaging is {averaging!r}: it must be linear or exponential')
        self._count = count
        self._limit = count if averaging == 'exponential' else None
        self.added = 0
        self.mean_square: np.ndarray | None = None

    def add(self, mean_square: np.ndarray) -> None:
        """Take one more spectrum."""
        self.added += 1
        if self.mean_square is None:
            self.mean_square = mean_square.copy()
            return
        weight = 1 / (min(self.added, self._limit) if self._limit else self.added)
        self.mean_square += weight * (mean_square - self.mean_square)

    @property
    def due(self) -> bool:
        """Whether `count` more spectra were added since the last result was due."""
        return self.added > 0 and self.added % self._count == 0

    def restart_linear(self) -> None:
        """Begin a new linear average; an exponential one goes on for ever."""
        if self._limit is None:
            self.added, self.mean_square = 0, None


def amplitude_spectrum(
    x: np.ndarray,
    rate: float,
    *,
    window: str = 'hann',
    length: int | None = None,
    overlap: float = 0.5,
    averaging: str = 'linear',
    averages: int = 8,
    scale: str = 'peak',
) -> tuple[np.ndarray, np.ndarray]:
    """Return the averaged one-sided amplitude spectrum (Welch 1967), in the channel's unit.

    Parameters
    ----------
    x : ndarray, shape (n,) or (n, channels)
    rate : float
        Samples per second, or per revolution for orders.
    window : str
        Name of a SciPy window; `flattop` reads any sine within 0.1 %.
    length : int, optional
        Samples in a segment; all of x by default.
    overlap : float
        Share of a segment that the next one has in common with it, [0, 1).
    averaging : str
        `linear`: the mean over all segments; `exponential`: the newest weighs 1 / averages.
    averages : int
        Memory of the exponential average, in segments.
    scale : str
        `peak` or `rms`.

    Returns
    -------
    frequency : ndarray, shape (length // 2 + 1,)
    amplitude : ndarray, shape of frequency, or that and channels

    Raises
    ------
    ValueError
        If an argument is not allowed, or x is shorter than one segment.
    """
    length = len(x) if length is None else length
    if len(x) < max(length, 2):
        raise ValueError(f'{len(x)} samples are fewer than one segment of {length}')
    columns = np.asarray(x, dtype=float).reshape(len(x), -1)
    weights = window_samples(window, length)
    average = PowerAverage(averaging, averages)
    for segment in SegmentBuffer(length, hop_of(length, overlap), columns.shape[1]).push(columns):
        average.add(mean_square_lines(segment, weights))
    assert average.mean_square is not None
    result = amplitudes(average.mean_square, length, scale)
    return fft.rfftfreq(length, 1 / rate), result.reshape((-1, *np.shape(x)[1:]))
