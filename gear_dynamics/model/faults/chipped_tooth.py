"""A tooth with a chip broken off its tip."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gear_dynamics.model.faults.fault import (
    Fault,
    SpeedAndLoad,
    severity_parameter,
    tooth_parameter,
    wheel_parameter,
)
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.model.ports import Ports, ToothDeviation
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class ChippedTooth(Fault):
    """A chip broken off the tip of a tooth, over part of its face.

    Where the chip is missing only the rest of the face touches: stiffness and damping of the tooth
    pair fall by the chip's share of the face width. The tooth below the chip stays as stiff as it
    was.

    Source: the contact of a slice of the face, as in J. Jiang, Z. Fang, Modelling and analysis of
    spur gear pair with tooth root crack and chipping, Engineering Failure Analysis 56 (2015).
    """

    wheel: str = wheel_parameter()
    tooth: int | None = tooth_parameter()
    severity: float = severity_parameter()
    widest: float = parameter(
        0.02,
        'width of the chip along the face at severity 1',
        unit='m',
        minimum=1e-6,
        maximum=2.0,
        live=True,
    )
    height: float = parameter(
        1e-3, 'height of the chip below the tip', unit='m', minimum=1e-6, maximum=0.2, live=True
    )

    @property
    def width(self) -> float:
        """Width of the chip along the face [m]."""
        return self.severity * self.widest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        if self.width > pair.face_width:
            raise self.refusal('width', self.width, f'at most the face width {pair.face_width:g} m')
        path = PathOfContact.of(pair)
        tooth = path.pinion if self.wheel == 'pinion' else path.gear
        lost = self._length_on_path(pair, tooth.tip_radius, tooth.base_radius)
        begin = path.length - lost if self.wheel == 'pinion' else 0.0
        share = self.width / pair.face_width
        edges = np.array([begin, begin + lost])
        return Ports([ToothDeviation(self.wheel, self.tooth, edges, loss=share)])

    def _length_on_path(self, pair: GearPair, tip: float, base: float) -> float:
        below = tip - self.height
        length = math.sqrt(tip**2 - base**2) - math.sqrt(max(below**2 - base**2, 0.0))
        if length >= pair.derived.path_length:
            raise self.refusal(
                'height', self.height, 'less than the height of the flank in contact'
            )
        return length
