"""Teeth that are not evenly spaced."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gear_dynamics.model.faults.fault import SpeedAndLoad, WheelFault, limits
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports, ToothDeviation
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class PitchErrors(WheelFault):
    """Random pitch deviations of an accuracy grade of ISO 1328, the same ones for the same seed.

    Each single pitch deviation is drawn evenly between the limits of the grade times `severity`;
    all add up to 0 over the wheel. A tooth's flank error is what they add up to before it, less the
    mean.

    Source: ISO 1328-1:1995, f_pt = 0.3 (m + 0.4 sqrt(d)) + 4 um of grade 5, with m and d in mm, and
    a factor sqrt(2) a grade.
    """

    grade: int = parameter(
        8, 'accuracy grade of ISO 1328 at severity 1', minimum=0, maximum=12, live=True
    )
    seed: int = parameter(1, 'of the random numbers', minimum=0, maximum=2**31 - 1, live=True)

    def deviation(self, module: float, diameter: float) -> float:
        """Return the limit of a single pitch deviation [m] at this severity.

        Parameters
        ----------
        module, diameter : float
            Module and pitch diameter of the wheel [m].
        """
        fifth = 0.3 * (1e3 * module + 0.4 * math.sqrt(1e3 * diameter)) + 4
        return self.severity * 1e-6 * fifth * math.sqrt(2) ** (self.grade - 5)

    def errors(self, pair: GearPair) -> np.ndarray:
        """Return the flank error of each tooth [m]."""
        teeth = pair.pinion_teeth if self.wheel == 'pinion' else pair.gear_teeth
        drawn = np.random.default_rng(self.seed).uniform(-1.0, 1.0, teeth)
        single = self.deviation(pair.module, pair.module * teeth) * (drawn - drawn.mean())
        added = np.cumsum(single)
        return added - added.mean()

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        edges = limits(pair)
        return Ports(
            ToothDeviation(self.wheel, tooth, edges, error=np.array([[error]]))
            for tooth, error in enumerate(self.errors(pair))
        )
