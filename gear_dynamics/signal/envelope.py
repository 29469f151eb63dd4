"""Envelopes of a frequency band, and the choice of the band by its kurtosis."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import fft, signal

from gear_dynamics.signal.spectrum import amplitude_spectrum

SILENT = 1e-15
"""Mean square of a band, against the peak of the signal, that is rounding."""


class Band(NamedTuple):
    """A frequency band [Hz] and the kurtosis of its envelope, 0 for Gaussian noise."""

    low: float
    high: float
    kurtosis: float


def envelope(
    x: np.ndarray, rate: float, low: float, high: float, count: int | None = None
) -> np.ndarray:
    """Return the envelope: the magnitude of the analytic signal of the band [low, high).

    Parameters
    ----------
    x : ndarray, shape (n,) or (n, channels)
    rate, low, high : float
        Sample rate and limits of the band [Hz].
    count : int, optional
        Values that the envelope is given at, evenly over the same time; n by default. It moves
        no faster than the band is wide, so that fewer do.

    Returns
    -------
    ndarray, shape (count,) or (count, channels)

    Raises
    ------
    ValueError
        If the band is empty or goes beyond half of the rate.
    """
    if not 0 <= low < high <= rate / 2:
        raise ValueError(
            f'band is {low:g} to {high:g} Hz: it must rise and lie within 0 and {rate / 2:g} Hz'
        )
    count = len(x) if count is None else count
    first, end = _lines(len(x), rate, low, high)
    # Only the magnitude is wanted, so that the band may as well begin at frequency 0.
    band = fft.rfft(x, axis=0)[first:end]
    return np.abs(fft.ifft(band, count, axis=0)) * (2 * count / len(x))


def _lines(length: int, rate: float, low: float, high: float) -> tuple[int, int]:
    """Return the first line of a band and the one after its last; without the mean."""
    return max(1, int(np.ceil(low * length / rate))), int(np.ceil(high * length / rate))


def envelope_spectrum(
    x: np.ndarray, rate: float, low: float, high: float, *, window: str = 'hann'
) -> tuple[np.ndarray, np.ndarray]:
    """Return the peak amplitude spectrum of the envelope of a band, its mean removed.

    A tone A (1 + m cos(2 pi f t)) in the band gives a line A m at f. McFadden and Smith 1984,
    Vibration monitoring of rolling element bearings by the high-frequency resonance technique.

    Returns
    -------
    frequency : ndarray, shape (m,)
        [Hz], up to twice the width of the band or half of the rate.
    amplitude : ndarray, shape of frequency, or that and channels
    """
    first, end = _lines(len(x), rate, low, high)
    count = min(len(x), fft.next_fast_len(4 * (end - first)))
    demodulated = envelope(x, rate, low, high, count)
    demodulated -= demodulated.mean(axis=0)
    return amplitude_spectrum(demodulated, rate * count / len(x), window=window)


def spectral_kurtosis(
    x: np.ndarray, rate: float, length: int = 256
) -> tuple[np.ndarray, np.ndarray]:
    """Return the spectral kurtosis <|X|^4> / <|X|^2>^2 - 2 over segments, overlapping by half.

    0 for stationary Gaussian noise, -1 for a steady tone, large where there are impacts.
    Antoni 2006, The spectral kurtosis: a useful tool for characterising non-stationary signals.

    Parameters
    ----------
    x : ndarray, shape (n,)
    rate : float
        [Hz]
    length : int
        Samples in a segment.

    Returns
    -------
    frequency, kurtosis : ndarray, shape (length // 2 + 1,)
    """
    _, _, lines = signal.stft(x, nperseg=length, boundary=None, padded=False)
    square = np.abs(lines) ** 2
    kurtosis = (square**2).mean(axis=-1) / np.maximum(
        square.mean(axis=-1) ** 2, np.finfo(float).tiny
    )
    return fft.rfftfreq(length, 1 / rate), kurtosis - 2


def kurtogram(x: np.ndarray, rate: float, levels: int = 6) -> list[Band]:
    """Return all bands of the kurtogram with the kurtosis of each.

    The bands are the halves and thirds of Antoni 2007 (Fast computation of the kurtogram): level
    k cuts 0 to rate / 2 into 2^k bands, and between two levels into 3 2^(k-1). Each band's
    envelope comes from its lines of one Fourier transform instead of a tree of filters.

    Parameters
    ----------
    x : ndarray, shape (n,)
    rate : float
        [Hz]
    levels : int
        Deepest level; bands of fewer than 64 samples are left out.
    """
    return [
        Band(float(edges[index]), float(edges[index + 1]), float(value))
        for edges, kurtosis in _kurtosis_by_width(x, rate, levels)
        for index, value in enumerate(kurtosis)
    ]


def _kurtosis_by_width(
    x: np.ndarray, rate: float, levels: int
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield edges [Hz] and kurtosis of the bands of each width, the widest first."""
    centred = x - np.mean(x)
    lines = fft.rfft(centred / max(np.max(np.abs(centred)), np.finfo(centred.dtype).tiny))[1:]
    halves = {2**k for k in range(levels + 1)}
    thirds = {3 * 2**k for k in range(levels - 1)}
    for count in sorted(halves | thirds):
        width = len(lines) // count
        if width < 64:
            return
        signals = fft.ifft(lines[: width * count].reshape(count, width), axis=1)
        square = signals.real**2 + signals.imag**2
        mean = np.maximum(square.mean(axis=1), SILENT)
        kurtosis = (square**2).mean(axis=1) / mean**2 - 2
        yield np.arange(count + 1) * width * rate / len(x), kurtosis


def most_impulsive_band(x: np.ndarray, rate: float, levels: int = 6) -> Band:
    """Return the band of the kurtogram with the greatest kurtosis; the arguments are its."""
    best = Band(0.0, rate / 2, -np.inf)
    for edges, kurtosis in _kurtosis_by_width(x, rate, levels):
        index = int(np.argmax(kurtosis))
        if kurtosis[index] > best.kurtosis:
            best = Band(float(edges[index]), float(edges[index + 1]), float(kurtosis[index]))
    return best
