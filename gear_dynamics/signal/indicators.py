"""Gear condition indicators of synchronous averages.

Definitions differ between papers; each docstring says which one is used. Signals are arrays of
shape (points,) or (points, channels): one revolution of the wheel, as `separate` splits it.
"""

from __future__ import annotations

import numpy as np
from scipy import fft

from gear_dynamics.signal.statistics import normalised_moment, ratio, rms
from gear_dynamics.signal.synchronous import Parts

NOTHING = 1e-4
"""A difference signal below this share of the regular one holds rounding noise only."""


def mesh_amplitudes(average: np.ndarray, teeth: int) -> np.ndarray:
    """Return the peak amplitudes of the mesh harmonics 1, 2, ..., shape (harmonics, ...)."""
    return 2 / len(average) * np.abs(fft.rfft(average, axis=0)[teeth::teeth])


def fm0(average: np.ndarray, teeth: int) -> np.ndarray:
    """Return peak-to-peak value over the sum of the amplitudes of the mesh harmonics.

    Peak amplitudes, so that a sine at the mesh frequency gives 2 (Stewart 1977; Zakrajsek 1993).
    """
    return ratio(np.ptp(average, axis=0), mesh_amplitudes(average, teeth).sum(axis=0))


def fm4(difference: np.ndarray) -> np.ndarray:
    """Return the kurtosis of the difference signal, not excess (Stewart 1977)."""
    return normalised_moment(difference, 4)


def m6a(difference: np.ndarray) -> np.ndarray:
    """Return the sixth moment of the difference signal over variance^3 (Martin 1989)."""
    return normalised_moment(difference, 6)


def m8a(difference: np.ndarray) -> np.ndarray:
    """Return the eighth moment of the difference signal over variance^4 (Martin 1989)."""
    return normalised_moment(difference, 8)


class RunningKurtosis:
    """Fourth moment over the square of the mean variance of the record so far.

    On residual signals this is NA4 (Zakrajsek, Townsend and Decker 1993, NASA TM 105950), on
    `mesh_envelope` NB4 (Zakrajsek, Handschuh and Decker 1994, NASA TM 106467). As damage grows it
    keeps rising where FM4 falls back, since the early, healthy variances stay in the mean.
    """

    def __init__(self) -> None:
        self._count = 0
        self._variance_sum = np.zeros(())

    def add(self, signal: np.ndarray) -> np.ndarray:
        """Take the next record, shape (points,) or (points, channels); return its value."""
        centred = signal - signal.mean(axis=0)
        square = centred * centred
        self._count += 1
        self._variance_sum = self._variance_sum + square.mean(axis=0)
        return ratio((square * square).mean(axis=0), (self._variance_sum / self._count) ** 2)


def mesh_envelope(average: np.ndarray, teeth: int) -> np.ndarray:
    """Return the envelope of the band of one mesh frequency around the strongest mesh harmonic.

    The band goes half-way to the neighbouring harmonics. Input of NB4 (Zakrajsek, Handschuh and
    Decker 1994). Shape of the average.
    """
    columns = average.reshape(len(average), -1)
    lines = fft.fft(columns, axis=0)
    strongest = teeth * (1 + np.argmax(mesh_amplitudes(columns, teeth), axis=0))
    orders = np.arange(len(columns))[:, np.newaxis]
    band = (np.abs(orders - strongest) <= teeth / 2) & (orders < len(columns) / 2)
    return np.abs(fft.ifft(np.where(band, 2 * lines, 0), axis=0)).reshape(average.shape)


def energy_ratio(parts: Parts) -> np.ndarray:
    """Return RMS(difference) / RMS(regular with first side bands) (Swansson 1980)."""
    return ratio(rms(parts.difference), rms(parts.regular))


def first_side_bands(average: np.ndarray, teeth: int) -> np.ndarray:
    """Return the peak amplitudes at orders teeth - 1 and teeth + 1, shape (2, ...)."""
    lines = 2 / len(average) * np.abs(fft.rfft(average, axis=0))
    return lines[[teeth - 1, teeth + 1]]


def side_band_index(average: np.ndarray, teeth: int) -> np.ndarray:
    """Return the mean amplitude of the two first side bands of the mesh frequency.

    A (1 + m cos) at the mesh frequency gives A m / 2 (Sait and Sharaf-Eldeen 2011).
    """
    return first_side_bands(average, teeth).mean(axis=0)


def side_band_level_factor(average: np.ndarray, teeth: int) -> np.ndarray:
    """Return the sum of the two first side bands over the RMS of the average without its mean.

    A (1 + m cos) gives m sqrt(2) / sqrt(1 + m^2 / 2) (Sait and Sharaf-Eldeen 2011).
    """
    return ratio(first_side_bands(average, teeth).sum(axis=0), np.std(average, axis=0))


def has_difference(parts: Parts) -> np.ndarray:
    """Return whether there is a difference signal to speak of, per channel.

    A rig without noise or fault has none; ratios of what is left then tell of rounding only.
    """
    return rms(parts.difference) >= NOTHING * rms(parts.regular)
