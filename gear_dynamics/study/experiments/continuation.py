"""Branches of periodic orbits along a parameter, with their unstable parts and bifurcations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.attractors import same_orbit
from gear_dynamics.figure_style import COLOURS, INK
from gear_dynamics.study.branch_tasks import ONE, BranchLimits, branch_task, seeds_task
from gear_dynamics.study.declaration import Option, Study
from gear_dynamics.study.drawing import legend_below, new_figure
from gear_dynamics.study.operating_point import (
    FREQUENCY_RATIO,
    OperatingPoint,
    default_operating_point,
)
from gear_dynamics.study.orbit_starts import gear_map
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.sweep import check_range, unit_of
from gear_dynamics.study.symbols import axis_label
from gear_dynamics.study.tasks import Runner

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STUDY = Study(
    'branches of periodic orbits along a parameter, through folds, with bifurcations',
    default_operating_point,
    {
        'parameter': Option('what is varied: w, speed, load_torque or a parameter of the pair'),
        'begin': Option('beginning of the range'),
        'end': Option('end of the range'),
        'places': Option('values in the range at which orbits are looked for', 2),
        'doublings': Option('flips in a row at which the branch of doubled period is followed', 0),
        'longest': Option('longest period that is looked for [mesh cycles]', 1),
        'step': Option('largest step, over the range and b', 1e-5),
        'most': Option('orbits on a branch at most', 10),
    },
    sweeps=FREQUENCY_RATIO,
)

MARKS = {'fold': 'o', 'flip': 's', 'Neimark-Sacker': 'D', 'grazing': '|'}
"""Markers of the bifurcations in the figure."""

ORBIT_UNITS = {
    'branch': '1',
    'period': 'cycles',
    'stable': '1',
    'multiplier': '1',
    'sequence': '-',
    'clearance': 'b',
    'rms': 'b',
    'least': 'b',
    'greatest': 'b',
}


def continuation(
    point: OperatingPoint,
    *,
    parameter: str = FREQUENCY_RATIO,
    begin: float = 0.3,
    end: float = 2.0,
    places: int = 6,
    doublings: int = 1,
    longest: int = 4,
    step: float = 0.02,
    most: int = 300,
    runner: Runner | None = None,
) -> Outcome:
    """Return the branches of periodic orbits along a parameter, stable and unstable.

    At some values of the parameter, motions are run until they are periodic. Each orbit that lies
    on no known branch is followed in both directions through folds until it leaves the range
    (`dynamics.continuation`). At flips the branch of doubled period is followed too.

    Parameters
    ----------
    point : OperatingPoint
    parameter : str
        What is varied: w, speed, load_torque or a number of the pair.
    begin, end : float
        Range, in the parameter's own unit.
    places : int
        Values in the range at which orbits are looked for; the ends belong to them.
    doublings : int
        Flips in a row at which the branch of doubled period is followed.
    longest : int
        Longest period that is looked for.
    step : float
        Largest step along a branch, over the length of the range and b.
    most : int
        Orbits on each half of a branch at most.
    runner : Runner, optional

    Returns
    -------
    Outcome
        Its table has one row an orbit. Its further tables are the bifurcations (`_bifurcations`).

    Raises
    ------
    ParameterError
        If the parameter cannot be varied, or the range is upside down or has no value in it.
    ValueError
        If no periodic motion is found.
    """
    point.value(parameter)
    check_range(begin=begin, end=end)
    runner = runner or Runner()
    limits = BranchLimits(parameter, begin, end, step, most)
    seats = [point.with_value(parameter, float(v)) for v in np.linspace(begin, end, places)]
    found: list[Arrays] = []
    with runner.progress(2 * places, 'branches'):
        seeds = runner.run(seeds_task, [{'point': each, 'longest': longest} for each in seats])
        for value, states in _orbits_of(np.linspace(begin, end, places), seeds):
            if not _known(point, limits, found, value, states):
                _follow(point, limits, value, states, doublings, runner, found)
    if not found:
        raise ValueError(
            f'no motion of a period up to {longest} was found at {places} values of {parameter} '
            f'from {begin:g} to {end:g}: give more --places, or a greater --longest'
        )
    arrays = _arrays(parameter, found)
    tables = {'_bifurcations': _bifurcations(arrays)}
    return Outcome('continuation', _text(arrays), _table(arrays), arrays, _units(arrays), tables)


def _orbits_of(values: np.ndarray, seeds: list[Arrays]) -> Iterator[tuple[float, np.ndarray]]:
    for value, seed in zip(values, seeds, strict=True):
        ends = np.cumsum(seed['period'])
        for period, last in zip(seed['period'], ends, strict=True):
            yield float(value), seed['states'][last - period : last]


def _known(
    point: OperatingPoint,
    limits: BranchLimits,
    found: list[Arrays],
    value: float,
    states: np.ndarray,
) -> bool:
    """Return whether an orbit lies on a branch: Newton's method comes to it from a neighbour."""
    system = gear_map(point.with_value(limits.parameter, value))
    for branch in found:
        if branch['states'].shape[1:] != states.shape:
            continue
        side = branch['value'] > value
        for i in np.flatnonzero(side[1:] != side[:-1]):
            try:
                orbit = dynamics.periodic_orbit(system, len(states), branch['states'][i])
            except dynamics.OrbitError:
                continue
            if same_orbit(orbit.points, states, ONE):
                return True
    return False


