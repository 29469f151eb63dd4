"""Wear of all teeth of a wheel."""

from __future__ import annotations

import dataclasses

import numpy as np

from gear_dynamics.model.faults.fault import SpeedAndLoad, WheelFault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Offset, Ports, ToothDeviation
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class Wear(WheelFault):
    """Wear of the drive flanks of a wheel, deepest where the flanks slide fastest.

    By Archard's law at even pressure the depth grows with the sliding distance: from none at the
    pitch point to the full depth at the end of the path that is farther from it. The mean
    depth widens the backlash; error and backlash together make the drive flank recede by the depth.

    Source: A. Flodin, S. Andersson, Simulation of mild wear in spur gears, Wear 207 (1997) 16-23.
    """

    deepest: float = parameter(
        50e-6, 'greatest depth at severity 1', unit='m', minimum=1e-7, maximum=1e-3, live=True
    )

    @property
    def depth(self) -> float:
        """Greatest depth [m]."""
        return self.severity * self.deepest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        d = pair.derived
        longest = max(d.approach_length, d.recess_length)
        begin = self.depth * d.approach_length / longest
        end = self.depth * d.recess_length / longest
        mean = (begin * d.approach_length + end * d.recess_length) / (2 * d.path_length)
        wider = mean / 2
        error = np.array([[begin - wider, -begin], [-wider, end]])
        edges = np.array([0.0, d.approach_length, d.path_length])
        return Ports(
            [
                ToothDeviation(self.wheel, None, edges, error=error),
                Offset('half_backlash', wider),
            ]
        )

    def orders(self, pair: GearPair) -> tuple[float, ...]:
        """Return the order of the mesh: all teeth are alike."""
        return (float(pair.pinion_teeth),)
