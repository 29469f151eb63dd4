"""A load or drive torque that fluctuates."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.faults.fault import Fault, SpeedAndLoad, severity_parameter
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Ports, Table
from gear_dynamics.parameters.parameter import parameter

KNOTS = 1024
"""Values after which the random torque repeats."""


@dataclasses.dataclass(frozen=True)
class LoadFluctuation(Fault):
    """A torque that is added to the load or the drive: a sine at an order, or noise below it.

    The random torque has independent Gaussian values, `order` times two a revolution or mesh cycle,
    joined by cubics; it repeats after 1024 values, and is the same for the same seed.
    """

    severity: float = severity_parameter()
    largest: float = parameter(
        50.0,
        'amplitude, or RMS of the random torque, at severity 1',
        unit='N m',
        minimum=1e-6,
        maximum=5000.0,
        live=True,
    )
    shape: str = parameter('sine', 'shape', choices=('sine', 'random'), live=True)
    side: str = parameter('load', 'torque that fluctuates', choices=('load', 'drive'), live=True)
    per: str = parameter(
        'gear',
        'what the order counts: revolutions of a shaft, or mesh cycles',
        choices=('pinion', 'gear', 'mesh'),
        live=True,
    )
    order: float = parameter(
        1.0,
        'order of the sine, or highest order of the noise',
        minimum=0.01,
        maximum=100.0,
        live=True,
    )
    seed: int = parameter(1, 'of the random numbers', minimum=0, maximum=2**31 - 1, live=True)

    @property
    def torque(self) -> float:
        """Amplitude of the sine, or RMS of the random torque [N m]."""
        return self.severity * self.largest

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        signal = f'{self.side}_torque'
        if self.shape == 'sine':
            return Ports([Harmonic(signal, self.per, self.order, self.torque)])
        spacing = 1 / (2 * self.order)
        return Ports([Table.of_noise(signal, self.per, self.torque, spacing, KNOTS, self.seed)])

    def orders(self, pair: GearPair) -> tuple[float, ...]:
        """Return the order of the sine, or the highest one of the noise."""
        per = {
            'pinion': 1.0,
            'gear': pair.pinion_teeth / pair.gear_teeth,
            'mesh': float(pair.pinion_teeth),
        }
        return (self.order * per[self.per],)
