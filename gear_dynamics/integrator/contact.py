"""Finding the instant at which a tooth pair loses or regains contact, on the dense output."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.polynomials import sixteenths
from gear_dynamics.integrator.series import polynomial
from gear_dynamics.integrator.vector import LANES

DRIVE, GAP, BACK = 1, 0, -1
"""Contact states of a tooth pair: on the drive flank, in the backlash gap, on the back flank."""

PARTS = 2 * LANES
"""Parts in which a step is looked at; see `layout.MOST_RADIANS`."""

_NEAR = 8 * np.finfo(np.float64).eps
_STILL = 1e-10
"""Of b: a pair that rests on the edge, without load, leaves it only to go further than this;
otherwise rounding would have it come and go without end."""


@kernel
def contact_state(delta, slope, b):
    """Return the contact state at relative displacement delta; on the edge the slope decides."""
    return flank_in_contact(delta, slope, delta, slope, b)


@kernel
def flank_in_contact(high, high_slope, low, low_slope, b):
    """Return the contact state by what is held against b, and what is held against -b."""
    if high > b or (high == b and high_slope >= 0):
        return DRIVE
    if low < -b or (low == -b and low_slope <= 0):
        return BACK
    return GAP


@kernel
def _root(g, row, level, sign, inside, outside, start):
    """Return where sign (g - level) falls to zero between the times inside and outside.

    By Newton's method from `start`, held between the two, to the rounding of g.
    """
    t = start
    for _ in range(100):
        value, slope = polynomial(g, row, t)
        value -= level
        if abs(value) <= _NEAR * abs(level):
            return t
        if sign * value > 0:
            inside = t
        else:
            outside = t
        newton = t - value / slope if slope != 0 else math.inf
        low, high = min(inside, outside), max(inside, outside)
        following = newton if low < newton < high else 0.5 * (low + high)
        if abs(following - t) <= 2e-16 * high:
            return following
        t = following
    return t


@kernel
def _extremum(g, row, low, high):
    """Return where the slope of g, of opposite signs at low and high, is zero.

    Regula falsi, with the stale end's weight halved (Illinois).
    """
    slope_low, slope_high = polynomial(g, row, low)[1], polynomial(g, row, high)[1]
    t = high
    for _ in range(60):
        before = t
        t = (low * slope_high - high * slope_low) / (slope_high - slope_low)
        slope = polynomial(g, row, t)[1]
        if slope == 0.0 or abs(t - before) <= 1e-12 * high:
            break
        if (slope > 0) == (slope_high > 0):
            high, slope_high = t, slope
            slope_low *= 0.5
        else:
            low, slope_low = t, slope
            slope_high *= 0.5
    return t


@kernel
def _may_dip(ua, va, ub, vb, h):
    """Return whether a function, positive at both ends of h, may be negative between.

    Between slopes va and vb the dip below the ends is at most a quarter of (vb - va) h where the
    function is convex; twice that leaves room for an inflection.
    """
    return va < 0 < vb and min(ua, ub) <= 0.5 * (vb - va) * h


@kernel
def _stays(level, sign, near, h, ga, sa, gb, sb):
    """Return whether sign (g - level) is positive all over h, as is told from the ends alone."""
    ua, va = sign * (ga - level), sign * sa
    ub, vb = sign * (gb - level), sign * sb
    return ua > near and ub >= 0 and not _may_dip(ua, va, ub, vb, h)


@kernel
def _exit(g, row, level, sign, near, ta, ga, sa, tb, gb, sb):
    """Return the first time in [ta, tb] at which sign (g - level) turns negative, or inf.

    ga, sa, gb, sb: value and slope of g at ta and tb. A value nearer than `near` to the level at ta
    is that of a pair that has just come over the edge, or that leaves it at once.
    """
    ua, va = sign * (ga - level), sign * sa
    ub, vb = sign * (gb - level), sign * sb
    if ua <= near:
        still = _STILL * abs(level)
        if ub >= -still and va * (tb - ta) >= -still:
            return math.inf
        if va <= 0:
            return ta
        begin = _extremum(g, row, ta, tb) if va > 0 > vb else ta
        return _root(g, row, level, sign, begin, tb, 0.5 * (begin + tb))
    if ub < 0:
        return _root(g, row, level, sign, ta, tb, ta + (tb - ta) * ua / (ua - ub))
    if _may_dip(ua, va, ub, vb, tb - ta):
        lowest = _extremum(g, row, ta, tb)
        if sign * (polynomial(g, row, lowest)[0] - level) < 0:
            return _root(g, row, level, sign, ta, lowest, 0.5 * (ta + lowest))
    return math.inf


@kernel
def first_change(g, high, low, h, state, b, parts):
    """Return the first instant in [0, h] at which a pair's contact changes, and its next state.

    Parameters
    ----------
    g : (n, ROWS) array
    high, low : int
        Rows of g: the series of what is held against b and against -b, which is the pair's delta_i
        for both while the half backlash is constant.
    h : float
        Length of the step [s].
    state : int
        DRIVE, GAP or BACK.
    b : float
        Half backlash [m].
    parts : (4, PARTS) array
        Scratch.

    Returns
    -------
    t, new_state : float, int
        t is inf if the state lasts.
    """
    if state == DRIVE:
        return _first_exit(g, high, h, b, 1.0, parts[:2]), GAP
    if state == BACK:
        return _first_exit(g, low, h, -b, 1.0 * state, parts[:2]), GAP
    return _first_touch(g, high, low, h, b, parts)


@kernel
def _first_exit(g, row, h, level, sign, parts):
    """Return the first instant in [0, h] at which sign (g - level) turns negative, or inf."""
    near = _NEAR * abs(level)
    sixteenths(g, row, h, parts)
    gb, sb, tb = g[row, 0], g[row, 1], 0.0
    for j in range(PARTS):
        ga, sa, ta = gb, sb, tb
        gb, sb, tb = parts[0, j], parts[1, j], h * ((j + 1) / PARTS)
        if not _stays(level, sign, near, tb - ta, ga, sa, gb, sb):
            leaves = _exit(g, row, level, sign, near, ta, ga, sa, tb, gb, sb)
            if leaves < math.inf:
                return leaves
    return math.inf


@kernel
def _first_touch(g, high, low, h, b, parts):
    """Return the first instant in [0, h] at which a pair in the gap reaches a flank, and which."""
    near = _NEAR * b
    sixteenths(g, high, h, parts[:2])
    other = 0 if high == low else 2
    if other:
        sixteenths(g, low, h, parts[2:])
    gb, sb, tb = g[high, 0], g[high, 1], 0.0
    lb, rb = g[low, 0], g[low, 1]
    for j in range(PARTS):
        ga, sa, la, ra, ta = gb, sb, lb, rb, tb
        gb, sb, tb = parts[0, j], parts[1, j], h * ((j + 1) / PARTS)
        lb, rb = parts[other, j], parts[other + 1, j]
        rises = falls = math.inf
        if not _stays(b, -1.0, near, tb - ta, ga, sa, gb, sb):
            rises = _exit(g, high, b, -1.0, near, ta, ga, sa, tb, gb, sb)
        if not _stays(-b, 1.0, near, tb - ta, la, ra, lb, rb):
            falls = _exit(g, low, -b, 1.0, near, ta, la, ra, tb, lb, rb)
        if rises < math.inf or falls < math.inf:
            return (rises, DRIVE) if rises <= falls else (falls, BACK)
    return math.inf, GAP
