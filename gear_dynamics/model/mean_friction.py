"""The mean moment of friction that the drive must make up."""

from __future__ import annotations

import numpy as np

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.stiffness import stiffness

POINTS = 20_000
"""Phases over a mesh cycle; the moment jumps where pairs come and go and at the pitch point, so
that the mean is good to two points."""


def mean_friction_moment(pair: GearPair, first_arm: float, arm_sum: float) -> float:
    """Return the torque on the pinion that friction takes, per unit of load torque on the gear.

    The mean over a mesh cycle in static equilibrium, in which tooth pairs share the mesh force F
    by their stiffness and the gear's balance T2 - rb2 F + Tf2 = 0 gives F. It is
    (rb1/rb2) Tf2 - Tf1, with the Coulomb coefficient `friction_coefficient` on the drive flank.

    Parameters
    ----------
    pair : GearPair
    first_arm, arm_sum : float
        l_i1 at s = 0 and l_i1 + l_i2 [m].
    """
    d, law = pair.derived, stiffness(pair)
    rb1, rb2 = d.pinion_base_radius, d.gear_base_radius
    phase = (np.arange(POINTS) + 0.5) / POINTS
    s = np.stack([phase, 1 + phase]) * d.base_pitch
    k = np.where(s < d.path_length, law.at(np.minimum(s, d.path_length)), 0.0)
    share = k / k.sum(axis=0)
    friction = pair.friction_coefficient * np.sign(d.approach_length - s) * share
    arm1 = first_arm + s
    moment1, moment2 = (friction * arm1).sum(axis=0), (friction * (arm_sum - arm1)).sum(axis=0)
    force = 1 / (rb2 - moment2)
    return float(np.mean((rb1 / rb2 * moment2 - moment1) * force))
