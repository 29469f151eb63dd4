"""A tooth that has broken off."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.faults.fault import (
    Fault,
    SpeedAndLoad,
    limits,
    severity_parameter,
    tooth_parameter,
    wheel_parameter,
)
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports, ToothDeviation


@dataclasses.dataclass(frozen=True)
class MissingTooth(Fault):
    """A tooth broken off over a share of its face; at severity 1 it is gone.

    Stiffness and damping of the tooth pair fall by that share wherever the tooth would touch. The
    next pair takes over where it comes into contact in a healthy mesh: contact beyond the path of
    contact, which a wheel that lags behind may have, is neglected.

    Source: X. Tian, M. J. Zuo, K. R. Fyfe, Analysis of the vibration response of a gearbox with
    gear tooth faults, ASME IMECE 2004-59358.
    """

    wheel: str = wheel_parameter()
    tooth: int | None = tooth_parameter()
    severity: float = severity_parameter()

    @property
    def share(self) -> float:
        """Share of the face that has broken off."""
        return self.severity

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        return Ports([ToothDeviation(self.wheel, self.tooth, limits(pair), loss=self.share)])
