"""What the average of a wheel means: one tooth that stands out, or a fault once a revolution."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import fft

from gear_dynamics.monitoring.task import Indicator
from gear_dynamics.signal.spectrum import line_amplitudes
from gear_dynamics.signal.statistics import rms
from gear_dynamics.signal.synchronous import Parts
from gear_dynamics.signal.teeth import tooth_energy

CHANCE = 1e-4
"""Chance of a healthy wheel below which a channel counts as a witness against a tooth."""

LEAST_ENERGY = 3e-4
"""Mean square of the residual signal at that tooth, over that of the regular signal: less is the
remainder of slow changes of speed and load."""

LEAST_ORDER = 0.02
MOST_ABOVE = 1000.0
FEWEST_TEETH = 8
ONCE_A_REVOLUTION = 10.0
"""Ratio of order 1 to its surroundings from which a wheel is said to be eccentric or unbalanced."""

LOCAL_FAULT = 0.5
"""Agreement from which a tooth is named."""

TEETH_ALIKE = 'the teeth are alike'

INDICATORS = (
    Indicator('local_fault', '', 'how sure a local fault of the wheel is, 0 to 1'),
    Indicator('tooth', '', 'tooth that stands out most, counted from 0'),
    Indicator('once_per_revolution', '', 'order 1 over the orders around it, 0 if faint'),
)
"""Of a wheel."""


class LocalFault(NamedTuple):
    """A tooth that stands out.

    Attributes
    ----------
    sure : float
        Fraction of the channels with a difference signal in which this tooth or one beside it
        stands out from the others.
    tooth : int
        From 0; that of the strongest witness if there is no fault.
    """

    sure: float
    tooth: int


def local_fault(parts: Parts, teeth: int, there: np.ndarray) -> LocalFault:
    """Return the tooth that stands out in most channels.

    Parameters
    ----------
    parts : Parts
        Of the wheel's average, shape (points, channels).
    teeth : int
    there : ndarray of bool
        Channels with a difference signal.
    """
    found = tooth_energy(without_alternation(parts.residual, teeth), teeth)
    large = found.energy.max(axis=0) >= LEAST_ENERGY * rms(parts.regular) ** 2
    witness = there & large & (found.chance < CHANCE)
    best = int(np.argmax(np.where(there, found.score, -np.inf)))
    if not witness.any():
        return LocalFault(0.0, int(found.tooth[best]))
    # Teeth beside each other are one fault: the pair is in mesh for more than one cycle.
    named = found.tooth[witness]
    apart = np.abs((named[:, np.newaxis] - named + teeth // 2) % teeth - teeth // 2)
    votes = (apart <= 1).sum(axis=1)
    tooth = int(named[np.argmax(votes)])
    return LocalFault(float(votes.max()) / int(there.sum()), tooth)


def without_alternation(residual: np.ndarray, teeth: int) -> np.ndarray:
    """Return a residual signal without what repeats at every other tooth.

    A healthy mesh can move with twice its period; on a wheel of even teeth the average holds that
    motion, at the orders that are multiples of teeth / 2.
    """
    if teeth % 2:
        return residual
    lines = fft.rfft(residual, axis=0)
    lines[teeth // 2 :: teeth // 2] = 0
    return fft.irfft(lines, len(residual), axis=0)


def once_per_revolution(parts: Parts, teeth: int) -> float:
    """Return how far order 1 of a wheel stands above its surroundings, in the clearest channel.

    The surroundings are the median amplitude of the orders from 3 to three below the mesh, where a
    sound wheel has noise alone. Channels in which order 1 is less than 2 % of the standard
    deviation do not count; without any the value is 0. An eccentric wheel, an unbalance and a bent
    shaft stand out. A line of Gaussian noise exceeds 10 times the median with a chance of 1e-30.
    """
    amplitude = line_amplitudes(parts.average)
    if teeth < FEWEST_TEETH:
        return 0.0
    around = np.median(amplitude[3 : teeth - 2], axis=0)
    counts = amplitude[1] >= LEAST_ORDER * np.std(parts.average, axis=0)
    # Without noise the surroundings are rounding, and the ratio says no more than that.
    floor = np.maximum(around, amplitude[1] / MOST_ABOVE + np.finfo(float).tiny)
    return float(np.max(np.where(counts, amplitude[1] / floor, 0.0), initial=0.0))
