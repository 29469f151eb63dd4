"""Envelopes of a frequency band, and the choice of the band by its kurtosis."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import fft, signal

from gear_dynamics.signal.arguments import positive, real_array, real_series, whole_number
from gear_dynamics.signal.spectrum import amplitude_spectrum
from gear_dynamics.signal.statistics import ratio

TAPER = 0.01
"""Fraction of a record, at each end, over which it is tapered before its kurtogram: the jump from
the last to the first sample would look like an impact."""

HIGHEST = 0.4
"""Upper edge of the kurtogram, as a fraction of the sample rate; anti-alias filters act above."""

LEAST_DENSITY = 1e-3
"""Power density below which a band is not chosen, as a fraction of the mean density."""

FEWEST_LINES = 64
"""Fewest Fourier lines, and so samples of the envelope, in a band of the kurtogram."""


class Band(NamedTuple):
    """A frequency band [Hz] and the kurtosis of its envelope, 0 for Gaussian noise."""

    low: float
    high: float
    kurtosis: float


def envelope(
    x: npt.ArrayLike,
    rate: float,
    low: float,
    high: float,
    count: int | None = None,
    *,
    axis: int = 0,
) -> np.ndarray:
    """Return the envelope: the magnitude of the analytic signal of the band [low, high).

    Parameters
    ----------
    x : array_like
    rate, low, high : float
        Sample rate and limits of the band [Hz].
    count : int, optional
        Samples of the envelope, evenly over the same time; all n by default. The envelope varies
        no faster than the band is wide, so that fewer are enough.
    axis : int
        Axis of the samples.

    Returns
    -------
    ndarray
        Of the shape of x, with `count` samples along `axis`.

    Raises
    ------
    ValueError
        If the band is empty or goes beyond half of the rate, or a value of x is not finite.
    """
    x = real_array(x, axis=axis)
    count = len(x) if count is None else whole_number(count, 'count')
    return np.moveaxis(_envelope(x, rate, low, high, count), 0, axis)


def _envelope(x: np.ndarray, rate: float, low: float, high: float, count: int) -> np.ndarray:
    first, end = _lines(len(x), rate, low, high)
    # Only the magnitude is wanted, so that the band may as well begin at frequency 0.
    band = fft.rfft(x, axis=0)[first:end]
    return np.abs(fft.ifft(band, count, axis=0)) * (2 * count / len(x))


def _lines(length: int, rate: float, low: float, high: float) -> tuple[int, int]:
    """Return the first line of a band and the one after its last; without the mean."""
    positive(rate, 'rate')
    if not 0 <= low < high <= rate / 2:
        raise ValueError(
            f'band is {low:g} to {high:g} Hz: it must rise and lie within 0 and {rate / 2:g} Hz'
        )
    first, end = max(1, int(np.ceil(low * length / rate))), int(np.ceil(high * length / rate))
    if end <= first:
        raise ValueError(
            f'band is {low:g} to {high:g} Hz: {length} samples at {rate:g} Hz have no line in it'
        )
    return first, end


def envelope_spectrum(
    x: npt.ArrayLike,
    rate: float,
    low: float,
    high: float,
    *,
    window: str = 'hann',
    axis: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the peak amplitude spectrum of the envelope of a band, its mean removed.

    A tone A (1 + m cos(2 pi f t)) in the band gives a line A m at f. McFadden and Smith 1984,
    Vibration monitoring of rolling element bearings by the high-frequency resonance technique.

    Returns
    -------
    frequency : ndarray, shape (m,)
        [Hz], up to twice the width of the band or half of the rate.
    amplitude : ndarray
        Of the shape of x, with m lines along `axis`.
    """
    x = real_array(x, axis=axis)
    first, end = _lines(len(x), rate, low, high)
    count = min(len(x), fft.next_fast_len(4 * (end - first)))
    demodulated = _envelope(x, rate, low, high, count)
    demodulated -= demodulated.mean(axis=0)
    frequency, amplitude = amplitude_spectrum(demodulated, rate * count / len(x), window=window)
    return frequency, np.moveaxis(amplitude, 0, axis)


