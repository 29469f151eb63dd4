"""Energy of a synchronous average tooth by tooth: which tooth stands out, and how sure that is."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import special

from gear_dynamics.signal.synchronous import checked_average

LEAST_SCATTER = 0.05
"""Least standard deviation that the logarithms of the energies of healthy teeth are taken to have;
without noise they are equal to rounding, and any tooth would stand out."""


class ToothEnergy(NamedTuple):
    """The teeth of a wheel compared with each other; arrays have one value a channel.

    Attributes
    ----------
    energy : ndarray
        Mean square of the signal from the entry of each tooth to that of the next, one value a
        tooth along the axis of the points.
    tooth : ndarray of int
        That at which the greatest energy begins: vibration rings on after a fault, never before.
    score : ndarray
        Logarithm of its energy over the median of all, in standard deviations of the logarithms
        of the other teeth (estimated by their median absolute deviation); or that of its energy
        over the tooth before, if it is greater.
    chance : ndarray
        Probability that the teeth of a healthy wheel give this score, at most 1.
    """

    energy: np.ndarray
    tooth: np.ndarray
    score: np.ndarray
    chance: np.ndarray


EFFICIENCY = 0.37
"""Of the median absolute deviation: it is as uncertain as the standard deviation of so many times
fewer values (Rousseeuw and Croux 1993)."""

FLOOR = 1e-2
"""Energy, as a fraction of the greatest, below which teeth count as alike: without noise, how a
vibration dies away says nothing of the other teeth, nor does what is left of the mean tooth."""

ONSET = 0.01
"""Energy of a tooth, as a fraction of the greatest, from which the tooth before the greatest can be
its beginning: a tooth is in mesh for more than one cycle, and near a resonance the vibration is
greatest in the second."""

STANDS_OUT = 1.5
"""Logarithm of that energy over that of the quiet teeth, from which that tooth stands out too."""

QUIET = 0.25
"""Share of the teeth that are quiet even where vibration lasts for many teeth."""

MOST_BEFORE = 2
"""Teeth by which the beginning can lie before the greatest energy."""


def tooth_energy(signal: npt.ArrayLike, teeth: int, *, axis: int = 0) -> ToothEnergy:
    """Compare the energy of a signal during the mesh cycle of each tooth with the other teeth.

    A healthy wheel has teeth alike: the logarithms of their energies scatter normally, and the
    probability of the greatest is that of Student's t, with the degrees of freedom by which the
    scatter of the others is known, times the number of comparisons. A local fault makes one tooth
    stand out.

    Near a resonance the vibration that a fault excites lasts for many teeth, and all of them stand
    out from the healthy wheel. The energy then falls evenly from tooth to tooth and rises once, so
    that the rise from the tooth before is compared in the same way. That makes three comparisons a
    tooth, since the energy may be greatest in the second cycle of its mesh.

    Parameters
    ----------
    signal : array_like
        One revolution along `axis`, from the entry of tooth 0 on. The residual suits best:
        the difference signal has lost the first sidebands, and with them a part of the fault, which
        is then missing at all other teeth.
    teeth : int
        4 or more.
    axis : int
        Axis of the points.
    """
    signal, teeth = checked_average(signal, teeth, axis=axis)
    if teeth < 4:
        raise ValueError(f'teeth is {teeth}: at least 4 are needed to compare them')
    edges = np.round(np.arange(teeth) * len(signal) / teeth).astype(int)
    counts = np.diff(edges, append=len(signal)).reshape(-1, *(1,) * (signal.ndim - 1))
    energy = np.add.reduceat(signal**2, edges, axis=0) / counts
    floor = np.maximum(FLOOR * energy.max(axis=0), np.finfo(float).tiny)
    level = np.log(np.maximum(energy, floor))
    # A tooth is in mesh for more than one cycle: its energy may rise in the second alone.
    rise = np.maximum(level, np.roll(level, -1, axis=0)) - np.roll(level, 1, axis=0)
    score = np.maximum(_greatest(level, LEAST_SCATTER), _greatest(rise, 2 * LEAST_SCATTER))
    chance = np.minimum(3 * teeth * special.stdtr(EFFICIENCY * (teeth - 1), -score), 1.0)
    # The floor would hide the quiet teeth, and so the tooth at which the energy begins to rise.
    unlimited = np.log(np.maximum(energy, np.finfo(float).tiny))
    return ToothEnergy(np.moveaxis(energy, 0, axis), _beginning(unlimited), score, chance)


def _greatest(values: np.ndarray, least: float) -> np.ndarray:
    """Return how far the greatest lies above the median, in standard deviations of the others."""
    median = np.median(values, axis=0)
    # 1.4826 times the median absolute deviation is the standard deviation of a normal distribution.
    scatter = 1.4826 * np.median(np.abs(values - median), axis=0)
    return np.asarray((values.max(axis=0) - median) / np.maximum(scatter, least))


def _beginning(level: np.ndarray) -> np.ndarray:
    """Return the tooth at which the greatest energy begins, from the logarithms of all."""
    teeth = len(level)
    tooth = np.argmax(level, axis=0)
    quiet = np.quantile(level, QUIET, axis=0)
    least = np.maximum(level.max(axis=0) + math.log(ONSET), quiet + STANDS_OUT)
    begins = np.ones_like(tooth, dtype=bool)
    for _ in range(MOST_BEFORE):
        before = np.take_along_axis(level, np.expand_dims((tooth - 1) % teeth, 0), axis=0)[0]
        begins &= before >= least
        tooth = np.where(begins, (tooth - 1) % teeth, tooth)
    return tooth
