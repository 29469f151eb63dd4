"""Poincaré sections from exact events, or interpolated between samples."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from gear_dynamics.machine.columns import EventKind

POINCARE = np.dtype([*((name, np.float32) for name in ('x', 'y', 'z')), ('cycle', np.float64)])
"""A point of the section: delta / b, delta_dot / (b wn), 0, and the mesh cycle; a float32 could
not tell one cycle from the next after a few hours."""

SECTION = np.dtype([(name, np.float64) for name in ('t', 'delta', 'delta_dot', 'cycle')])
"""A state on the section: time [s], delta [m], delta_dot [m/s], mesh phase [cycles]."""


def section_from_events(events: np.ndarray, kind: EventKind = EventKind.SECTION) -> np.ndarray:
    """Return the exact states at the events of one kind, dtype SECTION.

    EventKind.SECTION is the section by mesh phase, DRIVE_LOST that at the loss of contact.

    Parameters
    ----------
    events : ndarray
        With the columns of model.columns.EVENTS.
    """
    chosen = events[events['kind'] == kind]
    section = np.empty(len(chosen), SECTION)
    for name in SECTION.names or ():
        section[name] = chosen[name]
    return section


def section_by_phase(
    t: np.ndarray,
    phase: np.ndarray,
    delta: np.ndarray,
    delta_dot: np.ndarray,
    section_phase: float,
    margin: int = 0,
) -> np.ndarray:
    """Return the states at phase = k + section_phase, interpolated; dtype SECTION.

    The instant is linear in the phase. delta is the cubic Hermite interpolant through delta and
    delta_dot of both samples, in error by at most h^4 / 384 max|d4 delta / dt4| for step h
    (Birkhoff and Priver 1967). delta_dot is the cubic through its own four nearest samples, in
    error by at most 3 h^4 / 128 max|d5 delta / dt5|; the derivative of the Hermite interpolant
    would be as accurate, but would magnify noise of delta by 1 / h. Of an oscillation with w h
    = 0.3 these are 2e-5 and 2e-4 of the amplitude. That holds between changes of contact: a
    step with an impact or with a change of the number of tooth pairs has no such bound, and
    there the error is of second order in h for delta.

    Parameters
    ----------
    t, phase, delta, delta_dot : ndarray, shape (n,)
        Time [s], mesh phase [cycles, rising], delta [m], delta_dot [m/s].
    section_phase : float
        In cycles, 0 to 1.
    margin : int
        Samples at either end that serve the interpolation alone. With 1, no state lies in the first
        or last step, where the four nearest samples of delta_dot are not all there.
    """
    begin, end = phase[margin], phase[len(phase) - 1 - margin]
    first = int(np.ceil(begin - section_phase))
    targets = np.arange(first, int(np.floor(end - section_phase)) + 1) + section_phase
    section = np.empty(len(targets), SECTION)
    section['t'] = np.interp(targets, phase, t)
    section['cycle'] = targets
    _interpolate(section, t, delta, delta_dot)
    return section


def section_by_contact_loss(
    t: np.ndarray,
    phase: np.ndarray,
    delta: np.ndarray,
    delta_dot: np.ndarray,
    half_backlash: float,
) -> np.ndarray:
    """Return the states where delta falls through half_backlash: the drive flank lets go.

    Instants come from linear interpolation of delta, in error by h^2 / 8 max|delta''| / |delta'|;
    otherwise as `section_by_phase`. delta_dot decides the place on this section.
    """
    last = np.flatnonzero((delta[:-1] > half_backlash) & (delta[1:] <= half_backlash))
    share = (delta[last] - half_backlash) / (delta[last] - delta[last + 1])
    section = np.empty(len(last), SECTION)
    section['t'] = t[last] + share * (t[last + 1] - t[last])
    section['cycle'] = phase[last] + share * (phase[last + 1] - phase[last])
    _interpolate(section, t, delta, delta_dot)
    return section


def _interpolate(
    section: np.ndarray, t: np.ndarray, delta: np.ndarray, delta_dot: np.ndarray
) -> None:
    if not len(section):
        return
    section['delta'] = CubicHermiteSpline(t, delta, delta_dot)(section['t'])
    place = np.interp(section['t'], t, np.arange(len(t)))
    points = min(4, len(t))
    start = np.clip(np.floor(place).astype(int) - 1, 0, len(t) - points)
    # Lagrange's weights at equal steps.
    x = place - start
    result = np.zeros(len(section))
    for j in range(points):
        others = [k for k in range(points) if k != j]
        weight = np.prod([(x - k) / (j - k) for k in others], axis=0)
        result += weight * delta_dot[start + j]
    section['delta_dot'] = result


def poincare_points(section: np.ndarray, half_backlash: float, wn: float) -> np.ndarray:
    """Return the section in dimensionless form, dtype POINCARE: what `gear_pair/poincare` holds.

    Parameters
    ----------
    section : ndarray
        Of dtype SECTION.
    half_backlash : float
        b [m].
    wn : float
        Natural frequency scale [rad/s].
    """
    points = np.zeros(len(section), POINCARE)
    points['x'] = section['delta'] / half_backlash
    points['y'] = section['delta_dot'] / (half_backlash * wn)
    points['cycle'] = section['cycle']
    return points
