"""A local defect of a rolling bearing."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gear_dynamics.model.faults.fault import SpeedAndLoad, WheelFault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports, Table, smooth_pulse
from gear_dynamics.parameters.parameter import parameter

REVOLUTIONS = 64
"""Revolutions of the shaft after which the passages repeat."""


@dataclasses.dataclass(frozen=True)
class BearingDefect(WheelFault):
    """A spall on a race or a rolling element of the bearing that supports a wheel.

    Each time that an element passes the spall, or the spalled element a race, the support's rest
    point dips along the load, in y, and comes back. Defects of the inner race and of elements move
    in and out of the load zone, the half circle about the load, whose load falls off with the
    cosine. Passages come at the orders of rolling, late by half the slip in the mean, and each is
    shifted at random, evenly, within half the slip of their distance to either side.

    Source: P. D. McFadden, J. D. Smith, Model for the vibration produced by a single point defect
    in a rolling element bearing, Journal of Sound and Vibration 96 (1984) 69-82; S. Sawalhi, R. B.
    Randall, Simulating gear and bearing interactions in the presence of faults, Mechanical Systems
    and Signal Processing 22 (2008) 1924-1951.
    """

    place: str = parameter(
        'outer', 'where the spall is', choices=('outer', 'inner', 'element'), live=True
    )
    elements: int = parameter(9, 'rolling elements', minimum=3, maximum=100, live=True)
    element_diameter: float = parameter(
        7.94e-3, 'diameter of an element', unit='m', minimum=1e-4, maximum=1.0, live=True
    )
    pitch_diameter: float = parameter(
        39.04e-3,
        'diameter of the circle of elements',
        unit='m',
        minimum=1e-3,
        maximum=10.0,
        live=True,
    )
    contact_angle_deg: float = parameter(
        0.0, 'contact angle', unit='deg', minimum=0.0, maximum=60.0, live=True
    )
    slip: float = parameter(0.01, 'slip of the elements', minimum=0.0, maximum=0.1, live=True)
    deepest: float = parameter(
        10e-6,
        'dip of the rest point at severity 1',
        unit='m',
        minimum=1e-9,
        maximum=1e-3,
        live=True,
    )
    length: float = parameter(
        0.5e-3, 'length of the spall', unit='m', minimum=1e-5, maximum=0.1, live=True
    )
    seed: int = parameter(1, 'of the random slip', minimum=0, maximum=2**31 - 1, live=True)

    @property
    def depth(self) -> float:
        """Greatest dip of the rest point [m]."""
        return self.severity * self.deepest

    @property
    def ratio(self) -> float:
        """Element over pitch diameter, times the cosine of the contact angle."""
        cosine = math.cos(math.radians(self.contact_angle_deg))
        return self.element_diameter / self.pitch_diameter * cosine

    @property
    def cage_order(self) -> float:
        """Revolutions of the cage in one of the shaft."""
        return (1 - self.ratio) / 2

    @property
    def defect_order(self) -> float:
        """Passages in one revolution of the shaft, without slip: BPFO, BPFI or twice BSF."""
        if self.place == 'outer':
            return self.elements * self.cage_order
        if self.place == 'inner':
            return self.elements * (1 - self.cage_order)
        spin = self.pitch_diameter / (2 * self.element_diameter) * (1 - self.ratio**2)
        return 2 * spin

    def passages(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the shaft angles of passages [revolutions], up to 64, and their loads, 0 to 1."""
        count = max(round(REVOLUTIONS * self.defect_order * (1 - self.slip / 2)), 1)
        jitter = np.random.default_rng(self.seed).uniform(-0.5, 0.5, count) * self.slip
        angle = (np.arange(count) + 0.5 + jitter) * REVOLUTIONS / count
        turns = {'outer': 0.0, 'inner': 1.0, 'element': self.cage_order}[self.place]
        # A whole number of turns of the cage, so that the table can repeat.
        turns = round(turns * REVOLUTIONS) / REVOLUTIONS
        return angle, np.maximum(np.cos(2 * math.pi * turns * angle), 0.0)

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        if self.element_diameter >= self.pitch_diameter / 2:
            raise self.refusal(
                'element_diameter',
                self.element_diameter,
                f'below half the pitch diameter, {self.pitch_diameter / 2:g} m',
            )
        angle, load = self.passages()
        # How far the contact travels over the spall while the shaft turns once.
        travel = math.pi * (self.pitch_diameter - self.element_diameter) * self.cage_order
        spacing = REVOLUTIONS / angle.size * (1 - self.slip)
        half = min(self.length / travel / 2, 0.45 * spacing)
        # The pinion is loaded towards +y, the gear towards -y.
        dip = self.MIRROR[self.wheel] * self.depth
        knots = np.stack([angle - half, angle + half], axis=1).ravel()
        pulse = smooth_pulse(1.0)
        rows = np.zeros((knots.size, pulse.size))
        rows[::2] = dip * load[:, None] * pulse
        knots = np.append(knots, knots[0] + REVOLUTIONS)
        return Ports([Table(f'{self.wheel}_rest_y', self.wheel, knots, rows)])

    def orders(self, pair: GearPair) -> tuple[float, ...]:
        """Return the order of the passages, and that at which they move through the load zone."""
        shaft = super().orders(pair)[0]
        first = self.defect_order * (1 - self.slip / 2) * shaft
        beside = {'outer': (), 'inner': (shaft,), 'element': (self.cage_order * shaft,)}
        return (first, *beside[self.place])
