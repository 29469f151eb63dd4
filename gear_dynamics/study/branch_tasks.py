"""Tasks of the study of branches: the orbits that motions come to, and the branch through one."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.attractors import same_orbit
from gear_dynamics.study.operating_point import OperatingPoint
from gear_dynamics.study.orbit_starts import gear_map, recorded, settled_period
from gear_dynamics.study.outcome import Arrays

if TYPE_CHECKING:
    from gear_dynamics.dynamics.arclength import CurvePoint
    from gear_dynamics.dynamics.branches import Bifurcation, Branch
    from gear_dynamics.dynamics.shooting import PeriodicOrbit
    from gear_dynamics.dynamics.stroboscopic import GearMap

MOTIONS = 4
"""Motions from which orbits are looked for at each place."""

TRANSIENT = 500
"""Mesh cycles before a motion is asked for its period."""

ONE = 1e-5
"""Distance of the states within which two orbits are one."""


class BranchLimits(NamedTuple):
    """How far branches are followed.

    Attributes
    ----------
    parameter : str
    begin, end, step : float
    most : int
    """

    parameter: str
    begin: float
    end: float
    step: float
    most: int


def seeds_task(point: OperatingPoint, longest: int) -> Arrays:
    """Return the periodic orbits that some motions come to: `period` (n,) and their `states`."""
    system = gear_map(point)
    found: list[PeriodicOrbit] = []
    for states in recorded(point, MOTIONS, TRANSIENT):
        period = settled_period(states)
        if not 0 < period <= longest:
            continue
        try:
            orbit = dynamics.periodic_orbit(system, period, states[-period:])
        except dynamics.OrbitError:
            continue
        if not any(same_orbit(orbit.points, other.points, ONE) for other in found):
            found.append(orbit)
    empty = np.empty((0, system.dimension))
    return {
        'period': np.array([each.period for each in found], dtype=int),
        'states': np.concatenate([empty, *(each.points for each in found)]),
    }


def branch_task(
    point: OperatingPoint,
    limits: BranchLimits,
    value: float,
    states: np.ndarray,
    tangent: np.ndarray,
) -> Arrays:
    """Return the branch through an orbit, in both directions, or along a tangent if one is given.

    `value`, `states` and `multipliers` of its orbits; `kind`, `critical`, `at_value`, `at_states`
    and `at_tangent` of its bifurcations; `contact` and `at_contact`; `end`, why its ends end.
    """

    def family(value: float) -> GearMap:
        return gear_map(point.with_value(limits.parameter, value))

    def sequence(orbit: CurvePoint) -> str:
        return family(orbit.value).contact(orbit.points).sequence

    def follow(start: PeriodicOrbit | CurvePoint, rising: bool) -> Branch:
        return dynamics.continuation(
            family,
            start,
            value,
            limits.begin,
            limits.end,
            rising=rising,
            sequence=sequence,
            largest_step=limits.step,
            most=limits.most,
        )

    if tangent.size:
        curve = dynamics.Curve(family, limits.begin, limits.end, len(states))
        parts = [follow(curve.correct(value, states, tangent), True)]
    else:
        start = dynamics.periodic_orbit(family(value), len(states), states)
        parts = [follow(start, True)]
        if parts[0].end != 'closed':
            parts.insert(0, follow(start, False))
    return _packed(family, parts)


def _packed(family: Callable[[float], GearMap], parts: list[Branch]) -> Arrays:
    orbits: list[CurvePoint] = [*parts[-1].orbits]
    found: list[Bifurcation] = [*parts[-1].bifurcations]
    if len(parts) == 2:
        orbits = [*reversed(parts[0].orbits[1:]), *orbits]
        found = [*reversed(parts[0].bifurcations), *found]
    arrays = {
        'end': np.array([part.end for part in parts]),
        'kind': np.array([each.kind for each in found], dtype='U16'),
        'critical': np.array([each.multiplier for each in found], dtype=complex),
    }
    for prefix, points in (('', orbits), ('at_', [each.at for each in found])):
        contacts = [family(each.value).contact(each.points) for each in points]
        arrays[f'{prefix}value'] = np.array([each.value for each in points])
        arrays[f'{prefix}states'] = np.array([each.points for each in points])
        arrays[f'{prefix}multiplier'] = np.array([each.multipliers[0] for each in points])
        arrays[f'{prefix}sequence'] = np.array([each.sequence for each in contacts], dtype='U64')
        for name in ('clearance', 'rms', 'least', 'greatest'):
            arrays[f'{prefix}{name}'] = np.array([getattr(each, name) for each in contacts])
    arrays['doubled'], arrays['doubled_tangent'] = _doubled(family, found)
    return arrays


def _doubled(
    family: Callable[[float], GearMap], found: list[Bifurcation]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the first doubled orbits at the flips, and the directions away from the flips."""
    flips = [each for each in found if each.kind == 'flip']
    guesses = [dynamics.doubled_guess(family, each) for each in flips]
    return (
        np.array([points for points, _ in guesses]),
        np.array([direction for _, direction in guesses]),
    )
