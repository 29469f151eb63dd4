"""The equations of motion of docs/model.md as matrices: the one place where they are written.

With the coordinates u = (x1, y1, x2, y2, psi, q), where psi = rb1 th1 - rb2 th2 and q is the rigid
rotation, and Q the integral of q,

    u'' = loads @ (F, Ff, Tf1, T2*) - damping @ u' - stiffness @ u - integral Q
    delta = apart @ u - e

All of the integrator follows from these: Taylor series, tangent vectors, jumps at events, the drive
torque, the start. psi and q stand for th1 and th2 because at mu = 0 the drive then never touches
the vibration, to the last bit: the entries that would vanish are zero and not a rounding.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mean_friction import mean_friction_moment

X1, Y1, X2, Y2, PSI, Q = range(6)
"""The coordinates."""

FORCE, FRICTION, MOMENT, LOAD = range(4)
"""What moves them: mesh force F, friction force Ff, its moment about the pinion Tf1, and the torque
on the load side T2* = T2 + I2 Theta2''. (Tf2 = (rb1 + rb2) tan a Ff - Tf1.)"""


@dataclasses.dataclass(frozen=True)
class System:
    """The equations of motion of a gear pair between two events.

    Attributes
    ----------
    loads : (6, 4) array
        Acceleration of each coordinate per unit of F, Ff, Tf1 and T2*.
    stiffness, damping : (6, 6) arrays
        Of the supports and of the drive, over the masses.
    integral : (6,) array
        Acceleration that the drive takes away per unit of Q.
    apart : (6,) array
        How delta is made of the coordinates.
    angles : (2, 2) array
        (th1, th2) = angles @ (psi, q).
    drive : (3,) array
        kd, cd, ki: the torque that holds q is kd q + cd q' + ki Q; zero in the reduced form.
    torques : (6, 2) array
        Acceleration of each coordinate per unit of torque on the pinion, in the direction of
        rotation, and on the gear, against it.
    """

    loads: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    integral: np.ndarray
    apart: np.ndarray
    angles: np.ndarray
    drive: np.ndarray
    torques: np.ndarray


def system(pair: GearPair, drive: bool = True) -> System:
    """Return the equations of motion of a gear pair.

    Parameters
    ----------
    pair : GearPair
    drive : bool
        False gives the reduced form: q stays zero, and T1 carries the load and, while the speed
        ramps, the inertias.
    """
    d = pair.derived
    rb1, rb2 = d.pinion_base_radius, d.gear_base_radius
    inertia1, inertia2 = d.pinion_inertia, d.gear_inertia
    ratio = rb1 / rb2
    inertia = inertia1 + inertia2 * ratio**2
    arm_sum = arms(pair)[1]
    by_me, by_inertia = 1 / d.equivalent_mass, 1 / inertia
    m1, m2 = masses(pair)
    by_m1, by_m2 = 1 / m1, 1 / m2

    # psi'' = (T2*/rb2 - F) / me + (rb1/I1) Tf1 + (rb2/I2) Tf2
    # q''   = (Tf1 - (rb1/rb2) Tf2) / It
    loads = np.zeros((6, 4))
    loads[[Y1, Y2, PSI], FORCE] = by_m1, -by_m2, -by_me
    loads[[X1, X2, PSI], FRICTION] = by_m1, -by_m2, rb2 / inertia2 * arm_sum
    loads[PSI, MOMENT] = rb1 / inertia1 - rb2 / inertia2
    loads[PSI, LOAD] = by_me / rb2
    torques = np.zeros((6, 2))
    torques[PSI] = rb1 / inertia1, rb2 / inertia2

    stiffness, damping, integral = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros(6)
    k1, k2 = pair.pinion_support_stiffness, pair.gear_support_stiffness
    stiffness[range(4), range(4)] = np.repeat([k1 / m1, k2 / m2], 2)
    c1, c2 = d.pinion_support_damping, d.gear_support_damping
    damping[range(4), range(4)] = np.repeat([c1 / m1, c2 / m2], 2)
    control = np.zeros(3)
    if drive:
        loads[Q, FRICTION] = -ratio * arm_sum * by_inertia
        loads[Q, MOMENT] = (1 + ratio) * by_inertia
        torques[Q] = by_inertia, -ratio * by_inertia
        made_up = feed_forward(pair)
        loads[PSI, LOAD] += made_up * rb1 / inertia1
        loads[Q, LOAD] = made_up * by_inertia
        control = drive_control(pair, inertia)
        for matrix, strength in zip((stiffness, damping), control[:2], strict=True):
            matrix[[PSI, Q], Q] = strength * (rb1 / inertia1), strength * by_inertia
        integral[[PSI, Q]] = control[2] * (rb1 / inertia1), control[2] * by_inertia

    return System(
        loads=loads,
        stiffness=stiffness,
        damping=damping,
        integral=integral,
        apart=np.array([0.0, -1.0, 0.0, 1.0, 1.0, 0.0]),
        angles=np.array(
            [
                [ratio * inertia2 / (rb2 * inertia), 1.0],
                [-inertia1 / (rb2 * inertia), ratio],
            ]
        ),
        drive=control,
        torques=torques,
    )


def masses(pair: GearPair) -> tuple[float, float]:
    """Return m1 and m2 [kg]; infinite on rigid supports, so that no force moves the bodies."""
    if pair.support_model == 'rigid':
        return math.inf, math.inf
    return pair.derived.pinion_mass, pair.derived.gear_mass


def arms(pair: GearPair) -> tuple[float, float]:
    """Return l_i1 at s = 0, r1 sin a - l1, and l_i1 + l_i2 = (rb1 + rb2) tan a [m]."""
    d, angle = pair.derived, math.radians(pair.pressure_angle_deg)
    first = d.pinion_pitch_radius * math.sin(angle) - d.approach_length
    return first, (d.pinion_base_radius + d.gear_base_radius) * math.tan(angle)


def drive_control(pair: GearPair, inertia: float) -> np.ndarray:
    """Return kd, cd, ki of the drive that holds an inertia It [kg m2]."""
    rate = 2 * math.pi * pair.drive_frequency
    kd = rate**2 * inertia
    return np.array([kd, 2 * pair.drive_damping_ratio * rate * inertia, kd * rate / 5])


def feed_forward(pair: GearPair) -> float:
    """Return the torque that the drive adds per unit of T2*, to make up the mean friction."""
    if not pair.drive_feed_forward:
        return 0.0
    return mean_friction_moment(pair, *arms(pair))


class PairInContact(NamedTuple):
    """A tooth pair at one instant: k_i, e_i, lambda_i mu_i on the flank in contact, and l_i2."""

    stiffness: float
    error: float
    friction: float
    arm2: float


def static_equilibrium(
    pairs: Sequence[PairInContact],
    load_torque: float,
    half_backlash: float,
    gear_base_radius: float,
    supports: tuple[float, float],
    unloaded: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
) -> np.ndarray:
    """Return the coordinates (6,) in static balance, with q = 0 and no transmission error.

    The gear's balance -T2 + rb2 F - Tf2 = 0 gives the mesh force. Tooth pairs share it by their
    stiffness and flank error; those that would pull carry nothing. Where all teeth are missing, the
    flanks are at the edge of the backlash. supports: their stiffness. unloaded: x1, y1, x2, y2
    without mesh forces.
    """
    flank = 1.0 if load_torque >= 0 else -1.0
    rb2 = gear_base_radius
    u = np.zeros(6)
    u[:4] = unloaded
    carry = [p for p in pairs if p.stiffness > 0]
    if not carry:
        u[PSI] = flank * half_backlash - u[Y2] + u[Y1]
        return u
    while True:
        total = sum(p.stiffness for p in carry)
        mean = sum(p.stiffness / total * p.error for p in carry)
        parts = [p.stiffness / total for p in carry]
        apart = [p.stiffness * (mean - p.error) for p in carry]
        torque = load_torque - sum(
            a * (rb2 - p.friction * p.arm2) for a, p in zip(apart, carry, strict=True)
        )
        force = torque / (
            rb2 - sum(p.friction * s * p.arm2 for s, p in zip(parts, carry, strict=True))
        )
        forces = [s * force + a for s, a in zip(parts, apart, strict=True)]
        pulling = min(range(len(carry)), key=lambda i: flank * forces[i])
        if len(carry) == 1 or flank * forces[pulling] >= 0:
            break
        del carry[pulling]
    shares = [p.friction * s for p, s in zip(carry, parts, strict=True)]
    friction = sum(shares) * force + sum(p.friction * a for p, a in zip(carry, apart, strict=True))
    k1, k2 = supports
    u[:4] += friction / k1, force / k1, -friction / k2, -force / k2
    delta = flank * half_backlash + force / total + mean
    u[PSI] = delta - u[Y2] + u[Y1]
    return u
