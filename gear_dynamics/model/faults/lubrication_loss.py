"""A loss of lubrication."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.faults.fault import Fault, SpeedAndLoad, severity_parameter
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Offset, Ports
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class LubricationLoss(Fault):
    """A friction coefficient that grows on all flanks, whatever the friction model.

    Source: dry steel on steel slides at 0.1 to 0.2 above well lubricated flanks: W. Beitz, K.-H.
    Grote, Dubbel, Handbook of Mechanical Engineering.
    """

    severity: float = severity_parameter()
    largest: float = parameter(
        0.15, 'friction coefficient added at severity 1', minimum=0.0, maximum=0.5, live=True
    )

    @property
    def added_friction(self) -> float:
        """Friction coefficient that is added."""
        return self.severity * self.largest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        return Ports([Offset('friction', self.added_friction)])

    def orders(self, pair: GearPair) -> tuple[float, ...]:
        """Return the order of the mesh: all teeth are alike."""
        return (float(pair.pinion_teeth),)
