"""Gear condition indicators of synchronous averages.

Definitions differ between papers; each docstring says which one is used. Signals hold one
revolution of the wheel along `axis`, as `separate` splits it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import fft

from gear_dynamics.signal.arguments import real_array
from gear_dynamics.signal.spectrum import line_amplitudes
from gear_dynamics.signal.statistics import kurtosis, normalised_moment, ratio, rms, std
from gear_dynamics.signal.synchronous import Parts, checked_average

NOTHING = 1e-4
"""RMS of the difference signal, as a fraction of the regular one, below which it is rounding."""

FINER = 8
"""Points between two points at which the band-limited peak of an average is looked for; a tone at
the Nyquist order then reads at most 2 % low."""


def mesh_amplitudes(average: npt.ArrayLike, teeth: int, *, axis: int = 0) -> np.ndarray:
    """Return the peak amplitudes of the mesh harmonics 1, 2, ..., along `axis`."""
    average, teeth = checked_average(average, teeth, axis=axis)
    return np.moveaxis(line_amplitudes(average)[teeth::teeth], 0, axis)


def fm0(average: npt.ArrayLike, teeth: int, *, axis: int = 0) -> np.ndarray:
    """Return peak-to-peak value over the sum of the amplitudes of the mesh harmonics.

    Peak amplitudes, so that a sine at the mesh frequency gives 2 (Stewart 1977; Zakrajsek 1993).
    The peaks are those of the band-limited signal between the points too.
    """
    average, teeth = checked_average(average, teeth, axis=axis)
    amplitudes = line_amplitudes(average)[teeth::teeth].sum(axis=0)
    return ratio(np.ptp(_finer(average), axis=0), amplitudes)


def _finer(average: np.ndarray) -> np.ndarray:
    """Return an average at FINER times as many points, band-limited."""
    count = len(average)
    lines = fft.rfft(average, axis=0)
    if count % 2 == 0:
        lines[-1] /= 2  # at the Nyquist order it stands for itself and its conjugate
    return fft.irfft(lines, count * FINER, axis=0) * FINER


def fm4(difference: npt.ArrayLike, *, axis: int = 0) -> np.ndarray:
    """Return the kurtosis of the difference signal, not excess (Stewart 1977)."""
    return kurtosis(difference, axis)


def m6a(difference: npt.ArrayLike, *, axis: int = 0) -> np.ndarray:
    """Return the sixth moment of the difference signal over variance^3 (Martin 1989)."""
    return normalised_moment(difference, 6, axis)


def m8a(difference: npt.ArrayLike, *, axis: int = 0) -> np.ndarray:
    """Return the eighth moment of the difference signal over variance^4 (Martin 1989)."""
    return normalised_moment(difference, 8, axis)


def variance_ratio_kurtosis(
    signal: npt.ArrayLike, variance: npt.ArrayLike, *, axis: int = 0
) -> np.ndarray:
    """Return the fourth central moment over the square of a reference variance.

    On residual signals this is NA4 (Zakrajsek, Townsend and Decker 1993, NASA TM 105950), on
    `mesh_envelope` NB4 (Zakrajsek, Handschuh and Decker 1994, NASA TM 106467), with the mean
    variance of the records so far as the reference. With that of healthy records alone the value
    keeps rising as damage grows, where FM4 falls back.
    """
    signal = real_array(signal, 'signal', axis)
    square = (signal - signal.mean(axis=0)) ** 2
    return ratio((square**2).mean(axis=0), np.asarray(variance, dtype=float) ** 2)


class RunningKurtosis:
    """`variance_ratio_kurtosis` with the mean variance of the records so far as the reference."""

    def __init__(self) -> None:
        self._count = 0
        self._variance_sum = np.zeros(())

    def add(self, signal: npt.ArrayLike) -> np.ndarray:
        """Take the next record, one channel or (points, channels); return its value."""
        self._count += 1
        self._variance_sum = self._variance_sum + np.var(real_array(signal, 'signal'), axis=0)
        return variance_ratio_kurtosis(signal, self._variance_sum / self._count)


def strongest_harmonic(average: npt.ArrayLike, teeth: int, *, axis: int = 0) -> np.ndarray:
    """Return the number of the strongest mesh harmonic, 1 or more, one value a channel."""
    return 1 + np.argmax(mesh_amplitudes(average, teeth, axis=axis), axis=axis)


def mesh_envelope(
    average: npt.ArrayLike, teeth: int, harmonic: npt.ArrayLike | None = None, *, axis: int = 0
) -> np.ndarray:
    """Return the envelope of the band of one mesh frequency around a mesh harmonic.

    The band goes half-way to the neighbouring harmonics. Input of NB4 (Zakrajsek, Handschuh and
    Decker 1994).

    Parameters
    ----------
    average : array_like
        One revolution of the wheel along `axis`.
    teeth : int
    harmonic : array_like of int, optional
        Of each channel; the strongest by default. A history of NB4 must keep to one harmonic: of
        two that are equally strong the strongest changes by chance.
    axis : int
        Axis of the points.

    Returns
    -------
    ndarray
        Of the shape of the average.
    """
    average, teeth = checked_average(average, teeth, axis=axis)
    if harmonic is None:
        harmonic = strongest_harmonic(average, teeth)
    centre = teeth * np.asarray(harmonic)
    orders = np.arange(len(average)).reshape(-1, *(1,) * (average.ndim - 1))
    band = (np.abs(orders - centre) <= teeth / 2) & (orders < len(average) / 2)
    analytic = fft.ifft(np.where(band, 2 * fft.fft(average, axis=0), 0), axis=0)
    return np.moveaxis(np.abs(analytic), 0, axis)


def energy_ratio(parts: Parts, *, axis: int = 0) -> np.ndarray:
    """Return RMS(difference) / RMS(regular with first sidebands) (Swansson 1980)."""
    return ratio(rms(parts.difference, axis), rms(parts.regular, axis))


def first_sidebands(average: npt.ArrayLike, teeth: int, *, axis: int = 0) -> np.ndarray:
    """Return the peak amplitudes at orders teeth - 1 and teeth + 1, two values along `axis`."""
    average, teeth = checked_average(average, teeth, 2 * teeth + 2, axis=axis)
    return np.moveaxis(line_amplitudes(average)[[teeth - 1, teeth + 1]], 0, axis)


def sideband_index(average: npt.ArrayLike, teeth: int, *, axis: int = 0) -> np.ndarray:
    """Return the mean amplitude of the two first sidebands of the mesh frequency.

    A (1 + m cos) at the mesh frequency gives A m / 2 (Sait and Sharaf-Eldeen 2011).
    """
    return first_sidebands(average, teeth, axis=axis).mean(axis=axis)


def sideband_level_factor(average: npt.ArrayLike, teeth: int, *, axis: int = 0) -> np.ndarray:
    """Return the sum of the two first sidebands over the RMS of the average without its mean.

    A (1 + m cos) gives m sqrt(2) / sqrt(1 + m^2 / 2) (Sait and Sharaf-Eldeen 2011).
    """
    sidebands = first_sidebands(average, teeth, axis=axis).sum(axis=axis)
    return ratio(sidebands, std(average, axis))


def has_difference(parts: Parts, *, axis: int = 0) -> np.ndarray:
    """Return whether there is a difference signal above rounding, per channel.

    A rig without noise or fault has none; ratios of what is left then tell of rounding only.
    """
    return rms(parts.difference, axis) > NOTHING * rms(parts.regular, axis)
