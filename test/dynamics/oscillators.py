"""A gear pair of one degree of freedom in dimensionless form, and the same written with SciPy."""

import numpy as np
from scipy.integrate import solve_ivp

from gear_dynamics import dynamics, study

ZETA, MEAN, ERROR = 0.05, 0.1, 0.05
"""Damping ratio, mean load and error amplitude of Kahraman and Singh's form, over k b and b."""


def kahraman_singh_point(w):
    """It at work at a frequency ratio."""
    return study.OperatingPoint.from_dimensionless(
        frequency_ratio=w, mean_load=MEAN, damping_ratio=ZETA, error_amplitude=ERROR
    )


def kahraman_singh(w):
    """Its stroboscopic map at a frequency ratio."""
    point = kahraman_singh_point(w)
    return dynamics.GearMap(point.pair, point.speed, point.load_torque)


def cycle_by_scipy(w, x, v):
    """x'' + 2 zeta x' + f(x) = Fm + Fa w^2 sin(w t), over one period from phase 0."""

    def rates(t, s):
        gap = s[0] - np.clip(s[0], -1, 1)
        return [s[1], MEAN + ERROR * w**2 * np.sin(w * t) - 2 * ZETA * s[1] - gap]

    # The force has kinks at the edges: steps small enough to resolve them to 1e-9.
    options = {'rtol': 1e-11, 'atol': 1e-13, 'max_step': 2e-3 * 2 * np.pi / w}
    return solve_ivp(rates, (0, 2 * np.pi / w), [x, v], 'DOP853', **options).y[:, -1]
