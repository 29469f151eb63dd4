"""Collects the states of a Poincaré section into records, and finds the regime of each."""

from __future__ import annotations

import collections
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.regimes import Regime, regime
from gear_dynamics.monitoring.poincare import SECTION

Scale = Callable[[float, float], tuple[float, float]]

STEADY = 0.005
"""Fraction by which the mesh frequency may change over a record that is judged."""

CHANGING = 'not judged: the speed is changing'
CONSTANT = 'not judged: the displacement does not vary'

LEAST = 1e-30
"""Standard deviation of delta [m] or delta_dot [m/s] that counts as none."""


class SectionVerdict(NamedTuple):
    """The regime over a record of successive section states.

    Attributes
    ----------
    start, end : float
        Times of the first and the last state [s].
    text : str
        Regime, or why there is none.
    cycle_rate : float
        Mesh frequency [Hz].
    regime : Regime or None
        None if the speed was changing or the displacement constant.
    """

    start: float
    end: float
    text: str
    cycle_rate: float
    regime: Regime | None


class SectionRecord:
    """Collects the states of successive mesh cycles and judges each full record of them.

    Parameters
    ----------
    cycles : int
        States in a record.
    tolerance : float
        Greatest distance that counts as recurrence, in standard deviations of delta and delta_dot.
    restarts : Counter
        Where a record that is given up is counted.
    """

    def __init__(self, cycles: int, tolerance: float, restarts: collections.Counter[str]) -> None:
        self._cycles = cycles
        self._tolerance = tolerance
        self._states = np.empty(cycles, SECTION)
        self._filled = 0
        self._restarts = restarts

    @property
    def start(self) -> float:
        """Time of the first state of the record that is being collected [s]."""
        return float(self._states['t'][0]) if self._filled else -math.inf

    def push(self, section: np.ndarray, scale: Scale) -> list[SectionVerdict]:
        """Take states, dtype SECTION; return the records completed.

        A state that is not one cycle after the one before begins a new record.

        Parameters
        ----------
        section : ndarray
        scale : function
            Returns the standard deviations of delta [m] and delta_dot [m/s] of the samples from
            one time to another [s].
        """
        motions = []
        for run in np.split(
            section, np.flatnonzero(np.abs(np.diff(section['cycle']) - 1) > 0.5) + 1
        ):
            if self._filled and len(run) and not self._follows(run[0]['cycle']):
                self._filled = 0
                self._restarts['states of the section that do not follow'] += 1
            while len(run):
                taken = min(len(run), self._cycles - self._filled)
                self._states[self._filled : self._filled + taken] = run[:taken]
                self._filled += taken
                run = run[taken:]
                if self._filled == self._cycles:
                    motions.append(self._judge(scale))
                    self._filled = 0
        return motions

    def _follows(self, cycle: float) -> bool:
        return abs(cycle - self._states['cycle'][self._filled - 1] - 1) <= 0.5

    def _judge(self, scale: Scale) -> SectionVerdict:
        t = self._states['t']
        start, end = float(t[0]), float(t[-1])
        if not end > start:
            return SectionVerdict(start, end, CHANGING, math.nan, None)
        cycle_rate = (len(t) - 1) / (end - start)
        quarter = len(t) // 4
        early, late = t[quarter] - t[0], t[-1] - t[-1 - quarter]
        if abs(early - late) > STEADY * early:
            return SectionVerdict(start, end, CHANGING, cycle_rate, None)
        delta, delta_dot = scale(start, end)
        if not (delta > LEAST and delta_dot > LEAST):
            return SectionVerdict(start, end, CONSTANT, cycle_rate, None)
        states = np.column_stack(
            [self._states['delta'] / delta, self._states['delta_dot'] / delta_dot]
        )
        found = regime(states, cycle_rate, self._tolerance)
        return SectionVerdict(start, end, found.words, cycle_rate, found)
