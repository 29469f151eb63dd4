"""Frequency response: RMS and peaks against speed, swept up and down, with the jumps."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.analysis.regime import recurrence_period
from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.study.kind import RECURS
from gear_dynamics.study.operation import FREQUENCY_RATIO, Operation
from gear_dynamics.study.orbit_diagram import DOWN, UP, follow, unzip
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner, chunks

RECORD, SAMPLES = 32, 128
"""Mesh cycles in a record, and samples in one."""

AT_ONCE = 60

JUMP = 0.1
"""Change of the RMS over b from one value to the next that counts as a jump, if one of the two
motions has a period: between irregular ones the RMS of so short a record differs anyway."""

LONGEST_PERIOD = 8


def response_task(operations: list[Operation], states: np.ndarray) -> Arrays:
    """Return RMS, least and greatest delta / b, RMS of the mesh force [N], and the period."""
    pairs, speeds, torques = unzip(operations)
    run = run_cycles(pairs, speeds, torques, RECORD, states=states, samples_per_cycle=SAMPLES)
    b = np.array([each.pair.half_backlash for each in operations])
    delta = run.samples['delta'] / b[:, np.newaxis]
    sections = [
        each.scaled(section) for each, section in zip(operations, run.sections, strict=True)
    ]
    return {
        'period': np.array([recurrence_period(s, RECURS, LONGEST_PERIOD)[0] for s in sections]),
        'rms': delta.std(axis=1),
        'least': delta.min(axis=1),
        'greatest': delta.max(axis=1),
        'force_rms': run.samples['mesh_force'].std(axis=1),
    }


def response(
    operation: Operation,
    *,
    begin: float = 0.05,
    end: float = 1.5,
    count: int = 300,
    transient: int = 300,
    runner: Runner | None = None,
) -> Outcome:
    """Return the response to the mesh along w, each value continued from the last.

    Parameters
    ----------
    operation : Operation
    begin, end : float
        Range of the ratio of the mesh frequency to wn; both ends belong to it.
    count : int
        Values.
    transient : int
        Mesh cycles before the record at each value.
    runner : Runner, optional

    Raises
    ------
    ParameterError
        If a value is out of its range.
    """
    runner = runner or Runner()
    values = np.linspace(begin, end, count)
    chain = [operation.with_value(FREQUENCY_RATIO, float(value)) for value in values]
    chains = [chain, chain[::-1]]
    states = follow(chains, transient, runner)
    arguments = [
        {'operations': each[part], 'states': start[part]}
        for each, start in zip(chains, states, strict=True)
        for part in chunks(count, AT_ONCE)
    ]
    results = runner.run(response_task, arguments, 'response')
    arrays = {}
    for name in results[0]:
        both = np.concatenate([result[name] for result in results]).reshape(2, count)
        arrays[name] = np.stack([both[UP], both[DOWN, ::-1]])
    arrays |= {'w': values, 'speed': np.array([each.speed for each in chain])}
    return Outcome('response', _text(operation, arrays), _table(arrays), arrays)


def jumps(
    values: np.ndarray, rms: np.ndarray, period: np.ndarray
) -> list[tuple[float, float, float]]:
    """Return where the RMS jumps along increasing values: the value and RMS before and after."""
    regular = period > 0
    steps = (np.abs(np.diff(rms)) > JUMP) & (regular[1:] | regular[:-1])
    return [
        (float((values[i] + values[i + 1]) / 2), float(rms[i]), float(rms[i + 1]))
        for i in np.flatnonzero(steps)
    ]


def _text(operation: Operation, arrays: dict[str, np.ndarray]) -> str:
    mu = operation.pair.friction_coefficient
    lines = [f'mu = {mu:g}, load torque {operation.load_torque:g} N m, RMS of delta over b']
    for direction, rms, period in zip(('up', 'down'), arrays['rms'], arrays['period'], strict=True):
        top = int(rms.argmax())
        lines.append(
            f'swept {direction}: greatest RMS {rms[top]:.4f} at w = {arrays["w"][top]:.3f} '
            f'({arrays["speed"][top] * 30 / math.pi:.0f} rpm)'
        )
        found = [f'{w:.3f} ({a:.3f} to {b:.3f})' for w, a, b in jumps(arrays['w'], rms, period)]
        lines.append(f'  jumps at w = {", ".join(found)}' if found else '  no jump')
        irregular = arrays['w'][period == 0]
        if irregular.size:
            lines.append(
                f'  no period up to {LONGEST_PERIOD} at {irregular.size} of {period.size} values, '
                f'first at w = {irregular[0]:.3f}'
            )
    lost = arrays['least'] < 1
    if lost.any():
        first = arrays['w'][lost.any(axis=0).argmax()]
        lines.append(f'contact is first lost at w = {first:.3f}')
    return '\n'.join(lines)


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    count = len(arrays['w'])
    return {
        'swept': np.repeat(['up', 'down'], count),
        'w [1]': np.tile(arrays['w'], 2),
        'speed [rad/s]': np.tile(arrays['speed'], 2),
        'rms_delta [b]': arrays['rms'].ravel(),
        'least_delta [b]': arrays['least'].ravel(),
        'greatest_delta [b]': arrays['greatest'].ravel(),
        'rms_mesh_force [N]': arrays['force_rms'].ravel(),
        'period [cycles]': arrays['period'].ravel(),
    }
