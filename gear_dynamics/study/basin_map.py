"""Basins of attraction: which attractor each initial state reaches."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.dynamics.attractors import Attractor, assign, reached, same_orbit
from gear_dynamics.dynamics.cycles import Cycles, run_cycles
from gear_dynamics.dynamics.regime import ENOUGH, recurrence_period
from gear_dynamics.study.exponents import (
    EXPONENT_UNITS,
    convergence_table,
    exponent_columns,
    verdict,
)
from gear_dynamics.study.initial import states_at
from gear_dynamics.study.judgement import judge
from gear_dynamics.study.kind import LONGEST_PERIOD, RECURS, UNDECIDED
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner

LOOK = 2 * LONGEST_PERIOD
"""Mesh cycles between two looks at which attractors the motions have reached."""

RECORD = 4 * LONGEST_PERIOD
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
    'share_error': '1',
    'points': 'b, b wn',
    'points_of': '1',
    **EXPONENT_UNITS,
}


def basins_task(
    operation: Operation,
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
    states = states_at(operation, delta, delta_dot)
    sections = np.zeros((n, RECORD, 2))
    labels = np.full(n, -1)
    for cycles in _looks(transient, known):
        rest = np.flatnonzero(labels < 0)
        if not rest.size:
            break
        run = _run(operation, states[rest], cycles)
        states[rest] = run.states
        labels[rest] = assign(operation.scaled(run.sections), known)
    for cycles in (RECORD, ENOUGH):
        rest = np.flatnonzero((labels < 0) & (np.array([*map(_period, sections)]) == 0))
        if rest.size:
            run = _run(operation, states[rest], cycles)
            states[rest] = run.states
            sections[rest] = operation.scaled(run.sections[:, -RECORD:])
            labels[rest] = assign(sections[rest], known)
    new = labels < 0
    return {'label': labels, 'sections': sections[new], 'states': states[new]}


def _looks(transient: int, known: list[Attractor]) -> list[int]:
    """Return the stretches of the transient, one without attractors to look for."""
    if not known:
        return [transient]
    count = max(math.ceil(transient / LOOK), 1)
    return [LOOK] * count


def _run(operation: Operation, states: np.ndarray, cycles: int) -> Cycles:
    pairs = [operation.pair] * len(states)
    run = (pairs, operation.speed, operation.load_torque, cycles)
    return run_cycles(*run, states=states, section_phase=SECTION)


def _period(section: np.ndarray) -> int:
    if not section.any():
        return 0
    return recurrence_period(section, RECURS, LONGEST_PERIOD)[0]


def judge_task(operation: Operation, states: np.ndarray) -> Arrays:
    """Return what `judge` finds of one motion from each attractor."""
    return judge([operation] * len(states), states, ENOUGH, section_phase=SECTION)


def basins(
    operation: Operation,
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
    judged once (`judgement.judge`), from one motion on it.

    Parameters
    ----------
    operation : Operation
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
    found = _Table(operation, runner)
    with runner.progress(size + SCOUTS, 'basins'):
        coarse = [np.linspace(-each, each, SCOUTS) for each in reach]
        _label_rows(operation, coarse[0], coarse[1], transient, found, runner)
        labels = _label_rows(operation, delta, delta_dot, transient, found, runner)
    arrays = _arrays(labels, found)
    arrays |= {'delta': delta, 'delta_dot': delta_dot}
    table = _states(arrays) | {'attractor [1]': arrays['label'].ravel()}
    return Outcome('basins', _text(operation, arrays), table, arrays, UNITS, _tables(arrays))


class _Table:
    """The attractors found so far, in the order in which they were found."""

    def __init__(self, operation: Operation, runner: Runner) -> None:
        self._operation, self._runner = operation, runner
        self.attractors: list[Attractor] = []
        self.judged: list[Arrays] = []

    def number(self, section: np.ndarray, state: np.ndarray) -> int:
        """Return the number of the attractor that a motion has reached, a new one if need be."""
        label = int(assign(section[np.newaxis], self.attractors)[0])
        return self._add(state) if label < 0 else label

    def _add(self, state: np.ndarray) -> int:
        arguments = {'operation': self._operation, 'states': state[np.newaxis]}
        judged = self._runner.run(judge_task, [arguments])[0]
        period = int(judged['period'][0])
        kind, points = str(judged['kind'][0]), judged['sections'][0]
        # A motion that took longer than all others may have come to a known attractor by now.
        for i, known in enumerate(self.attractors):
            one_orbit = period and same_orbit(points[-period:], known.points)
            if one_orbit or (not period and kind == known.kind and _one_place(points, known)):
                return i
        self.attractors.append(Attractor(kind, period, points[-period:]))
        self.judged.append(judged)
        return len(self.attractors) - 1


def _one_place(points: np.ndarray, known: Attractor) -> bool:
    """Return whether a motion without a period is on an attractor of its kind.

    All undecided motions count as one: they are not known to have reached anything.
    """
    return known.kind == UNDECIDED or bool(reached(points[np.newaxis], known)[0])


def _label_rows(
    operation: Operation,
    delta: np.ndarray,
    delta_dot: np.ndarray,
    transient: int,
    found: _Table,
    runner: Runner,
) -> np.ndarray:
    """Return the attractor of each initial state, (delta_dot, delta); add new ones to the table."""
    arguments = [
        {
            'operation': operation,
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
    arrays = {
        'label': rank[labels],
        'names': np.array([_name(each) for each in attractors]),
        'kind': np.array([each.kind for each in attractors]),
        'period': np.array([each.period for each in attractors]),
        'share': share,
        # As of independent draws; the states of a grid scatter less.
        'share_error': np.sqrt(share * (1 - share) / labels.size),
        'points': np.concatenate([each.points for each in attractors]),
        'points_of': np.repeat(np.arange(len(order)), [len(each.points) for each in attractors]),
    }
    for name in EXPONENT_UNITS:
        arrays[name] = np.concatenate([found.judged[i][name] for i in order])
    return arrays


def _name(attractor: Attractor) -> str:
    if not attractor.period:
        return attractor.kind
    return f'{attractor.kind} about {attractor.points[:, 0].mean():.3f} b'


def _text(operation: Operation, arrays: Arrays) -> str:
    lines = [
        f'w = {operation.frequency_ratio:.4f}, mu = {operation.pair.friction_coefficient:g}, '
        f'load torque {operation.load_torque:g} N m: {arrays["label"].size} initial states'
    ]
    columns = (arrays[name] for name in ('share', 'share_error', 'names'))
    largest = zip(arrays['exponents'][:, 0], arrays['standard_errors'][:, 0], strict=True)
    for share, error, name, (value, spread) in zip(*columns, largest, strict=True):
        lines.append(
            f'  {share:6.1%} +- {error:.1%}  {name}, largest exponent {value:+.4f} +- {spread:.4f}'
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
            'share_error [1]': arrays['share_error'],
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
