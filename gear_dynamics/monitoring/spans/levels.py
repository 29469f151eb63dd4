"""Level and shape of a channel in time, its clipping, and its velocity."""

from __future__ import annotations

import numpy as np
from scipy import fft

from gear_dynamics.signal.statistics import Moments

STATISTICS = ('mean', 'rms', 'std', 'peak', 'crest_factor', 'kurtosis')

VELOCITY_BAND = (10.0, 1000.0)
"""Band of the velocity RMS [Hz] (ISO 10816-1)."""

FEWEST_PERIODS = 3
"""Periods of the lowest frequency that a velocity RMS needs."""

_POWER = {'m/s2': -1, 'm/s': 0, 'm': 1}
"""Power of the circular frequency that makes a velocity of each unit."""


def level_indicators(values: np.ndarray, rate: float, unit: str) -> dict[str, float]:
    """Return the statistics, the share of clipped samples and, where it exists, the velocity.

    Parameters
    ----------
    values : ndarray, shape (n,)
    rate : float
        [Hz]
    unit : str
        SI unit of the values.
    """
    moments = Moments()
    moments.add(values)
    found = moments.indicators()
    result = {name: float(found[name]) for name in STATISTICS}
    result['clipped'] = clipped_share(values)
    if unit in _POWER:
        result['velocity_rms'] = velocity_rms(values, rate, unit)
    return result


def clipped_share(values: np.ndarray) -> float:
    """Return the share of samples at a limit of the converter or amplifier.

    A side counts as clipped where its extreme value stands at least 5 times, and more than 5
    times as often as all values of the next percent of the range: a quantised signal that is not
    clipped meets its extreme values more rarely than those beside them.
    """
    low, high = float(np.min(values)), float(np.max(values))
    if low == high:
        return 0.0
    count = 0
    for side, extreme in ((values, high), (-values, -low)):
        at = int(np.count_nonzero(side == extreme))
        if at < 5:
            continue
        below = side[side < extreme]
        # At least the next value that a coarse converter has.
        reach = max(0.01 * (high - low), 1.5 * (extreme - float(below.max())))
        if at > 5 * np.count_nonzero(below >= extreme - reach):
            count += at
    return count / len(values)


def velocity_rms(values: np.ndarray, rate: float, unit: str) -> float:
    """Return the RMS of the velocity from 10 to 1000 Hz [m/s]; NaN if the signal is too short.

    Integrated in the frequency domain under a Hann window, whose loss of power is made good.

    Parameters
    ----------
    values : ndarray, shape (n,)
    rate : float
        [Hz]; where half of it is less than 1000 Hz, the band ends there.
    unit : str
        m/s2, m/s or m.
    """
    low, high = VELOCITY_BAND
    if len(values) / rate < FEWEST_PERIODS / low or rate / 2 <= low:
        return float('nan')
    window = np.hanning(len(values) + 1)[:-1]
    lines = fft.rfft((values - values.mean()) * window)
    frequency = fft.rfftfreq(len(values), 1 / rate)
    band = (frequency >= low) & (frequency <= high)
    power = np.abs(lines[band]) ** 2 * (2 * np.pi * frequency[band]) ** (2 * _POWER[unit])
    return float(np.sqrt(2 * power.sum() / (len(values) * np.sum(window**2))))
