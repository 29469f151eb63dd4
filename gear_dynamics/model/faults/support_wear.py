"""A worn support."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.faults.fault import SpeedAndLoad, WheelFault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Offset, Ports
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class SupportWear(WheelFault):
    """A support that has lost stiffness, in x and y alike; its damping stays.

    Source: the softening of a bearing whose clearance has grown, T. A. Harris, Rolling Bearing
    Analysis, as a loss of mean stiffness; the clearance itself is neglected.
    """

    most: float = parameter(
        0.8, 'share of the stiffness lost at severity 1', minimum=0.0, maximum=0.95, live=True
    )

    @property
    def share(self) -> float:
        """Share of the support's stiffness that is lost."""
        return self.severity * self.most

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        stiff = pair.pinion_support_stiffness
        if self.wheel == 'gear':
            stiff = pair.gear_support_stiffness
        return Ports([Offset(f'{self.wheel}_support_stiffness', -self.share * stiff)])

    def orders(self, pair: GearPair) -> tuple[float, ...]:
        """Return the order of the mesh: no tooth differs."""
        return (float(pair.pinion_teeth),)
