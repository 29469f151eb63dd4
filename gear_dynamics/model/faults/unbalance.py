"""A wheel whose centre of mass is not on its axis."""

from __future__ import annotations

import dataclasses
import math

from gear_dynamics.model.faults.fault import SpeedAndLoad, WheelFault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Ports
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class Unbalance(WheelFault):
    """A mass off the axis, whose inertia force turns with the shaft and grows with speed squared.

    Source: ISO 21940-11; 5e-4 kg m on the default pinion is grade G 48 at 1000 rpm.
    """

    largest: float = parameter(
        5e-4, 'mass times radius at severity 1', unit='kg m', minimum=1e-9, maximum=100.0, live=True
    )
    phase_deg: float = parameter(
        0.0, 'direction at shaft angle 0', unit='deg', minimum=-360.0, maximum=360.0, live=True
    )

    @property
    def unbalance(self) -> float:
        """Mass times its distance from the axis [kg m]."""
        return self.severity * self.largest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        phase, turns = math.radians(self.phase_deg), self.MIRROR[self.wheel]
        # The force is -U times the second derivative of (cos, sin).
        return Ports(
            [
                Harmonic(
                    f'{self.wheel}_force_x',
                    self.wheel,
                    1.0,
                    -self.unbalance,
                    phase + math.pi / 2,
                    derivative=2,
                ),
                Harmonic(
                    f'{self.wheel}_force_y',
                    self.wheel,
                    1.0,
                    -turns * self.unbalance,
                    phase,
                    derivative=2,
                ),
            ]
        )
