"""A crack in the root of a tooth."""

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
from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.model.mesh.stiffness import deviation, stiffness
from gear_dynamics.model.mesh.tooth import Tooth
from gear_dynamics.model.ports import Ports, ToothDeviation
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class RootCrack(Fault):
    """A straight crack that grows from the root of a tooth towards its centre line.

    It makes the tooth softer: the half of each section that the crack comes from is cut down to the
    distance between the crack's tip and the centre line. The compliance that this adds is that of
    `mesh.tooth`, whatever the method of `mesh_stiffness`. The crack does not close on the other
    flank, and the gear body stays as it is.

    Sources: F. Chaari, T. Fakhfakh, M. Haddar, Analytical modelling of spur gear tooth crack and
    influence on gearmesh stiffness, European Journal of Mechanics A 28 (2009) 461-468; Z. Chen, Y.
    Shao, Dynamic simulation of spur gear with tooth root crack propagating along tooth width and
    crack depth, Engineering Failure Analysis 18 (2011) 2149-2164.
    """

    wheel: str = wheel_parameter()
    tooth: int | None = tooth_parameter()
    severity: float = severity_parameter()
    deepest: float = parameter(
        2e-3, 'depth at severity 1', unit='m', minimum=1e-6, maximum=0.2, live=True
    )
    angle_deg: float = parameter(
        70.0,
        "angle between the crack and the tooth's centre line",
        unit='deg',
        minimum=10.0,
        maximum=90.0,
        live=True,
    )
    face_share: float = parameter(
        1.0, 'share of the face width that is cracked', minimum=0.0, maximum=1.0, live=True
    )

    @property
    def depth(self) -> float:
        """Depth of the crack [m]."""
        return self.severity * self.deepest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        path, law = PathOfContact.of(pair), stiffness(pair)
        tooth = path.pinion if self.wheel == 'pinion' else path.gear
        roll = path.pinion_roll if self.wheel == 'pinion' else path.gear_roll
        left = self._uncracked_half(tooth)

        def cracked(s: np.ndarray, healthy: np.ndarray) -> np.ndarray:
            added = self._added(pair, tooth, roll(s), left)
            return healthy + law.at(s, added) - law.at(s)

        found = deviation(pair, cracked)
        return Ports(
            [ToothDeviation(self.wheel, self.tooth, found.edges, stiffness=found.coefficients)]
        )

    def _uncracked_half(self, tooth: Tooth) -> float:
        half = float(tooth.fillet(np.array([math.pi / 2]))[0][0])
        slope = math.sin(math.radians(self.angle_deg))
        if self.depth * slope > half:
            raise self.refusal(
                'depth',
                self.depth,
                f'at most {rounded_down(half / slope)} m, to the centre line of the tooth',
            )
        return half - self.depth * slope

    def _added(self, pair: GearPair, tooth: Tooth, roll: np.ndarray, left: float) -> np.ndarray:
        """Return the compliance that the crack adds [m/N]."""
        material = pair.face_width, pair.youngs_modulus, pair.poissons_ratio
        whole = tooth.compliance(roll, *material)
        cracked = np.maximum(tooth.compliance(roll, *material, left), whole)
        return 1 / (self.face_share / cracked + (1 - self.face_share) / whole) - whole
