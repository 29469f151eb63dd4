"""A spall or a pit on a flank."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gear_dynamics.model.faults.fault import (
    Fault,
    SpeedAndLoad,
    rounded_down,
    severity_parameter,
    tooth_parameter,
    wheel_parameter,
)
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports, ToothDeviation
from gear_dynamics.parameters.parameter import parameter

SLOPE = 0.2
"""Share of the length, at each end, in which the bottom is reached."""


@dataclasses.dataclass(frozen=True)
class Spall(Fault):
    """A hollow across the face of a tooth, with a flat bottom.

    It is a flank error: where it is deeper than the mesh yields, the other tooth pair carries the
    load, or none does.

    Source: the displacement that the contact follows into a spall, as in H. Ma et al., Review on
    dynamics of cracked gear systems, Engineering Failure Analysis 55 (2015) 224-245, section 2.
    """

    wheel: str = wheel_parameter()
    tooth: int | None = tooth_parameter()
    severity: float = severity_parameter()
    place: float = parameter(
        0.5,
        'middle of the spall on the path of contact, from 0 to 1',
        minimum=0.0,
        maximum=1.0,
        live=True,
    )
    length: float = parameter(
        1e-3, 'length along the path of contact', unit='m', minimum=1e-5, maximum=0.1, live=True
    )
    deepest: float = parameter(
        50e-6, 'depth at severity 1', unit='m', minimum=1e-7, maximum=1e-3, live=True
    )

    @property
    def depth(self) -> float:
        """Depth of the spall [m]."""
        return self.severity * self.deepest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        whole = pair.derived.path_length
        if self.length > whole:
            raise self.refusal(
                'length', self.length, f'at most the path of contact, {rounded_down(whole)} m'
            )
        edges = self.place * whole + self.length * np.array([-0.5, SLOPE - 0.5, 0.5 - SLOPE, 0.5])
        if edges[0] < 0 or edges[-1] > whole:
            margin = math.ceil(self.length / 2 / whole * 1e4) / 1e4
            raise self.refusal(
                'place',
                self.place,
                f'from {margin:g} to {1 - margin:g} for a length of {self.length:g} m',
            )
        down, flat, up = [0.0, 0.0, 3.0, -2.0], [1.0, 0.0, 0.0, 0.0], [1.0, 0.0, -3.0, 2.0]
        error = self.depth * np.array([down, flat, up])
        return Ports([ToothDeviation(self.wheel, self.tooth, edges, error=error)])
