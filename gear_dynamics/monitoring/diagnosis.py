"""What the average of a wheel means: one tooth that stands out, or a fault once a revolution."""

from __future__ import annotations

import collections
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

LEAST_ENERGY = 1e-5
"""Mean square of the residual signal at that tooth, over that of the regular signal: slow changes
of speed and load leave 1e-7 to 1e-6 that is not even from tooth to tooth."""

BLIND = 1e-3
"""The same of the median tooth, from which the noise of a channel hides small faults: it is then no
witness for a sound wheel."""

OVER_LEARNED = 30.0
"""Energy of the greatest tooth over the learned one of the median tooth, from which a channel is a
witness as well if that tooth stands out among the present ones by OVER_PRESENT."""

OVER_PRESENT = 12.0

LEAST_ORDER = 0.02
MOST_ABOVE = 1000.0
FEWEST_TEETH = 8

LOCAL = 'local fault'
ONCE_A_REVOLUTION = 'once a revolution: eccentricity, unbalance or a bent shaft'
"""Kinds of faults, in words."""

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
        Fraction of the channels in which this tooth or one beside it stands out from the others.
        Channels without a difference signal do not count, and of those whose noise would hide a
        fault only half.
    tooth : int
        From 0; that of the strongest witness if there is no fault.
    """

    sure: float
    tooth: int


def local_fault(
    parts: Parts, teeth: int, there: np.ndarray, learned: np.ndarray | None = None
) -> LocalFault:
    """Return the tooth that stands out in most channels.

    Parameters
    ----------
    parts : Parts
        Of the wheel's average, shape (points, channels).
    teeth : int
    there : ndarray of bool
        Channels with a difference signal.
    learned : ndarray, optional
        What `tooth_level` was when the wheel was sound, by channel; NaN where it is not known.
        Where a vibration lasts for many teeth, it tells more than the other teeth do.
    """
    found = tooth_energy(without_alternation(parts.residual, teeth), teeth)
    regular = rms(parts.regular) ** 2
    large = found.energy.max(axis=0) >= LEAST_ENERGY * regular
    median = np.median(found.energy, axis=0)
    witness = found.chance < CHANCE
    if learned is not None:
        # A comparison with NaN is false.
        above = found.energy.max(axis=0) > OVER_LEARNED * np.exp(learned) * regular
        witness |= above & (found.energy.max(axis=0) > OVER_PRESENT * median)
    witness &= there & large
    best = int(np.argmax(np.where(there, found.score, -np.inf)))
    if not witness.any():
        return LocalFault(0.0, int(found.tooth[best]))
    # Teeth beside each other are one fault: the pair is in mesh for more than one cycle.
    named = found.tooth[witness]
    apart = np.abs((named[:, np.newaxis] - named + teeth // 2) % teeth - teeth // 2)
    votes = (apart <= 1).sum(axis=1)
    # Of neighbours that as many channels name, the first: vibration never precedes a fault.
    named = named[apart[np.argmax(votes)] <= 1]
    counts = collections.Counter(named.tolist())
    tooth = max(sorted(counts), key=lambda each: 2 * counts[each] + counts[(each + 1) % teeth])
    blind = there & ~witness & (median >= BLIND * regular)
    return LocalFault(float(votes.max() / (there.sum() - blind.sum() / 2)), tooth)


def tooth_level(parts: Parts, teeth: int) -> np.ndarray:
    """Return the logarithm of the median tooth's energy over the regular signal's, by channel."""
    energy = tooth_energy(without_alternation(parts.residual, teeth), teeth).energy
    median = np.median(energy, axis=0)
    regular = rms(parts.regular) ** 2
    with np.errstate(divide='ignore', invalid='ignore'):
        return np.asarray(np.log(median / regular))


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
