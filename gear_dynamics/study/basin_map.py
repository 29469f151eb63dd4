"""Basins of attraction: which motion each initial state ends in."""

from __future__ import annotations

import numpy as np

from gear_dynamics.analysis.regime import recurrence_period
from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.study.initial import states_at
from gear_dynamics.study.kind import LONGEST_PERIOD, RECURS
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner

RECORD = 4 * LONGEST_PERIOD

SAME = 0.01
"""Distance over half the backlash within which two periodic motions are one attractor."""

IRREGULAR = 'no period'


def basins_task(
    operation: Operation, delta: np.ndarray, delta_dot: float, transient: int
) -> Arrays:
    """Return period and mean section point of the motions from one row of initial states."""
    states = states_at(operation, delta, np.full(len(delta), delta_dot))
    run = run_cycles(
        [operation.pair] * len(delta),
        operation.speed,
        operation.load_torque,
        transient + RECORD,
        states=states,
    )
    sections = operation.scaled(run.sections[:, transient:])
    periods = [recurrence_period(each, RECURS, LONGEST_PERIOD)[0] for each in sections]
    means = [
        each[: period or None].mean(axis=0) for each, period in zip(sections, periods, strict=True)
    ]
    return {'period': np.array(periods), 'mean': np.array(means)}


def basins(
    operation: Operation,
    *,
    size: int = 80,
    reach: tuple[float, float] = (2.0, 1.0),
    transient: int = 400,
    runner: Runner | None = None,
) -> Outcome:
    """Return the attractor that each initial state (delta, delta_dot) reaches.

    The bodies begin at rest where the static load puts them, at mesh phase 0. Motions with a
    period are told apart by it and by their mean on the section; all others count as one.

    Parameters
    ----------
    operation : Operation
    size : int
        Initial states along each side of the picture.
    reach : two floats
        Greatest delta / b and delta_dot / (b wn).
    transient : int
        Mesh cycles before the attractor is told.
    runner : Runner, optional
    """
    runner = runner or Runner()
    delta = np.linspace(-reach[0], reach[0], size)
    delta_dot = np.linspace(-reach[1], reach[1], size)
    arguments = [
        {
            'operation': operation,
            'delta': delta,
            'delta_dot': float(each),
            'transient': transient,
        }
        for each in delta_dot
    ]
    results = runner.run(basins_task, arguments, 'basins')
    periods = np.array([result['period'] for result in results])
    means = np.array([result['mean'] for result in results])
    labels, names = attractors(periods.ravel(), means.reshape(-1, 2))
    arrays = {
        'delta': delta,
        'delta_dot': delta_dot,
        'label': labels.reshape(size, size),
        'names': np.array(names),
        'share': np.bincount(labels, minlength=len(names)) / labels.size,
    }
    return Outcome('basins', _text(operation, arrays), _table(arrays), arrays)


def attractors(periods: np.ndarray, means: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Return the number of each motion's attractor, the most frequent first, and their names."""
    found: list[tuple[int, np.ndarray]] = []
    numbers = np.empty(len(periods), dtype=int)
    for i, (period, mean) in enumerate(zip(periods, means, strict=True)):
        for j, (known, centre) in enumerate(found):
            if period == known and (period == 0 or np.abs(mean - centre).max() < SAME):
                numbers[i] = j
                break
        else:
            numbers[i] = len(found)
            found.append((int(period), mean))
    order = np.argsort(-np.bincount(numbers), kind='stable')
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    names = [
        f'period-{found[j][0]} about {found[j][1][0]:.3f} b' if found[j][0] else IRREGULAR
        for j in order
    ]
    return rank[numbers], names


def _text(operation: Operation, arrays: dict[str, np.ndarray]) -> str:
    lines = [
        f'w = {operation.frequency_ratio:.4f}, mu = {operation.pair.friction_coefficient:g}, '
        f'load torque {operation.load_torque:g} N m: {arrays["label"].size} initial states'
    ]
    lines += [
        f'  {share:6.1%}  {name}'
        for name, share in zip(arrays['names'], arrays['share'], strict=True)
    ]
    return '\n'.join(lines)


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    slope, delta = np.meshgrid(arrays['delta_dot'], arrays['delta'], indexing='ij')
    return {
        'delta [b]': delta.ravel(),
        'delta_dot [b wn]': slope.ravel(),
        'attractor': arrays['names'][arrays['label'].ravel()],
    }
