"""The path of contact: where on both flanks a tooth pair touches at s."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np

from gear_dynamics.model.mesh.tooth import Tooth
from gear_dynamics.parameters.gear_pair import GearPairParameters


@dataclasses.dataclass(frozen=True)
class PathOfContact:
    """The path of contact of two standard teeth, from s = 0 at the gear's tip, in metres."""

    pinion: Tooth
    gear: Tooth

    @classmethod
    def of(cls, pair: GearPairParameters) -> PathOfContact:
        """Return the path of contact of a gear pair."""
        angle = math.radians(pair.pressure_angle_deg)
        return cls(
            Tooth(pair.pinion_teeth, pair.module, angle), Tooth(pair.gear_teeth, pair.module, angle)
        )

    @functools.cached_property
    def approach(self) -> float:
        """Length before the pitch point [m]."""
        return _beyond_pitch_point(self.gear)

    @functools.cached_property
    def recess(self) -> float:
        """Length after the pitch point [m]."""
        return _beyond_pitch_point(self.pinion)

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return self.approach + self.recess

    @property
    def base_pitch(self) -> float:
        """Distance between successive tooth pairs [m]."""
        return math.pi * self.pinion.module * math.cos(self.pinion.pressure_angle)

    @property
    def edges(self) -> tuple[float, ...]:
        """Where on the path the number of pairs in contact changes, with both ends [m]."""
        return 0.0, self.length - self.base_pitch, self.base_pitch, self.length

    def pinion_roll(self, s: np.ndarray) -> np.ndarray:
        """Return tan of the pinion's pressure angle at s."""
        begin = self.pinion.pitch_radius * math.sin(self.pinion.pressure_angle) - self.approach
        return (begin + np.asarray(s, float)) / self.pinion.base_radius

    def gear_roll(self, s: np.ndarray) -> np.ndarray:
        """Return tan of the gear's pressure angle at s."""
        begin = self.gear.pitch_radius * math.sin(self.gear.pressure_angle) + self.approach
        return (begin - np.asarray(s, float)) / self.gear.base_radius

    def other_pair(self, s: np.ndarray) -> np.ndarray:
        """Return where the other pair is that is in contact too, or nan."""
        s = np.asarray(s, float)
        ahead, behind = s + self.base_pitch, s - self.base_pitch
        return np.where(ahead < self.length, ahead, np.where(behind >= 0, behind, np.nan))


def _beyond_pitch_point(tooth: Tooth) -> float:
    return math.sqrt(tooth.tip_radius**2 - tooth.base_radius**2) - tooth.pitch_radius * math.sin(
        tooth.pressure_angle
    )