def _follow(
    point: OperatingPoint,
    limits: BranchLimits,
    value: float,
    states: np.ndarray,
    doublings: int,
    runner: Runner,
    found: list[Arrays],
    tangent: np.ndarray | None = None,
) -> None:
    """Add the branch through an orbit to those found, and those of doubled periods."""
    arguments = {
        'point': point,
        'limits': limits,
        'value': value,
        'states': states,
        'tangent': np.empty(0) if tangent is None else tangent,
    }
    try:
        branch = runner.run(branch_task, [arguments])[0]
    except dynamics.OrbitError:
        return
    found.append(branch)
    if not doublings or 2 * len(states) > dynamics.LONGEST:
        return
    flips = np.flatnonzero(branch['kind'] == 'flip')
    for i, guess, direction in zip(
        flips, branch['doubled'], branch['doubled_tangent'], strict=True
    ):
        at = float(branch['at_value'][i])
        if not _passes(found, at, guess):
            _follow(point, limits, at, guess, doublings - 1, runner, found, direction)


def _passes(found: list[Arrays], value: float, guess: np.ndarray) -> bool:
    """Return whether a known branch of the same period ends at this flip."""
    for branch in found:
        if branch['states'].shape[1:] == guess.shape:
            near = np.abs(branch['value'] - value) < 1e-3 * max(abs(value), 1e-12)
            for states in branch['states'][near]:
                if same_orbit(states, guess, 0.05):
                    return True
    return False


def _arrays(parameter: str, found: list[Arrays]) -> Arrays:
    arrays: Arrays = {'parameter': np.array(parameter)}
    names = ('value', 'multiplier', 'sequence', 'clearance', 'rms', 'least', 'greatest')
    for prefix in ('', 'at_'):
        for name in names:
            arrays[prefix + name] = np.concatenate([each[prefix + name] for each in found])
        counts = [len(each[f'{prefix}value']) for each in found]
        arrays[f'{prefix}branch'] = np.repeat(np.arange(len(found)), counts)
        periods = [each['states'].shape[1] for each in found]
        arrays[f'{prefix}period'] = np.repeat(periods, counts)
    arrays['stable'] = np.abs(arrays['multiplier']) < 1
    arrays['kind'] = np.concatenate([each['kind'] for each in found])
    arrays['critical'] = np.concatenate([each['critical'] for each in found])
    arrays['end'] = np.array([', '.join(dict.fromkeys(each['end'])) for each in found])
    return arrays


