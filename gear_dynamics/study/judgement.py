"""What motions do, judged from a record; those that it leaves open are followed for longer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.dynamics.regime import ENOUGH
from gear_dynamics.integrator.variation import VARIED
from gear_dynamics.study.exponents import exponents, sum_error
from gear_dynamics.study.initial import first_variations
from gear_dynamics.study.kind import UNDECIDED, kind_of
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.tasks import Arrays

KEPT_POINTS = slice(4, None, 5)
"""Points of the convergence record that are kept, of exponents.RECORD."""


def unzip(operations: Sequence[Operation]) -> tuple[list, np.ndarray, np.ndarray]:
    """Return pairs, speeds and load torques as `run_cycles` takes them."""
    return (
        [each.pair for each in operations],
        np.array([each.speed for each in operations]),
        np.array([each.load_torque for each in operations]),
    )


def judge(
    operations: Sequence[Operation],
    states: np.ndarray,
    cycles: int,
    k: int = VARIED,
    section_phase: float = 0.5,
) -> Arrays:
    """Return kind and exponents of n motions.

    A motion whose exponents are not settled, or whose kind is undecided, goes on from the end of
    its record for ENOUGH cycles or more, and is judged again from these alone: enough for the 0-1
    test. What is not settled then is said to be so.

    Parameters
    ----------
    operations : sequence of n Operation
    states : (n, STATES) array
    cycles : int
        In the first record; 64 or more.
    k : int
        Exponents.
    section_phase : float
        Mesh phase of the sections [cycles].

    Returns
    -------
    dict
        `sections` (n, cycles, 2), the last ones; `exponents`, `standard_errors` and `settled`
        (n, k); `convergence` (n, points, k) with `convergence_cycles` (n, points); `discarded`, the
        cycles after `states` that were judged a transient; `kind`; `period`, 0 if none;
        `zero_one`; with all exponents `sum_error`, by which their sum differs from the mean
        divergence, over that; `states` and `vectors` at the end, (n, ...).
    """
    vectors = first_variations(len(operations), k)
    judged = _judge_once(operations, states, vectors, cycles, section_phase)
    open_ones = ~judged['settled'].all(axis=1) | (judged['kind'] == UNDECIDED)
    again = np.flatnonzero(open_ones).tolist()
    if again:
        longer = _judge_once(
            [operations[i] for i in again],
            judged['states'][again],
            judged['vectors'][again],
            max(cycles, ENOUGH),
            section_phase,
        )
        longer['sections'] = longer['sections'][:, -cycles:]
        longer['discarded'] += cycles
        for name, values in longer.items():
            judged[name][again] = values
    return judged


def _judge_once(
    operations: Sequence[Operation],
    states: np.ndarray,
    vectors: np.ndarray,
    cycles: int,
    section_phase: float,
) -> Arrays:
    run = run_cycles(
        *unzip(operations), cycles, states=states, vectors=vectors, section_phase=section_phase
    )
    rows = []
    sections = [e.scaled(section) for e, section in zip(operations, run.sections, strict=True)]
    for each, section, growth in zip(operations, sections, run.growth, strict=True):
        found = exponents(growth, each.cycle)
        kind = kind_of(section, found.values[0], found.standard_errors[0])
        rows.append(
            {
                'exponents': found.values,
                'standard_errors': found.standard_errors,
                'settled': found.settled,
                'convergence': found.convergence[KEPT_POINTS],
                'convergence_cycles': found.convergence_cycles[KEPT_POINTS],
                'discarded': found.discarded,
                'kind': np.array(kind.words, dtype='U16'),
                'period': kind.period,
                'zero_one': kind.zero_one,
            }
        )
    judged = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    judged |= {'sections': np.array(sections), 'states': run.states, 'vectors': run.vectors}
    if vectors.shape[1] == VARIED:
        sums = run.growth.sum(axis=(1, 2))
        judged['sum_error'] = sum_error(sums, run.divergence.sum(axis=1))
    return judged
