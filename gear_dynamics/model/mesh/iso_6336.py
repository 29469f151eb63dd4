"""Single stiffness of a tooth pair by ISO 6336-1.

Source: ISO 6336-1:2019, method B, for spur gears without profile shift, of two solid discs, of the
basic rack profile A of ISO 53, at specific loads above 100 N/mm.
"""

from __future__ import annotations

import math

from gear_dynamics.model.mesh.tooth import CLEARANCE

STEEL = 206e9
"""Young's modulus that the fit is for [Pa]; the stiffness is proportional to it."""

CORRECTION = 0.8
"""C_M: measured stiffness over the theoretical one of solid discs."""


def theoretical_stiffness(pinion_teeth: int, gear_teeth: int) -> float:
    """Return c'th, the theoretical single stiffness per face width of a steel pair [N/m2].

    1 N/(mm um) is 1e9 N/m2.
    """
    flexibility = 0.04723 + 0.15551 / pinion_teeth + 0.25791 / gear_teeth
    return 1e9 / flexibility


def single_stiffness(
    pinion_teeth: int,
    gear_teeth: int,
    pressure_angle: float,
    face_width: float,
    youngs_modulus: float,
) -> float:
    """Return the greatest stiffness of a single tooth pair [N/m].

    c' = c'th C_M C_R C_B: C_M = 0.8; C_R = 1, a solid disc; and C_B = [1 + 0.5 (1.2 - 1.25)]
    [1 - 0.02 (20 deg - a)] of the basic rack. At 20 deg c' is 0.78 c'th.
    """
    rack = 1 + 0.5 * (1.2 - (1 + CLEARANCE))
    rack *= 1 - 0.02 * (20 - math.degrees(pressure_angle))
    per_width = theoretical_stiffness(pinion_teeth, gear_teeth) * CORRECTION * rack
    return per_width * face_width * youngs_modulus / STEEL