def _units(arrays: Arrays) -> dict[str, str]:
    unit = unit_of(str(arrays['parameter']))
    units = ORBIT_UNITS | {'value': unit, 'parameter': '-', 'kind': '-', 'end': '-'}
    units |= {f'at_{name}': each for name, each in units.items()}
    return units | {'critical': '1'}


def _text(arrays: Arrays) -> str:
    parameter = str(arrays['parameter'])
    lines = [f'Branches of periodic orbits along {parameter}']
    for i, end in enumerate(arrays['end']):
        own = arrays['branch'] == i
        values, period = arrays['value'][own], arrays['period'][own][0]
        lines.append(
            f'  branch {i}: period-{period}, {own.sum()} orbits at {values.min():.6g} to '
            f'{values.max():.6g}, {arrays["stable"][own].mean():.0%} stable; ends: {end}'
        )
        for j in np.flatnonzero(arrays['at_branch'] == i):
            critical = complex(arrays['critical'][j])
            lines.append(
                f'    {arrays["kind"][j]} at {arrays["at_value"][j]:.9g}, multiplier '
                f'{critical:.9f}, modulus {abs(critical):.9f}'
            )
    return '\n'.join(lines)


def _table(arrays: Arrays) -> dict[str, np.ndarray]:
    parameter = str(arrays['parameter'])
    return {
        'branch [1]': arrays['branch'],
        f'{parameter} [{unit_of(parameter)}]': arrays['value'],
        'period [cycles]': arrays['period'],
        'stable [1]': arrays['stable'].astype(int),
        'multiplier_real [1]': arrays['multiplier'].real,
        'multiplier_imaginary [1]': arrays['multiplier'].imag,
        'sequence [-]': arrays['sequence'],
        'clearance [b]': arrays['clearance'],
        'rms_delta [b]': arrays['rms'],
        'least_delta [b]': arrays['least'],
        'greatest_delta [b]': arrays['greatest'],
    }


def _bifurcations(arrays: Arrays) -> dict[str, np.ndarray]:
    parameter = str(arrays['parameter'])
    critical = arrays['critical']
    return {
        'branch [1]': arrays['at_branch'],
        'bifurcation [-]': arrays['kind'],
        f'{parameter} [{unit_of(parameter)}]': arrays['at_value'],
        'period [cycles]': arrays['at_period'],
        'multiplier_real [1]': critical.real,
        'multiplier_imaginary [1]': critical.imag,
        'multiplier_modulus [1]': np.abs(critical),
        'rms_delta [b]': arrays['at_rms'],
    }


def draw(arrays: Arrays) -> Figure:
    """Draw the RMS along the branches: solid where stable, dashed where not, with marks."""
    figure = new_figure(9, 5.5, 'Periodic orbits along a parameter')
    axes = figure.subplots()
    for i in range(len(arrays['end'])):
        own = arrays['branch'] == i
        period = int(arrays['period'][own][0])
        colour = COLOURS[int(math.log2(period)) % len(COLOURS)]
        for stable, style in ((True, '-'), (False, '--')):
            shown = np.where(arrays['stable'][own] == stable, arrays['rms'][own], np.nan)
            axes.plot(arrays['value'][own], shown, style, color=colour, linewidth=1.2)
    for kind, marker in MARKS.items():
        which = arrays['kind'] == kind
        if which.any():
            look = {'marker': marker, 'linestyle': 'none', 'color': INK, 'markersize': 5}
            axes.plot(arrays['at_value'][which], arrays['at_rms'][which], label=kind, **look)
    axes.plot([], [], '-', color=INK, label='stable')
    axes.plot([], [], '--', color=INK, label='unstable')
    parameter = str(arrays['parameter'])
    axes.set(xlabel=axis_label(parameter), ylabel='RMS of δ / b')
    axes.set_ylim(bottom=0)
    legend_below(axes, axes.get_legend_handles_labels()[0])
    return figure
