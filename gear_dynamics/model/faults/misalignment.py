"""Axes that are not parallel."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gear_dynamics.model.faults.fault import Fault, SpeedAndLoad, limits, severity_parameter
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports, ToothDeviation
from gear_dynamics.parameters.parameter import parameter


@dataclasses.dataclass(frozen=True)
class Misalignment(Fault):
    """A gap that grows from nothing at one end of the face to its full width at the other.

    Under the mean load of a tooth pair, F = T2 / (rb2 eps), the slices of the face that touch make
    F = k d2 / (2 g) of the approach d, as long as d is below the gap g, and F = k (d - g / 2) from
    there on. The pair has the slope of that curve at the mean load for its stiffness, and its
    intercept for its flank error; both follow the commanded load.

    Source: the load distribution over the face of ISO 6336-1, K_Hbeta, of the linear gap.
    """

    FOLLOWS_COMMANDS = True

    severity: float = severity_parameter()
    widest: float = parameter(
        30e-6,
        'gap at the end of the face at severity 1',
        unit='m',
        minimum=1e-8,
        maximum=1e-3,
        live=True,
    )

    @property
    def gap(self) -> float:
        """Gap at the far end of the unloaded face [m]."""
        return self.severity * self.widest

    def share(self, pair: GearPair, commanded: SpeedAndLoad) -> float:
        """Return the share of the face that touches at the mean load."""
        yields = self._approach(pair, commanded)
        return min(yields / self.gap, 1.0) if self.gap else 1.0

    def _approach(self, pair: GearPair, commanded: SpeedAndLoad) -> float:
        d = pair.derived
        force = max(abs(commanded.load_torque), 1e-3) / d.gear_base_radius / d.contact_ratio
        stiff = d.single_stiffness
        part = math.sqrt(2 * force * self.gap / stiff)
        return part if part < self.gap else force / stiff + self.gap / 2

    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        share = self.share(pair, commanded)
        intercept = self._approach(pair, commanded) / 2 if share < 1 else self.gap / 2
        error = np.array([[intercept]])
        return Ports(
            [
                ToothDeviation(None, None, limits(pair), loss=1 - share),
                ToothDeviation(None, None, limits(pair), error=error),
            ]
        )

    def orders(self, pair: GearPair) -> tuple[float, ...]:
        """Return the order of the mesh: all teeth are alike."""
        return (float(pair.pinion_teeth),)
