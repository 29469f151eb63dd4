"""Energy of a synchronous average tooth by tooth: which tooth stands out, and how sure that is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import stats

from gear_dynamics.signal.synchronous import checked_average

LEAST_SCATTER = 0.05
"""Least standard deviation that the logarithms of the energies of healthy teeth are taken to have;
without noise they are equal to rounding, and any tooth would stand out."""


class ToothEnergy(NamedTuple):
    """The teeth of a wheel compared with each other; arrays have one value a channel.

    Attributes
    ----------
    energy : ndarray, shape (teeth, ...)
        Mean square of the signal from the entry of each tooth to that of the next.
    tooth : ndarray of int
        That of the greatest energy.
    score : ndarray
        Logarithm of its energy over the median of all, in standard deviations of the logarithms
        of the other teeth (estimated by their median absolute deviation).
    chance : ndarray
        Probability that the teeth of a healthy wheel give this score, at most 1.
    """

    energy: np.ndarray
    tooth: np.ndarray
    score: np.ndarray
    chance: np.ndarray


def tooth_energy(signal: npt.ArrayLike, teeth: int) -> ToothEnergy:
    """Compare the energy of a signal during the mesh cycle of each tooth with the other teeth.

    A healthy wheel has teeth alike: the logarithms of their energies scatter normally, and the
    probability of the greatest is that of Student's t with teeth - 2 degrees of freedom, times the
    number of teeth. A local fault makes one tooth stand out.

    Parameters
    ----------
    signal : array_like
        One revolution along the first axis, from the entry of tooth 0 on: residual or difference.
    teeth : int
        4 or more.
    """
    signal, teeth = checked_average(signal, teeth)
    if teeth < 4:
        raise ValueError(f'teeth is {teeth}: at least 4 are needed to compare them')
    edges = np.round(np.arange(teeth) * len(signal) / teeth).astype(int)
    counts = np.diff(edges, append=len(signal)).reshape(-1, *(1,) * (signal.ndim - 1))
    energy = np.add.reduceat(signal**2, edges, axis=0) / counts
    level = np.log(np.maximum(energy, np.finfo(float).tiny))
    median = np.median(level, axis=0)
    # 1.4826 times the median absolute deviation is the standard deviation of a normal distribution.
    scatter = 1.4826 * np.median(np.abs(level - median), axis=0)
    score = (level.max(axis=0) - median) / np.maximum(scatter, LEAST_SCATTER)
    chance = np.minimum(teeth * stats.t.sf(score, teeth - 2), 1.0)
    return ToothEnergy(energy, np.argmax(level, axis=0), score, chance)
