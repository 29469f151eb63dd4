"""Systems whose dynamics are known, as series."""

import numpy as np
from scipy.integrate import solve_ivp


def logistic(count, r=4.0, x=0.3):
    """x' = r x (1 - x)."""
    series = np.empty(count)
    for i in range(count):
        x = r * x * (1 - x)
        series[i] = x
    return series


def henon(count, a=1.4, b=0.3):
    """x' = 1 - a x^2 + y, y' = b x."""
    x = y = 0.1
    series = np.empty(count + 100)
    for i in range(len(series)):
        x, y = 1 - a * x * x + y, b * x
        series[i] = x
    return series[100:]


def rossler(count, step, a=0.2, b=0.2, c=5.7):
    """x of x' = -y - z, y' = x + a y, z' = b + z (x - c)."""

    def rates(_, s):
        return [-s[1] - s[2], s[0] + a * s[1], b + s[2] * (s[0] - c)]

    t = 100 + step * np.arange(count)
    return solve_ivp(rates, (0, t[-1]), [1, 1, 1], 'DOP853', t, rtol=1e-8, atol=1e-8).y[0]


def maxima(series):
    """Successive maxima of a series: a section of the flow."""
    middle = series[1:-1]
    return middle[(middle > series[:-2]) & (middle >= series[2:])]


STEPS = 120
"""Runge-Kutta steps in a period of the drive."""


def _duffing_period(s, damping, drive):
    """One period of x'' + damping x' + x^3 = drive cos t and its variation; s is x, v, dx, dv."""

    def rates(t, s):
        x, v, dx, dv = s
        forced = drive * np.cos(t) - damping * v - x**3
        return np.array([v, forced, dv, -damping * dv - 3 * x**2 * dx])

    h = 2 * np.pi / STEPS
    for t in h * np.arange(STEPS):
        k1 = rates(t, s)
        k2 = rates(t + h / 2, s + h / 2 * k1)
        k3 = rates(t + h / 2, s + h / 2 * k2)
        s = s + h / 6 * (k1 + 2 * (k2 + k3) + rates(t + h, s + h * k3))
    return s


def duffing_section(count, damping, drive):
    """x once a period of the drive, after 50 periods."""

    def rates(t, s):
        return [s[1], -damping * s[1] - s[0] ** 3 + drive * np.cos(t)]

    t = 2 * np.pi * (50 + np.arange(count))
    return solve_ivp(rates, (0, t[-1]), [1, 0], 'DOP853', t, rtol=1e-8, atol=1e-8).y[0]


def duffing_exponent(damping, drive, runs=100, periods=60):
    """Largest Lyapunov exponent a period: mean growth of the variation (Benettin et al. 1980)."""
    s = np.ones((4, runs))
    s[0] = np.linspace(-2, 2, runs)
    growth = np.zeros(runs)
    for period in range(-20, periods):
        s = _duffing_period(s, damping, drive)
        norm = np.hypot(s[2], s[3])
        s[2:] /= norm
        growth += np.log(norm) if period >= 0 else 0
    return growth.mean() / periods
