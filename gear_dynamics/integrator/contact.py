"""Finding the instant at which a tooth pair loses or regains contact, on the dense output."""

from __future__ import annotations

import math
from typing import NamedTuple

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


class Edge(NamedTuple):
    """An edge of the gap: a pair is on one side of it while sign (g - level) is positive.

    A value nearer than `near` to the level is that of a pair that has just come over the edge, or
    that leaves it at once.
    """

    level: float
    sign: float
    near: float


class Point(NamedTuple):
    """A function's value and slope at a time."""

    t: float
    value: float
    slope: float


@kernel
def _from_edge(edge, point):
    """Return how far a point is on the edge's side, and the slope of that."""
    return edge.sign * (point.value - edge.level), edge.sign * point.slope


@kernel
def _stays(edge, begin, end):
    """Return whether a pair stays on its side between two points, as is told from these alone."""
    (ua, va), (ub, vb) = _from_edge(edge, begin), _from_edge(edge, end)
    return ua > edge.near and ub >= 0 and not _may_dip(ua, va, ub, vb, end.t - begin.t)


@kernel
def _exit(g, row, edge, begin, end):
    """Return the first time between two points of g at which a pair leaves its side, or inf."""
    (ua, va), (ub, vb) = _from_edge(edge, begin), _from_edge(edge, end)
    level, sign, ta, tb = edge.level, edge.sign, begin.t, end.t
    if ua <= edge.near:
        still = _STILL * abs(level)
        if ub >= -still and va * (tb - ta) >= -still:
            return math.inf
        if va <= 0:
            return ta
        first = _extremum(g, row, ta, tb) if va > 0 > vb else ta
        return _root(g, row, level, sign, first, tb, 0.5 * (first + tb))
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
    edge = Edge(level, sign, _NEAR * abs(level))
    sixteenths(g, row, h, parts)
    end = Point(0.0, g[row, 0], g[row, 1])
    for j in range(PARTS):
        begin, end = end, Point(h * ((j + 1) / PARTS), parts[0, j], parts[1, j])
        if not _stays(edge, begin, end):
            leaves = _exit(g, row, edge, begin, end)
            if leaves < math.inf:
                return leaves
    return math.inf


@kernel
def _first_touch(g, high, low, h, b, parts):
    """Return the first instant in [0, h] at which a pair in the gap reaches a flank, and which."""
    upper, lower = Edge(b, -1.0, _NEAR * b), Edge(-b, 1.0, _NEAR * b)
    sixteenths(g, high, h, parts[:2])
    other = 0 if high == low else 2
    if other:
        sixteenths(g, low, h, parts[2:])
    end, end_low = Point(0.0, g[high, 0], g[high, 1]), Point(0.0, g[low, 0], g[low, 1])
    for j in range(PARTS):
        begin, begin_low, t = end, end_low, h * ((j + 1) / PARTS)
        end = Point(t, parts[0, j], parts[1, j])
        end_low = Point(t, parts[other, j], parts[other + 1, j])
        rises = falls = math.inf
        if not _stays(upper, begin, end):
            rises = _exit(g, high, upper, begin, end)
        if not _stays(lower, begin_low, end_low):
            falls = _exit(g, low, lower, begin_low, end_low)
        if rises < math.inf or falls < math.inf:
            return (rises, DRIVE) if rises <= falls else (falls, BACK)
    return math.inf, GAP
