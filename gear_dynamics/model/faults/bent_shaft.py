"""A shaft that is bent."""

from __future__ import annotations

import dataclasses
import math

from gear_dynamics.model.faults.fault import SpeedAndLoad, WheelFault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Ports
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class BentShaft(WheelFault):
    """A shaft bow at the wheel: the point where its support is slack turns with the shaft.

    The wheel is carried about through the support, by springs and dampers. Neglected are the tilt
    of the wheel and the change of backlash.

    Source: R. G. Parkinson, M. S. Darlow, A. J. Smalley, A theoretical introduction to the
    development of a unified approach to flexible rotor balancing, Journal of Sound and Vibration 68
    (1980): residual bow.
    """

    largest: float = parameter(
        100e-6, 'bow at severity 1', unit='m', minimum=1e-8, maximum=0.01, live=True
    )
    phase_deg: float = parameter(
        0.0, 'direction at shaft angle 0', unit='deg', minimum=-360.0, maximum=360.0, live=True
    )

    @property
    def bow(self) -> float:
        """Distance of the bent shaft from its axis at the wheel [m]."""
        return self.severity * self.largest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        phase, turns = math.radians(self.phase_deg), self.MIRROR[self.wheel]
        rest = f'{self.wheel}_rest'
        return Ports(
            [
                Harmonic(f'{rest}_x', self.wheel, 1.0, self.bow, phase + math.pi / 2),
                Harmonic(f'{rest}_y', self.wheel, 1.0, turns * self.bow, phase),
            ]
        )
