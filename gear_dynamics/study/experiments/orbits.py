"""Periodic orbits, stable and unstable, found by shooting."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.attractors import same_orbit
from gear_dynamics.figure_style import COLOURS, INK
from gear_dynamics.study.declaration import TRANSIENT_OPTION, Option, Study
from gear_dynamics.study.drawing import legend_below, new_figure, zero_line
from gear_dynamics.study.operating_point import OperatingPoint, friction_chaos
from gear_dynamics.study.orbit_starts import close_returns, gear_map, recorded
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.tasks import Runner

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gear_dynamics.dynamics.shooting import PeriodicOrbit

MOTIONS = 8
"""Motions in which close returns are looked for."""

ONE = 1e-6
"""Distance of the states within which two orbits are one."""

STUDY = Study(
    'periodic orbits, stable and unstable, with Floquet multipliers',
    friction_chaos,
    {
        'longest': Option('longest period [mesh cycles], at most 32', 1),
        'starts': Option('starts for each period and motion: the closest returns', 1),
        'transient': TRANSIENT_OPTION,
    },
)

UNITS = {
    'orbit': '1',
    'period': 'cycles',
    'stable': '1',
    'residual': 'b, b wn',
    'multipliers': '1',
    'multiplier_errors': '1',
    'exponent': '1/tau',
    'sequence': '-',
    'clearance': 'b',
    'rms': 'b',
    'least': 'b',
    'greatest': 'b',
    'points': 'b, b wn',
    'points_of': '1',
    'states': 'b, b wn',
}


def orbits_task(point: OperatingPoint, period: int, starts: Sequence[np.ndarray]) -> Arrays:
    """Return the orbits of a period that Newton's method reaches from some starts, each once.

    `states` (n * period, dimension) holds their points, `failed` how many starts did not converge.
    """
    system, failed = gear_map(point), 0
    found: list[PeriodicOrbit] = []
    for start in starts:
        try:
            orbit = dynamics.periodic_orbit(system, period, start)
        except dynamics.OrbitError:
            failed += 1
            continue
        if orbit.period == period and not any(_one(orbit, other) for other in found):
            found.append(orbit)
    empty = np.empty((0, system.dimension))
    return {
        'states': np.concatenate([empty, *(each.points for each in found)]),
        'failed': np.array(failed),
    }


def _one(orbit: PeriodicOrbit, other: PeriodicOrbit) -> bool:
    return same_orbit(orbit.points, other.points, ONE)


def orbits(
    point: OperatingPoint,
    *,
    longest: int = 4,
    starts: int = 3,
    transient: int = 300,
    runner: Runner | None = None,
) -> Outcome:
    """Return the periodic orbits up to a period, stable and unstable.

    Newton's method on the stroboscopic map (`dynamics.periodic_orbit`) starts from the closest
    returns of several motions: a chaotic motion comes near each of its unstable orbits again and
    again. It finds many orbits, and does not prove that there are no others.

    Parameters
    ----------
    point : OperatingPoint
    longest : int
        Longest period [mesh cycles], at most 32.
    starts : int
        Starts for each period and motion.
    transient : int
        Mesh cycles before the record in which close returns are looked for.
    runner : Runner, optional

    Returns
    -------
    Outcome
        Its table has one row an orbit. Its further tables are the points on the section
        (`_points`) and all multipliers (`_multipliers`).

    Raises
    ------
    ValueError
        If the longest period is above 32, or no orbit is found.
    """
    if longest > dynamics.LONGEST:
        raise ValueError(f'longest is {longest}: it must be {dynamics.LONGEST} or less')
    runner = runner or Runner()
    with runner.progress(longest, 'orbits'):
        # Without a task: what compiles announces itself within the progress.
        motions = recorded(point, MOTIONS, transient)
        arguments: list[dict[str, Any]] = [
            {
                'point': point,
                'period': period,
                'starts': [
                    part for each in motions for part in close_returns(each, period, starts)
                ],
            }
            for period in range(1, longest + 1)
        ]
        results = runner.run(orbits_task, arguments)
    failed = sum(int(result['failed']) for result in results)
    arrays = _arrays(point, [result['states'] for result in results])
    tried = sum(len(each['starts']) for each in arguments)
    if not len(arrays['period']):
        raise ValueError(
            f'no periodic orbit up to period {longest} was found from {tried} starts: give more '
            'starts, or a longer period'
        )
    text = _text(point, arrays, tried, failed)
    return Outcome('orbits', text, _table(arrays), arrays, UNITS, _tables(arrays))


def _arrays(point: OperatingPoint, states: Sequence[np.ndarray]) -> Arrays:
    """Return what is known of orbits, from their points by period."""
    system = gear_map(point)
    rows: dict[str, list] = {name: [] for name in UNITS if name not in ('points', 'points_of')}
    points = [np.empty((0, 2))]
    for period, each in enumerate(states, start=1):
        for start in each.reshape(-1, period, system.dimension):
            orbit = dynamics.periodic_orbit(system, period, start)
            contact = system.contact(orbit.points)
            largest = float(np.abs(orbit.multipliers[0]))
            values = {
                'orbit': len(rows['orbit']),
                'period': period,
                'stable': orbit.stable,
                'residual': orbit.residual,
                'multipliers': orbit.multipliers,
                'multiplier_errors': orbit.errors,
                'exponent': np.log(largest) / (period * system.cycle),
                **contact._asdict(),
                'states': orbit.points[0],
            }
            for name, value in values.items():
                rows[name].append(value)
            points.append(system.section(orbit.points))
    arrays = {name: np.array(values) for name, values in rows.items()}
    arrays['points'] = np.concatenate(points)
    arrays['points_of'] = np.repeat(arrays['orbit'], arrays['period']).astype(int)
    return arrays


def _text(point: OperatingPoint, arrays: Arrays, tried: int, failed: int) -> str:
    lines = [
        f'w = {point.frequency_ratio:.4f}, mu = {point.pair.friction_coefficient:g}, load torque '
        f'{point.load_torque:g} N m: {len(arrays["period"])} periodic orbits from {tried} starts, '
        f'of which {failed} did not converge'
    ]
    for i, period in enumerate(arrays['period']):
        multiplier = complex(arrays['multipliers'][i, 0])
        lines.append(
            f'  {i}: period-{period}, {("unstable", "stable")[int(arrays["stable"][i])]}, largest '
            f'multiplier {multiplier:.6f} (+- {arrays["multiplier_errors"][i, 0]:.0e}), contact '
            f'{arrays["sequence"][i]}, {arrays["clearance"][i]:+.4f} b from grazing'
        )
    return '\n'.join(lines)


def _table(arrays: Arrays) -> dict[str, np.ndarray]:
    largest = arrays['multipliers'][:, 0]
    return {
        'orbit [1]': arrays['orbit'],
        'period [cycles]': arrays['period'],
        'stable [1]': arrays['stable'].astype(int),
        'multiplier_real [1]': largest.real,
        'multiplier_imaginary [1]': largest.imag,
        'multiplier_error [1]': arrays['multiplier_errors'][:, 0],
        'exponent [1/tau]': arrays['exponent'],
        'sequence [-]': arrays['sequence'],
        'clearance [b]': arrays['clearance'],
        'rms_delta [b]': arrays['rms'],
        'least_delta [b]': arrays['least'],
        'greatest_delta [b]': arrays['greatest'],
        'residual [b]': arrays['residual'],
    }


def _tables(arrays: Arrays) -> dict[str, dict[str, np.ndarray]]:
    count = arrays['multipliers'].shape[1]
    return {
        '_points': {
            'orbit [1]': arrays['points_of'],
            'delta [b]': arrays['points'][:, 0],
            'delta_dot [b wn]': arrays['points'][:, 1],
        },
        '_multipliers': {
            'orbit [1]': np.repeat(arrays['orbit'], count),
            'multiplier_real [1]': arrays['multipliers'].real.ravel(),
            'multiplier_imaginary [1]': arrays['multipliers'].imag.ravel(),
            'multiplier_error [1]': arrays['multiplier_errors'].ravel(),
        },
    }


def draw(arrays: Arrays) -> Figure:
    """Draw the orbits on the section, and their multipliers about the unit circle."""
    figure = new_figure(9, 4.6, 'Periodic orbits at mesh phase 0 and their multipliers')
    section, plane = figure.subplots(1, 2)
    for i, period in enumerate(arrays['period']):
        colour = COLOURS[int(period - 1) % len(COLOURS)]
        inside = colour if arrays['stable'][i] else 'none'
        look = {'s': 26, 'facecolors': inside, 'edgecolors': colour, 'linewidths': 1.2}
        section.scatter(*arrays['points'][arrays['points_of'] == i].T, **look)
        values = arrays['multipliers'][i]
        plane.scatter(values.real, values.imag, **look)
    angle = np.linspace(0, 2 * np.pi, 200)
    plane.plot(np.cos(angle), np.sin(angle), color=INK, linewidth=0.8)
    zero_line(plane)
    section.set(xlabel='δ / b', ylabel="δ' / (b ωn)")
    plane.set(xlabel='real part', ylabel='imaginary part', aspect='equal')
    handles = []
    for period in np.unique(arrays['period']):
        colour = COLOURS[int(period - 1) % len(COLOURS)]
        handles += section.plot([], [], 'o', color=colour, label=f'period-{period}')
    handles += section.plot([], [], 'o', color=INK, mfc='none', label='open: unstable')
    legend_below(section, handles)
    return figure
