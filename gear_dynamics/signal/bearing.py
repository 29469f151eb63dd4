"""Squared envelope spectra in orders, and how far the lines of a defect stand out in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import fft, ndimage

from gear_dynamics.signal.arguments import positive, real_series
from gear_dynamics.signal.demodulation import envelope
from gear_dynamics.signal.order_tracking import resample_by_phase

HARMONICS = 3
"""Harmonics of a defect that must all stand out."""

PADDING = 4
"""Lines of the spectrum in one line's width, for the place of a maximum between two lines."""

_NEIGHBOURS = 41
"""Line widths over which the surroundings of a line are taken."""


class EnvelopeOrders(NamedTuple):
    """The amplitude spectrum of a squared envelope, in orders of a shaft.

    Attributes
    ----------
    order : ndarray, shape (n,)
        Events in a revolution, evenly spaced from 0.
    amplitude : ndarray, shape (n,)
        Peak amplitude [unit squared].
    level : ndarray, shape (n,)
        Amplitude over the median of its surroundings [dB].
    width : float
        Half width of a line [orders]: lines nearer to each other are not told apart.
    """

    order: np.ndarray
    amplitude: np.ndarray
    level: np.ndarray
    width: float


def envelope_orders(
    x: npt.ArrayLike,
    rate: float,
    revolutions: npt.ArrayLike,
    low: float,
    high: float,
    highest_order: float,
) -> EnvelopeOrders:
    """Return the spectrum of the squared envelope of a band, by angle.

    Borghesani, Pennacchi, Randall, Sawalhi and Ricci 2013 (Application of cepstrum pre-whitening
    for the diagnosis of bearing faults under variable speed conditions) take it by angle, so that
    lines stay sharp while the speed changes.

    Parameters
    ----------
    x : array_like, shape (n,)
    rate : float
        [Hz]
    revolutions : array_like, shape (n,)
        Angle of the shaft [revolutions], rising.
    low, high : float
        Band [Hz].
    highest_order : float
        Of interest.

    Raises
    ------
    ValueError
        If there is more than one channel, the lengths differ, or a value is not finite.
    """
    x, rate = real_series(x), positive(rate, 'rate')
    revolutions = real_series(revolutions, 'revolutions')
    if len(revolutions) != len(x):
        raise ValueError(f'revolutions has {len(revolutions)} values: it must have {len(x)}, as x')
    turned = float(revolutions[-1] - revolutions[0])
    speed = turned / (len(x) / rate)
    # The envelope is kept at a rate that its highest line of interest needs.
    count = min(len(x), fft.next_fast_len(int(3.2 * highest_order * speed * len(x) / rate) + 64))
    # The square of an envelope holds frequencies up to the width of its band.
    lines = int((high - low) / rate * len(x)) + 1
    kept = min(len(x), max(count, fft.next_fast_len(2 * lines)))
    square = envelope(x, rate, low, high, kept) ** 2
    square = _decimate(square - square.mean(), count)
    angle = np.interp(np.arange(count) * (len(x) / count), np.arange(len(x)), revolutions)
    points = fft.next_fast_len(int(np.ceil(2.5 * highest_order)))
    _, even = resample_by_phase(square, angle, points)
    window = np.hanning(len(even) + 1)[:-1]
    padded = fft.next_fast_len(PADDING * len(even), real=True)
    even = even - even.mean()
    amplitude = 2 / window.sum() * np.abs(fft.rfft(even * window, padded))
    order = np.arange(len(amplitude)) * (points / padded)
    kept = order <= highest_order
    order, amplitude = order[kept], amplitude[kept]
    step = padded / len(even)
    size = int(_NEIGHBOURS * step) | 1
    floor = ndimage.median_filter(amplitude, size, mode='nearest')
    level = 20 * np.log10(np.maximum(amplitude, 1e-300) / np.maximum(floor, 1e-300))
    return EnvelopeOrders(order, amplitude, level, 1.5 * points / len(even))


def _decimate(x: np.ndarray, count: int) -> np.ndarray:
    """Return x at `count` even places, low-passed for them."""
    lines = fft.rfft(x)[: count // 2 + 1]
    return fft.irfft(lines, count) * (count / len(x))


class DefectLine(NamedTuple):
    """The order at which a defect was looked for and found best.

    Attributes
    ----------
    order : float
    level : float
        Least height of the first three harmonics over their surroundings [dB].
    amplitude : float
        Geometric mean of their amplitudes [unit squared].
    """

    order: float
    level: float
    amplitude: float = 0.0


def find_defect(
    spectrum: EnvelopeOrders,
    order: float,
    slip: float,
    explained: Sequence[float] | np.ndarray = (),
) -> DefectLine:
    """Return the order near `order` whose first three harmonics stand out most.

    Parameters
    ----------
    spectrum : EnvelopeOrders
    order : float
        Of the defect without slip.
    slip : float
        Relative tolerance.
    explained : sequence of float
        Orders of lines that have another cause; no harmonic may lie on one of them.

    Returns
    -------
    DefectLine
        Level NaN if every order within the tolerance is explained by something else.
    """
    step = spectrum.order[1]
    tolerance = max(slip * order, 0.5 * spectrum.width)
    count = int(np.ceil(2 * tolerance / (step / HARMONICS))) + 1
    candidates = np.linspace(order - tolerance, order + tolerance, count)
    harmonics = np.outer(candidates, np.arange(1, HARMONICS + 1))
    levels = np.interp(harmonics, spectrum.order, spectrum.level)
    if len(explained):
        known = np.sort(np.asarray(explained, dtype=float))
        place = np.searchsorted(known, harmonics)
        below = np.abs(harmonics - known[np.maximum(place - 1, 0)])
        above = np.abs(harmonics - known[np.minimum(place, len(known) - 1)])
        levels[np.minimum(below, above) < 0.7 * spectrum.width] = -np.inf
    least = levels.min(axis=1)
    best = int(np.argmax(least))
    if not np.isfinite(least[best]):
        return DefectLine(order, float('nan'))
    return _refined(spectrum, float(candidates[best]), float(least[best]))


def _refined(spectrum: EnvelopeOrders, order: float, level: float) -> DefectLine:
    """Return the order that fits the maxima at its harmonics best, weighted by their power."""
    places, amplitudes = [], []
    for harmonic in range(1, HARMONICS + 1):
        reach = np.abs(spectrum.order - harmonic * order) <= 0.5 * spectrum.width
        near = np.flatnonzero(reach)
        if not len(near):
            near = np.array([int(np.argmin(np.abs(spectrum.order - harmonic * order)))])
        top = near[int(np.argmax(spectrum.amplitude[near]))]
        places.append(spectrum.order[top])
        amplitudes.append(spectrum.amplitude[top])
    numbers = np.arange(1, HARMONICS + 1)
    weights = np.square(amplitudes) + 1e-300
    fitted = np.sum(weights * numbers * places) / np.sum(weights * numbers**2)
    mean = np.exp(np.mean(np.log(np.maximum(amplitudes, 1e-300))))
    return DefectLine(float(fitted), level, float(mean))
