"""A wheel whose centre is not on its axis of rotation."""

from __future__ import annotations

import dataclasses
import math

from gear_dynamics.model.faults.fault import SpeedAndLoad, WheelFault, rounded_down
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Ports
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class Eccentricity(WheelFault):
    """A wheel whose centre turns about the shaft's axis.

    The tangential part of the offset, times cos a, adds to the transmission error; the radial part,
    times sin a, to the half backlash. Either flank then sees an error of the offset's amplitude at
    the order of the shaft. Neglected are the change of the pressure angle and of the contact ratio
    with the centre distance, and the unbalance, which is a fault of its own.

    Source: the geometry of the two lines of action, as in Y. Guo, R. G. Parker, Analytical
    determination of mesh phase relations in general compound planetary gears, Mechanism and Machine
    Theory 46 (2011), and W. D. Mark, Journal of the Acoustical Society of America 63 (1978).
    """

    largest: float = parameter(
        100e-6, 'offset at severity 1', unit='m', minimum=1e-8, maximum=0.01, live=True
    )
    phase_deg: float = parameter(
        0.0, 'direction at shaft angle 0', unit='deg', minimum=-360.0, maximum=360.0, live=True
    )

    @property
    def offset(self) -> float:
        """Distance of the wheel's centre from the axis [m]."""
        return self.severity * self.largest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        angle, phase = math.radians(pair.pressure_angle_deg), math.radians(self.phase_deg)
        radial, most = self.offset * math.sin(angle), pair.half_backlash / math.sin(angle)
        if radial >= pair.half_backlash:
            raise self.refusal(
                'offset',
                self.offset,
                f'below {rounded_down(most)} m, which closes the backlash',
            )
        return Ports(
            [
                Harmonic(
                    'transmission_error',
                    self.wheel,
                    1.0,
                    self.offset * math.cos(angle),
                    phase,
                ),
                Harmonic('half_backlash', self.wheel, 1.0, -radial, phase + math.pi / 2),
            ]
        )
