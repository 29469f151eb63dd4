"""Basins of attraction: which motion each initial state ends in."""

from __future__ import annotations

import numpy as np

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.study.exponents import (
    EXPONENT_UNITS,
    convergence_table,
    exponent_columns,
    verdict,
)
from gear_dynamics.study.initial import states_at
from gear_dynamics.study.judgement import judge
from gear_dynamics.study.kind import LONGEST_PERIOD, SAME
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner

RECORD = 4 * LONGEST_PERIOD

UNITS = {
    'delta': 'b',
    'delta_dot': 'b wn',
    'label': '1',
    'names': '-',
    'share': '1',
    **EXPONENT_UNITS,
}


def basins_task(
    operation: Operation, delta: np.ndarray, delta_dot: float, transient: int
) -> Arrays:
    """Return kind, mean section point and all exponents of the motions from a row of states."""
    states = states_at(operation, delta, np.full(len(delta), delta_dot))
    pairs = [operation.pair] * len(delta)
    run = run_cycles(pairs, operation.speed, operation.load_torque, transient, states=states)
    judged = judge([operation] * len(delta), run.states, RECORD)
    means = [
        each[: period or None].mean(axis=0)
        for each, period in zip(judged['sections'], judged['period'], strict=True)
    ]
    return {
        'kind': judged['kind'],
        'mean': np.array(means),
        **{name: judged[name] for name in EXPONENT_UNITS},
    }


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
    period are told apart by it and by their mean on the section; all chaotic ones count as one
    attractor, all quasi-periodic ones as another, and what stays undecided (`judgement.judge`) as
    a third.

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
    joined = {name: np.concatenate([each[name] for each in results]) for name in results[0]}
    labels, names = attractors(joined['kind'], joined['mean'])
    arrays = {
        'delta': delta,
        'delta_dot': delta_dot,
        'label': labels.reshape(size, size),
        'names': np.array(names),
        'share': np.bincount(labels, minlength=len(names)) / labels.size,
    }
    for name in EXPONENT_UNITS:
        arrays[name] = joined[name].reshape(size, size, *joined[name].shape[1:])
    states = _states(arrays)
    further = {'_convergence': convergence_table(states, arrays)}
    table = _table(states, arrays)
    return Outcome('basins', _text(operation, arrays), table, arrays, UNITS, further)


def attractors(kinds: np.ndarray, means: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Return the number of each motion's attractor, the most frequent first, and their names."""
    found: list[tuple[str, np.ndarray]] = []
    numbers = np.empty(len(kinds), dtype=int)
    for i, (kind, mean) in enumerate(zip(kinds, means, strict=True)):
        periodic = kind.startswith('period-')
        for j, (known, centre) in enumerate(found):
            if kind == known and (not periodic or np.abs(mean - centre).max() < SAME):
                numbers[i] = j
                break
        else:
            numbers[i] = len(found)
            found.append((str(kind), mean))
    order = np.argsort(-np.bincount(numbers), kind='stable')
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    names = [
        f'{kind} about {mean[0]:.3f} b' if kind.startswith('period-') else kind
        for kind, mean in (found[j] for j in order)
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
    lines.append(verdict(arrays['settled'], arrays['sum_error']))
    return '\n'.join(lines)


def _states(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    slope, delta = np.meshgrid(arrays['delta_dot'], arrays['delta'], indexing='ij')
    return {'delta [b]': delta.ravel(), 'delta_dot [b wn]': slope.ravel()}


def _table(states: dict[str, np.ndarray], arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    found = {
        'attractor [-]': arrays['names'][arrays['label']],
        'settled [1]': arrays['settled'].all(axis=-1).astype(int),
        'sum_error [1]': arrays['sum_error'],
        **exponent_columns(arrays['exponents'], arrays['standard_errors']),
    }
    return states | {name: each.ravel() for name, each in found.items()}
