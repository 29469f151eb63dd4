"""Calibrated one-sided amplitude spectra of many channels at once.

Arrays hold one row a sample and one column a channel.
"""

from __future__ import annotations

import functools

import numpy as np
import numpy.typing as npt
from scipy import fft, signal

from gear_dynamics.signal.arguments import positive, real_array, whole_number
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
    segment : ndarray, shape (n, ...)
    window : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n // 2 + 1, ...)
    """
    weights = (window / window.sum()).reshape(-1, *(1,) * (segment.ndim - 1))
    lines = fft.rfft(segment * weights, axis=0)
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


def line_amplitudes(segment: np.ndarray) -> np.ndarray:
    """Return the peak amplitudes of all lines of a segment without a window, shape (lines, ...)."""
    return amplitudes(mean_square_lines(segment, np.ones(len(segment))), len(segment))


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
    x: npt.ArrayLike,
    rate: float,
    *,
    window: str = 'hann',
    length: int | None = None,
    overlap: float = 0.5,
    averaging: str = 'linear',
    averages: int = 8,
    scale: str = 'peak',
    axis: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the averaged one-sided amplitude spectrum (Welch 1967), in the channel's unit.

    Parameters
    ----------
    x : array_like
    rate : float
        Samples per second, or per revolution for orders.
    window : str
        Name of a SciPy window; `flattop` reads any sine within 0.1 %.
    length : int, optional
        Samples in a segment; all of x by default.
    overlap : float
        Overlap of consecutive segments, as a fraction: at least 0, below 1.
    averaging : str
        `linear`: the mean over all segments; `exponential`: the newest weighs 1 / averages.
    averages : int
        Memory of the exponential average, in segments.
    scale : str
        `peak` or `rms`.
    axis : int
        Axis of the samples.

    Returns
    -------
    frequency : ndarray, shape (length // 2 + 1,)
    amplitude : ndarray
        Of the shape of x, with one line a frequency along `axis`.

    Raises
    ------
    ValueError
        If an argument is not allowed, a value of x is not finite, or x is shorter than one segment.
    """
    x = real_array(x, axis=axis)
    rate = positive(rate, 'rate')
    length = len(x) if length is None else whole_number(length, 'length', 2)
    if len(x) < max(length, 2):
        raise ValueError(f'{len(x)} samples are fewer than one segment of {max(length, 2)}')
    columns = x.reshape(len(x), -1)
    weights = window_samples(window, length)
    average = PowerAverage(averaging, averages)
    hop = hop_of(length, overlap)
    for segment in SegmentBuffer(length, hop, columns.shape[1]).push(columns):
        average.add(mean_square_lines(segment, weights))
    assert average.mean_square is not None
    result = amplitudes(average.mean_square, length, scale).reshape((-1, *x.shape[1:]))
    return fft.rfftfreq(length, 1 / rate), np.moveaxis(result, 0, axis)
