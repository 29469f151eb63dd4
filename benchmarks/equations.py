"""The gear pair's right-hand side as one compiled function, for general-purpose solvers."""

from __future__ import annotations

import math
from collections.abc import Callable

import numba
import numpy as np

from gear_dynamics.model.gear_pair import GearPair


def right_hand_side(pair: GearPair, speed: float, load_torque: float) -> Callable:
    """Return f(t, y) for the full form at constant commands.

    y: x1, y1, x2, y2, th1, th2, their rates, and the integral of q. The damping acts in contact
    only, as in `GearPair()`.
    """
    d = pair.derived
    angle = math.radians(pair.pressure_angle_deg)
    m1, m2, i1, i2 = d.pinion_mass, d.gear_mass, d.pinion_inertia, d.gear_inertia
    c1, c2 = d.pinion_support_damping, d.gear_support_damping
    k1, k2 = pair.pinion_support_stiffness, pair.gear_support_stiffness
    rb1, rb2, z1 = d.pinion_base_radius, d.gear_base_radius, pair.pinion_teeth
    k, c, b, mu = (
        pair.tooth_pair_stiffness,
        d.tooth_pair_damping,
        pair.half_backlash,
        pair.friction_coefficient,
    )
    e_a, phi0 = pair.transmission_error_amplitude, pair.transmission_error_phase
    pitch, approach, leaves = d.base_pitch, d.approach_length, d.contact_ratio - 1
    arm1 = d.pinion_pitch_radius * math.sin(angle) - approach
    arm_sum = (rb1 + rb2) * math.tan(angle)
    ratio = rb1 / rb2
    it = i1 + i2 * ratio**2
    rate = 2 * math.pi * pair.drive_frequency
    kd, cd, ki = rate**2 * it, 2 * pair.drive_damping_ratio * rate * it, rate**3 * it / 5

    @numba.njit
    def f(t: float, y: np.ndarray) -> np.ndarray:
        phi = z1 * speed * t / (2 * math.pi)
        fraction = phi - math.floor(phi)
        turn = 2 * math.pi * phi + phi0
        delta = y[3] - y[1] + rb1 * y[4] - rb2 * y[5] - e_a * math.sin(turn)
        delta_dot = y[9] - y[7] + rb1 * y[10] - rb2 * y[11] - e_a * math.cos(turn) * z1 * speed
        flank = 1.0 if delta > b else -1.0 if delta < -b else 0.0
        pair_force = (k * (delta - flank * b) + c * delta_dot) * abs(flank)
        force = friction = torque1 = 0.0
        for ahead in range(2 if fraction < leaves else 1):
            s = (fraction + ahead) * pitch
            sliding = 1.0 if s < approach else -1.0
            rub = flank * sliding * mu * pair_force
            force += pair_force
            friction += rub
            torque1 += rub * (arm1 + s)
        torque2 = arm_sum * friction - torque1
        q = (i1 * y[4] + ratio * i2 * y[5]) / it
        q_dot = (i1 * y[10] + ratio * i2 * y[11]) / it
        drive = load_torque * ratio - kd * q - cd * q_dot - ki * y[12]
        out = np.empty(13)
        out[:6] = y[6:12]
        out[6] = (friction - c1 * y[6] - k1 * y[0]) / m1
        out[7] = (force - c1 * y[7] - k1 * y[1]) / m1
        out[8] = (-friction - c2 * y[8] - k2 * y[2]) / m2
        out[9] = (-force - c2 * y[9] - k2 * y[3]) / m2
        out[10] = (drive - rb1 * force + torque1) / i1
        out[11] = (-load_torque + rb2 * force - torque2) / i2
        out[12] = q
        return out

    return f


@numba.njit
def runge_kutta_4(f: Callable, y: np.ndarray, step: float, steps: int, every: int) -> np.ndarray:
    """Return the states after every `every` steps of the classic fixed-step method."""
    out = np.empty((steps // every, y.size))
    for i in range(steps):
        t = i * step
        a = f(t, y)
        b = f(t + step / 2, y + step / 2 * a)
        c = f(t + step / 2, y + step / 2 * b)
        d = f(t + step, y + step * c)
        y = y + step / 6 * (a + 2 * b + 2 * c + d)
        if (i + 1) % every == 0:
            out[(i + 1) // every - 1] = y
    return out
