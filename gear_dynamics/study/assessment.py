"""Regime and exponents of motions from a record; open cases are followed for longer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.exponents import lyapunov_spectrum, sum_error
from gear_dynamics.dynamics.regimes import ENOUGH, UNDECIDED, regime
from gear_dynamics.study.operating_point import OperatingPoint, unzip
from gear_dynamics.study.outcome import Arrays

KEPT_POINTS = slice(4, None, 5)
"""Points of the convergence record that are kept, of exponents.RECORD."""


def assess(
    points: Sequence[OperatingPoint],
    states: np.ndarray,
    cycles: int,
    k: int | None = None,
    section_phase: float = 0.5,
) -> Arrays:
    """Return regime and exponents of n motions.

    A motion whose exponents have not converged, or whose regime is undecided, goes on from the end
    of its record for ENOUGH cycles or more, as many as the 0-1 test needs, and is assessed again
    from these alone. Motions that have not converged even then are reported as such.

    Parameters
    ----------
    points : sequence of n OperatingPoint
    states : (n, STATES) array
    cycles : int
        In the first record; 64 or more.
    k : int, optional
        Exponents; all by default.
    section_phase : float
        Mesh phase of the sections [cycles].

    Returns
    -------
    dict
        `sections` (n, cycles, 2), the last ones; `exponents`, `standard_errors` and `settled`
        (n, k); `convergence` (n, points, k) with `convergence_cycles` (n, points); `discarded`, the
        cycles after `states` that count as a transient; `kind`; `period`, 0 if none;
        `zero_one`; with all exponents `sum_error`, by which their sum differs from the mean
        divergence, over that; `states` and `vectors` at the end, (n, ...).
    """
    vectors = dynamics.first_tangent_vectors(len(points), k, pair=points[0].pair)
    assessed = _assess_once(points, states, vectors, cycles, section_phase)
    open_ones = ~assessed['settled'].all(axis=1) | (assessed['kind'] == UNDECIDED)
    again = np.flatnonzero(open_ones).tolist()
    if again:
        longer = _assess_once(
            [points[i] for i in again],
            assessed['states'][again],
            assessed['vectors'][again],
            max(cycles, ENOUGH),
            section_phase,
        )
        longer['sections'] = longer['sections'][:, -cycles:]
        longer['discarded'] += cycles
        for name, values in longer.items():
            assessed[name][again] = values
    return assessed


def _assess_once(
    points: Sequence[OperatingPoint],
    states: np.ndarray,
    vectors: np.ndarray,
    cycles: int,
    section_phase: float,
) -> Arrays:
    run = dynamics.run_cycles(
        *unzip(points), cycles, states=states, vectors=vectors, section_phase=section_phase
    )
    rows = []
    sections = [e.scaled(section) for e, section in zip(points, run.sections, strict=True)]
    for each, section, growth in zip(points, sections, run.growth, strict=True):
        found = lyapunov_spectrum(growth, each.cycle)
        kind = regime(section, exponent=found.values[0], standard_error=found.standard_errors[0])
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
    assessed = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    assessed |= {'sections': np.array(sections), 'states': run.states, 'vectors': run.vectors}
    if vectors.shape[1] == len(dynamics.free_coordinates(points[0].pair)):
        sums = run.growth.sum(axis=(1, 2))
        assessed['sum_error'] = sum_error(sums, run.divergence.sum(axis=1))
    return assessed


def regime_shares(kinds: np.ndarray) -> str:
    """Return in a line the shares of motions of each regime, the most frequent first."""
    words, counts = np.unique(kinds, return_counts=True)
    order = np.argsort(-counts, kind='stable')
    return ', '.join(f'{words[i]} {counts[i] / kinds.size:.1%}' for i in order)
