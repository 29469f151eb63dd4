"""Starts of the search for periodic orbits: close returns of motions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.regimes import LONGEST_STUDIED, RECURS
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import OperatingPoint

if TYPE_CHECKING:
    from gear_dynamics.dynamics.stroboscopic import GearMap

RECORD = 256
"""Mesh cycles in which close returns are looked for."""


def gear_map(point: OperatingPoint) -> GearMap:
    """Return the stroboscopic map of an operating point."""
    return dynamics.GearMap(point.pair, point.speed, point.load_torque)


def recorded(point: OperatingPoint, motions: int, transient: int) -> np.ndarray:
    """Return states of the map along motions after a transient, (motions, RECORD, dimension).

    The first motion begins at the static state, the others are scattered.
    """
    run = ([point.pair] * motions, point.speed, point.load_torque)
    states = scattered_states(point, motions)
    if transient:
        states = dynamics.run_cycles(*run, transient, states=states).states
    record = dynamics.run_cycles(*run, RECORD, states=states, section_phase=0.0)
    return gear_map(point).scaled(record.sections[:, :, 2:])


def settled_period(states: np.ndarray) -> int:
    """Return the period of a motion, 0 without one, from its states, (cycles, dimension)."""
    last = states[-4 * LONGEST_STUDIED :]
    return dynamics.recurrence_period(last, RECURS, LONGEST_STUDIED)[0]


def close_returns(states: np.ndarray, period: int, count: int) -> list[np.ndarray]:
    """Return the parts of a motion that come nearest to closing after a period.

    Parameters
    ----------
    states : (cycles, dimension) array
    period : int
    count : int
        Parts at most. They do not overlap.

    Returns
    -------
    list of (period, dimension) arrays, the closest first
    """
    away = np.abs(states[period:] - states[:-period]).max(axis=1)
    parts: list[np.ndarray] = []
    taken: list[int] = []
    for begin in np.argsort(away, kind='stable'):
        if len(parts) == count:
            break
        if all(abs(begin - other) >= period for other in taken):
            taken.append(int(begin))
            parts.append(states[begin : begin + period])
    return parts
