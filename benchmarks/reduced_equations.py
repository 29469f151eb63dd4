"""The reduced form's right-hand side and Jacobian, compiled, for general-purpose solvers.

In tau = wn t and lengths over b, with the damping in the gap; u is x1, y1, x2, y2, psi and their
rates. `numbers` says what p holds.
"""

from __future__ import annotations

import numba
import numpy as np

from gear_dynamics.integrator.constants import pack
from gear_dynamics.study.operating_point import OperatingPoint

Array = np.ndarray


def numbers(operation: OperatingPoint) -> Array:
    """Return the parameters p of the functions below."""
    c = pack(operation.pair, 1e-9, 1e-12, drive=False)[0]
    derived = operation.pair.derived
    wn, b = c['wn'], c['b']
    values = [c['m1'], c['m2'], c['c1'] / wn, c['c2'] / wn, c['k1'] / wn**2, c['k2'] / wn**2]
    mass = derived.equivalent_mass
    values += [mass, operation.load_torque / derived.gear_base_radius / mass / (b * wn**2)]
    values += [c['k'] / wn**2, c['c'] / wn, c['mu']]
    values += [derived.base_pitch, derived.contact_ratio, derived.approach_length]
    values += [c['arm1'], c['arm_sum']]
    values += [
        derived.pinion_base_radius / derived.pinion_inertia,
        derived.gear_base_radius / derived.gear_inertia,
    ]
    return np.array([*values, operation.frequency_ratio, c['e_a'] / b])


@numba.njit
def matrices(phase: float, flank: float, p: Array) -> tuple[Array, Array]:
    """Return what multiplies delta and delta' in F, Ff, and the moments on pinion and gear."""
    k, c = np.zeros(4), np.zeros(4)
    pairs = 2 if phase < p[12] - 1 else 1
    for ahead in range(pairs):
        s = (phase + ahead) * p[11]
        rubs = p[10] * flank * (1.0 if s < p[13] else -1.0)
        arm = p[14] + s
        weights = np.array([1.0, rubs, rubs * arm, rubs * (p[15] - arm)])
        k += weights * (p[8] if flank != 0 else 0.0)
        c += weights * p[9]
    return k, c


@numba.njit
def accelerations(force: Array, x: Array, v: Array, p: Array) -> Array:
    """Return the accelerations of x1, y1, x2, y2, psi from the mesh and the supports."""
    a = np.empty(5)
    a[0] = (force[1] - p[2] * v[0] - p[4] * x[0]) / p[0]
    a[1] = (force[0] - p[2] * v[1] - p[4] * x[1]) / p[0]
    a[2] = (-force[1] - p[3] * v[2] - p[5] * x[2]) / p[1]
    a[3] = (-force[0] - p[3] * v[3] - p[5] * x[3]) / p[1]
    a[4] = -force[0] / p[6] + p[16] * force[2] + p[17] * force[3]
    return a


@numba.njit
def mesh_state(tau: float, u: Array, p: Array) -> tuple[float, float, float, float]:
    """Return mesh phase, delta, delta' and the flank; u is x and dx / dtau over b."""
    angle = p[18] * tau
    delta = u[3] - u[1] + u[4] - p[19] * np.sin(angle)
    slope = u[8] - u[6] + u[9] - p[19] * p[18] * np.cos(angle)
    flank = 1.0 if delta > 1 else -1.0 if delta < -1 else 0.0
    return (angle / (2 * np.pi)) % 1.0, delta, slope, flank


@numba.njit
def motion(tau: float, u: Array, p: Array) -> Array:
    """Return du / dtau of the reduced form."""
    phase, delta, slope, flank = mesh_state(tau, u, p)
    k, c = matrices(phase, flank, p)
    out = np.empty(10)
    out[:5] = u[5:10]
    out[5:] = accelerations(k * (delta - flank) + c * slope, u[:5], u[5:10], p)
    out[9] += p[7]
    return out


@numba.njit
def jacobian(tau: float, u: Array, p: Array) -> Array:
    """Return the Jacobian of `motion`."""
    phase, _, _, flank = mesh_state(tau, u, p)
    k, c = matrices(phase, flank, p)
    out = np.zeros((10, 10))
    for j in range(5):
        out[j, 5 + j] = 1.0
        for half in range(2):
            unit = np.zeros(10)
            unit[j + 5 * half] = 1.0
            delta, slope = unit[3] - unit[1] + unit[4], unit[8] - unit[6] + unit[9]
            out[5:, j + 5 * half] = accelerations(k * delta + c * slope, unit[:5], unit[5:], p)
    return out


@numba.njit
def motion_and_variations(tau: float, u: Array, p: Array) -> Array:
    """Return du / dtau of the motion and of ten variations, as one vector."""
    out = np.empty(110)
    out[:10] = motion(tau, u[:10], p)
    variations = np.ascontiguousarray(u[10:]).reshape(10, 10)
    out[10:] = (variations @ jacobian(tau, u[:10], p).T).ravel()
    return out
