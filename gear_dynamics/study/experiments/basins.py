"""Basins of attraction: which attractor each initial state reaches."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.attractors import Attractor, assign, reached, same_orbit
from gear_dynamics.dynamics.basin_measures import BOX
from gear_dynamics.dynamics.regimes import (
    ENOUGH,
    LONGEST_STUDIED,
    RECURS,
    UNDECIDED,
    recurrence_period,
)
from gear_dynamics.figure_style import COLOURS, FAINT, INK
from gear_dynamics.study.assessment import assess
from gear_dynamics.study.declaration import TRANSIENT_OPTION, Option, Study
from gear_dynamics.study.drawing import legend_below, new_figure
from gear_dynamics.study.exponent_tables import (
    EXPONENT_UNITS,
    convergence_table,
    exponent_columns,
    verdict,
)
from gear_dynamics.study.initial import states_at
from gear_dynamics.study.operating_point import OperatingPoint, friction_chaos
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.tasks import Runner

if TYPE_CHECKING:
    from matplotlib.figure import Figure


LOOK = 2 * LONGEST_STUDIED
"""Mesh cycles between two looks at which attractors the motions have reached."""

RECORD = 4 * LONGEST_STUDIED
"""Mesh cycles from which the period of a motion that reached no known attractor is told."""

SCOUTS = 8
"""Initial states along each side of the coarse picture from which the attractors are found."""

SECTION = 0.0
"""Mesh phase of the section: that of the initial states, so that both share a picture."""

UNITS = {
    'delta': 'b',
    'delta_dot': 'b wn',
    'label': '1',
    'names': '-',
    'kind': '-',
    'period': 'cycles',
    'share': '1',
    'share_low': '1',
    'share_high': '1',
    'entropy': '1',
    'boundary_entropy': '1',
    'uncertainty_exponent': '1',
    'uncertainty_error': '1',
    'points': 'b, b wn',
    'points_of': '1',
    **EXPONENT_UNITS,
}

STUDY = Study(
    'which attractor each initial state reaches',
    friction_chaos,
    {
        'size': Option('initial states along each side of the picture', 2),
        'reach': Option('greatest delta / b and delta_dot / (b wn), above 0'),
        'transient': TRANSIENT_OPTION,
    },
)


def basins_task(
    point: OperatingPoint,
    delta: np.ndarray,
    delta_dot: np.ndarray,
    transient: int,
    known: list[Attractor],
) -> Arrays:
    """Return the known attractor that each initial state reaches, -1 if it reaches none of them.

    A motion that has reached one is followed no longer. Of the others, in their order, `sections`
    holds the last RECORD points after the transient, and after ENOUGH cycles more if these show no
    period; `states` is where they end.
    """
    n = len(delta)
    states = states_at(point, delta, delta_dot)
    sections = np.zeros((n, RECORD, 2))
    labels = np.full(n, -1)
    for cycles in _looks(transient, known):
        rest = np.flatnonzero(labels < 0)
        if not rest.size:
            break
        run = _run(point, states[rest], cycles)
        states[rest] = run.states
        labels[rest] = assign(point.scaled(run.sections), known)
    for cycles in (RECORD, ENOUGH):
        rest = np.flatnonzero((labels < 0) & (np.array([*map(_period, sections)]) == 0))
        if rest.size:
            run = _run(point, states[rest], cycles)
            states[rest] = run.states
            sections[rest] = point.scaled(run.sections[:, -RECORD:])
            labels[rest] = assign(sections[rest], known)
    new = labels < 0
    return {'label': labels, 'sections': sections[new], 'states': states[new]}


def _looks(transient: int, known: list[Attractor]) -> list[int]:
    """Return the stretches of the transient, one without attractors to look for."""
    if not known:
        return [transient]
    count = max(math.ceil(transient / LOOK), 1)
    return [LOOK] * count


def _run(point: OperatingPoint, states: np.ndarray, cycles: int) -> dynamics.Cycles:
    pairs = [point.pair] * len(states)
    run = (pairs, point.speed, point.load_torque, cycles)
    return dynamics.run_cycles(*run, states=states, section_phase=SECTION)


def _period(section: np.ndarray) -> int:
    if not section.any():
        return 0
    return recurrence_period(section, RECURS, LONGEST_STUDIED)[0]


def assess_task(point: OperatingPoint, states: np.ndarray) -> Arrays:
    """Return what `assess` finds of one motion from each attractor."""
    return assess([point] * len(states), states, ENOUGH, section_phase=SECTION)


def basins(
    point: OperatingPoint,
    *,
    size: int = 80,
    reach: tuple[float, float] = (2.0, 1.0),
    transient: int = 400,
    runner: Runner | None = None,
) -> Outcome:
    """Return the attractor that each initial state (delta, delta_dot) reaches.

    The bodies begin at rest where the static load puts them, at mesh phase 0. The attractors are
    found from a coarse picture first; a motion is then followed until it has reached one of them,
    and a motion that reaches none of them adds a new one. Periodic orbits are told apart by their
    points on the section, others by where these lie (`dynamics.attractors`). Each attractor is
    assessed once (`assessment.assess`), from one motion on it.

    Parameters
    ----------
    point : OperatingPoint
    size : int
        Initial states along each side of the picture.
    reach : two floats
        Greatest delta / b and delta_dot / (b wn).
    transient : int
        Mesh cycles before the attractor of a motion is told that has reached no known one.
    runner : Runner, optional

    Returns
    -------
    Outcome
        Its table has one row an initial state. Its further tables are the attractors with shares,
        exponents and section points (`_attractors`, `_points`) and the means of all exponents over
        the first cycles (`_convergence`).

    Raises
    ------
    ValueError
        If the reach is not above 0.
    """
    if not min(reach) > 0:
        raise ValueError(f'reach is {reach[0]:g} {reach[1]:g}: both must be above 0')
    runner = runner or Runner()
    delta = np.linspace(-reach[0], reach[0], size)
    delta_dot = np.linspace(-reach[1], reach[1], size)
    found = _Table(point, runner)
    with runner.progress(size + SCOUTS, 'basins'):
        coarse = [np.linspace(-each, each, SCOUTS) for each in reach]
        _label_rows(point, coarse[0], coarse[1], transient, found, runner)
        labels = _label_rows(point, delta, delta_dot, transient, found, runner)
    arrays = _arrays(labels, found)
    arrays |= {'delta': delta, 'delta_dot': delta_dot}
    table = _states(arrays) | {'attractor [1]': arrays['label'].ravel()}
    return Outcome('basins', _text(point, arrays), table, arrays, UNITS, _tables(arrays))


class _Table:
    """The attractors found so far, in the order in which they were found."""

    def __init__(self, point: OperatingPoint, runner: Runner) -> None:
        self._operation, self._runner = point, runner
        self.attractors: list[Attractor] = []
        self.assessed: list[Arrays] = []

    def number(self, section: np.ndarray, state: np.ndarray) -> int:
        """Return the number of the attractor that a motion has reached, a new one if need be."""
        label = int(assign(section[np.newaxis], self.attractors)[0])
        return self._add(state) if label < 0 else label

    def _add(self, state: np.ndarray) -> int:
        arguments = {'point': self._operation, 'states': state[np.newaxis]}
        assessed = self._runner.run(assess_task, [arguments])[0]
        period = int(assessed['period'][0])
        kind, points = str(assessed['kind'][0]), assessed['sections'][0]
        # A motion that took longer than all others may have come to a known attractor by now.
        for i, known in enumerate(self.attractors):
            one_orbit = period and same_orbit(points[-period:], known.points)
            if one_orbit or (not period and kind == known.kind and _one_place(points, known)):
                return i
        self.attractors.append(Attractor(kind, period, points[-period:]))
        self.assessed.append(assessed)
        return len(self.attractors) - 1


def _one_place(points: np.ndarray, known: Attractor) -> bool:
    """Return whether a motion without a period is on an attractor of its kind.

    All undecided motions count as one: they are not known to have reached anything.
    """
    return known.kind == UNDECIDED or bool(reached(points[np.newaxis], known)[0])


def _label_rows(
    point: OperatingPoint,
    delta: np.ndarray,
    delta_dot: np.ndarray,
    transient: int,
    found: _Table,
    runner: Runner,
) -> np.ndarray:
    """Return the attractor of each initial state, (delta_dot, delta); add new ones to the table."""
    arguments = [
        {
            'point': point,
            'delta': delta,
            'delta_dot': np.full(len(delta), each),
            'transient': transient,
            'known': list(found.attractors),
        }
        for each in delta_dot
    ]
    results = runner.run(basins_task, arguments)
    labels = np.array([result['label'] for result in results])
    for row, result in zip(labels, results, strict=True):
        new = zip(np.flatnonzero(row < 0), result['sections'], result['states'], strict=True)
        for i, section, state in new:
            row[i] = found.number(section, state)
    return labels


def _arrays(labels: np.ndarray, found: _Table) -> Arrays:
    """Return labels and attractors, the largest basin first."""
    counts = np.bincount(labels.ravel(), minlength=len(found.attractors))
    order = [i for i in np.argsort(-counts, kind='stable') if counts[i]]
    rank = np.full(len(counts), -1)
    rank[order] = np.arange(len(order))
    attractors = [found.attractors[i] for i in order]
    share = counts[order] / labels.size
    low, high = dynamics.wilson_interval(counts[order], labels.size)
    arrays = {
        'label': rank[labels],
        'names': np.array([_name(each) for each in attractors]),
        'kind': np.array([each.kind for each in attractors]),
        'period': np.array([each.period for each in attractors]),
        'share': share,
        # As of independent draws; the states of a grid scatter less.
        'share_low': low,
        'share_high': high,
        'points': np.concatenate([each.points for each in attractors]),
        'points_of': np.repeat(np.arange(len(order)), [len(each.points) for each in attractors]),
    }
    arrays |= _picture(labels)
    for name in EXPONENT_UNITS:
        arrays[name] = np.concatenate([found.assessed[i][name] for i in order])
    return arrays


def _picture(labels: np.ndarray) -> Arrays:
    """Return the basin entropy and the uncertainty exponent of the picture, NaN if too small."""
    box = dynamics.basin_entropy(labels, min(BOX, *labels.shape))
    slope = dynamics.uncertainty_exponent(labels)
    return {
        'entropy': np.array(box.entropy),
        'boundary_entropy': np.array(box.boundary_entropy),
        'uncertainty_exponent': np.array(slope.exponent),
        'uncertainty_error': np.array(slope.standard_error),
    }


def _name(attractor: Attractor) -> str:
    if not attractor.period:
        return attractor.kind
    return f'{attractor.kind} about {attractor.points[:, 0].mean():.3f} b'


def _text(point: OperatingPoint, arrays: Arrays) -> str:
    lines = [
        f'w = {point.frequency_ratio:.4f}, mu = {point.pair.friction_coefficient:g}, '
        f'load torque {point.load_torque:g} N m: {arrays["label"].size} initial states'
    ]
    columns = (arrays[name] for name in ('share', 'share_low', 'share_high', 'names'))
    largest = zip(arrays['exponents'][:, 0], arrays['standard_errors'][:, 0], strict=True)
    for share, low, high, name, (value, spread) in zip(*columns, largest, strict=True):
        lines.append(
            f'  {share:6.1%} ({low:.1%} to {high:.1%})  {name}, '
            f'largest exponent {value:+.4f} +- {spread:.4f}'
        )
    if len(arrays['names']) > 1:
        lines.append(
            f'Basin entropy {arrays["entropy"]:.3f}, of the boxes on boundaries '
            f'{arrays["boundary_entropy"]:.3f} (fractal for certain above ln 2 = 0.693); '
            f'uncertainty exponent {arrays["uncertainty_exponent"]:.2f} +- '
            f'{arrays["uncertainty_error"]:.2f} (1 for a smooth boundary)'
        )
    lines.append(verdict(arrays['settled'], arrays['sum_error']))
    return '\n'.join(lines)


def _states(arrays: Arrays) -> dict[str, np.ndarray]:
    slope, delta = np.meshgrid(arrays['delta_dot'], arrays['delta'], indexing='ij')
    return {'delta [b]': delta.ravel(), 'delta_dot [b wn]': slope.ravel()}


def _tables(arrays: Arrays) -> dict[str, dict[str, np.ndarray]]:
    numbers = np.arange(len(arrays['names']))
    return {
        '_attractors': {
            'attractor [1]': numbers,
            'name [-]': arrays['names'],
            'kind [-]': arrays['kind'],
            'period [cycles]': arrays['period'],
            'share [1]': arrays['share'],
            'share_low [1]': arrays['share_low'],
            'share_high [1]': arrays['share_high'],
            'settled [1]': arrays['settled'].all(axis=-1).astype(int),
            'sum_error [1]': arrays['sum_error'],
            **exponent_columns(arrays['exponents'], arrays['standard_errors']),
        },
        '_points': {
            'attractor [1]': arrays['points_of'],
            'delta [b]': arrays['points'][:, 0],
            'delta_dot [b wn]': arrays['points'][:, 1],
        },
        '_convergence': convergence_table({'attractor [1]': numbers}, arrays),
    }


SURFACE = '#ffffff'

NAMED = len(COLOURS)
"""Attractors with a colour of their own; those that few states reach share one."""


def draw(arrays: Arrays) -> Figure:
    """Draw the attractor of each initial state in its colour, with shares, and its points."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    figure = new_figure(8, 6.5, 'Which motion an initial state ends in')
    axes = figure.subplots()
    label = np.minimum(arrays['label'], NAMED)
    colours = ListedColormap([*COLOURS, FAINT])
    axes.pcolormesh(
        arrays['delta'], arrays['delta_dot'], label, cmap=colours, vmin=-0.5, vmax=NAMED + 0.5
    )
    for i in range(min(NAMED, len(arrays['share']))):
        points = arrays['points'][arrays['points_of'] == i]
        size, edge = (28, 0.8) if arrays['period'][i] else (1, 0)
        axes.scatter(*points.T, s=size, color=SURFACE if edge else INK, edgecolor=INK, lw=edge)
    axes.set(xlabel='δ / b', ylabel="δ' / (b ωn)")
    axes.grid(False)
    shares = arrays['share']
    handles = [
        Patch(color=COLOURS[i], label=f'{arrays["names"][i]}: {shares[i]:.1%}')
        for i in range(min(NAMED, len(shares)))
    ]
    if len(shares) > NAMED:
        handles.append(Patch(color=FAINT, label=f'others: {shares[NAMED:].sum():.1%}'))
    legend_below(axes, handles)
    return figure