def spectral_kurtosis(
    x: npt.ArrayLike, rate: float, length: int = 256, *, axis: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the spectral kurtosis of segments that overlap by half.

    It is <|X|^4> / <|X|^2>^2 - 2 - |r|^2, where r is the correlation of a line with its own
    complex conjugate that the window leaves in white noise: 1 at zero and at the Nyquist
    frequency, where lines are real, and near 0 elsewhere. The value is 0 for stationary Gaussian
    noise at every line, -1 for a steady tone, and large where there are impacts.
    Antoni 2006, The spectral kurtosis: a useful tool for characterising non-stationary signals.

    Parameters
    ----------
    x : array_like
    rate : float
        [Hz]
    length : int
        Samples in a segment.
    axis : int
        Axis of the samples.

    Returns
    -------
    frequency : ndarray, shape (length // 2 + 1,)
    kurtosis : ndarray
        Of the shape of x, with one value a frequency along `axis`.
    """
    x = real_array(x, axis=axis)
    length = whole_number(length, 'length', 2)
    if len(x) < length:
        raise ValueError(f'{len(x)} samples are fewer than one segment of {length}')
    _, _, lines = signal.stft(x, nperseg=length, boundary=None, padded=False, axis=0)
    square = np.abs(lines) ** 2
    kurtosis = ratio((square**2).mean(axis=-1), square.mean(axis=-1) ** 2)
    weights = signal.get_window('hann', length) ** 2
    conjugate = np.abs(fft.fft(weights)[2 * np.arange(length // 2 + 1) % length]) / weights.sum()
    expected = 2 + (conjugate**2).reshape(-1, *(1,) * (x.ndim - 1))
    return fft.rfftfreq(length, 1 / rate), np.moveaxis(kurtosis - expected, 0, axis)


def kurtogram(
    x: npt.ArrayLike, rate: float, levels: int = 6, *, least_width: float = 0.0
) -> list[Band]:
    """Return the bands of the kurtogram that can be chosen, the widest first.

    The bands are the halves and thirds of Antoni 2007 (Fast computation of the kurtogram): level
    k cuts 0 to 0.4 rate into 2^k bands, and between two levels into 3 2^(k-1); the full band is
    level 0. Each band's envelope comes from its lines of one Fourier transform of the record,
    tapered over 1 % at each end, instead of a tree of filters; the ends do not count. Bands of
    less than 1e-3 of the mean power density are left out: their kurtosis is that of leakage and
    rounding.

    Parameters
    ----------
    x : array_like, shape (n,)
    rate : float
        [Hz]
    levels : int
        Deepest level; bands of fewer than 64 lines are left out.
    least_width : float
        Narrowest band [Hz]: three times the repetition frequency of the impacts, where it is known.
    """
    series = real_series(x)
    positive(rate, 'rate')
    return [
        Band(float(edges[index]), float(edges[index + 1]), float(kurtosis[index]))
        for edges, kurtosis in _kurtosis_by_width(series, rate, levels)
        if edges[1] - edges[0] >= least_width or len(edges) == 2
        for index in np.flatnonzero(~np.isnan(kurtosis))
    ]


def _kurtosis_by_width(
    x: np.ndarray, rate: float, levels: int
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield edges [Hz] and kurtosis of the bands of each width; NaN for an empty band."""
    centred = x - np.mean(x)
    scale = np.max(np.abs(centred))
    if scale == 0:
        return
    taper = signal.windows.tukey(len(x), 2 * TAPER).astype(x.dtype)
    upper = int(HIGHEST * len(x))
    lines = fft.rfft(centred / scale * taper)[1 : upper + 1]
    density = np.mean(lines.real**2 + lines.imag**2)
    halves = {2**k for k in range(levels + 1)}
    thirds = {3 * 2**k for k in range(levels - 1)}
    for count in sorted(halves | thirds):
        width = len(lines) // count
        if width < FEWEST_LINES and count > 1:
            return
        signals = fft.ifft(lines[: width * count].reshape(count, width), axis=1)
        square = signals.real**2 + signals.imag**2
        # What a tone leaks from the ends of the record into another band stays at the ends.
        ends = 2 + math.ceil(TAPER * width)
        square = square[:, ends : max(width - ends, ends + 1)]
        mean = square.mean(axis=1)
        # The mean of |ifft|^2 over a band is its mean line power over the number of lines.
        there = mean * width >= LEAST_DENSITY * density
        kurtosis = ratio((square**2).mean(axis=1), mean**2) - 2
        yield np.arange(count + 1) * width * rate / len(x), np.where(there, kurtosis, np.nan)


def most_impulsive_band(
    x: npt.ArrayLike, rate: float, levels: int = 6, *, least_width: float = 0.0
) -> Band:
    """Return the band of the kurtogram with the greatest kurtosis; it takes the same arguments.

    A constant has no such band: the full one is returned with kurtosis NaN.
    """
    bands = kurtogram(x, rate, levels, least_width=least_width)
    return max(bands, key=lambda band: band.kurtosis, default=Band(0, HIGHEST * rate, float('nan')))
