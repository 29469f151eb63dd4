"""One motion from all sides: history, spectrum, phase portrait, section, exponents."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics.analysis.spectrum import amplitude_spectrum
from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.study.initial import first_variations, scattered_states
from gear_dynamics.study.lyapunov_table import Finding, finding
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner

SHOWN = 32
"""Mesh cycles in the history and the phase portrait."""

SPECTRUM_CYCLES = 512

SAMPLES = 64
"""Samples in a mesh cycle."""


def attractor_task(operation: Operation, transient: int, cycles: int) -> Arrays:
    """Return history, spectrum, section and growth of one motion."""
    run = ([operation.pair], operation.speed, operation.load_torque)
    states, vectors = scattered_states(operation, 1), first_variations(1)
    before = run_cycles(*run, transient, states=states, vectors=vectors)
    after = run_cycles(*run, cycles, states=before.states, vectors=before.vectors)
    sampled = run_cycles(*run, SPECTRUM_CYCLES, states=after.states, samples_per_cycle=SAMPLES)
    b, wn = operation.pair.half_backlash, operation.pair.derived.wn
    delta = sampled.samples[0]['delta'] / b
    slope = sampled.samples[0]['delta_dot'] / (b * wn)
    order, lines = amplitude_spectrum(delta - delta.mean(), SAMPLES, length=len(delta) // 2)
    shown, low = slice(SHOWN * SAMPLES), order <= 4
    return {
        'tau': sampled.samples[0]['t'][shown] * wn,
        'delta': delta[shown],
        'delta_dot': slope[shown],
        'order': order[low],
        'amplitude': lines[low],
        'sections': operation.scaled(after.sections),
        'growth': after.growth,
        'divergence': after.divergence,
        'nearby': after.growth[:, :, 0],
    }


def attractor(
    operation: Operation,
    frictions: Sequence[float] = (0.0, 0.03, 0.05),
    *,
    transient: int = 1000,
    cycles: int = 4000,
    runner: Runner | None = None,
) -> Outcome:
    """Return the motion from the static state for each friction coefficient.

    Parameters
    ----------
    operation : Operation
    frictions : sequence of float
    transient, cycles : int
        Mesh cycles before and in the record of the section and the exponents.
    runner : Runner, optional

    Raises
    ------
    ParameterError
        If a value is out of its range.
    """
    runner = runner or Runner()
    operations = [operation.with_value('friction_coefficient', mu) for mu in frictions]
    arguments = [
        {'operation': each, 'transient': transient, 'cycles': cycles} for each in operations
    ]
    results = runner.run(attractor_task, arguments, 'attractor')
    findings = [finding(each, result, 0) for each, result in zip(operations, results, strict=True)]
    names = ('tau', 'delta', 'delta_dot', 'order', 'amplitude', 'sections')
    arrays = {name: np.array([result[name] for result in results]) for name in names}
    arrays['sections'] = arrays['sections'][:, 0]
    arrays |= {
        'friction': np.array(frictions),
        'kind': np.array([each.kind.words for each in findings]),
        'exponents': np.array([each.exponents.values for each in findings]),
        'standard_errors': np.array([each.exponents.standard_errors for each in findings]),
    }
    return Outcome('attractor', _text(operation, findings), _table(arrays), arrays)


def _text(operation: Operation, findings: Sequence[Finding]) -> str:
    lines = [f'w = {operation.frequency_ratio:.4f}, load torque {operation.load_torque:g} N m']
    for each in findings:
        value, error = each.exponents.values[0], each.exponents.standard_errors[0]
        lines.append(
            f'mu = {each.friction:g}: {each.kind.words}, largest exponent {value:+.4f} '
            f'+- {error:.4f} per tau'
        )
    worst = max(each.sum_error for each in findings)
    lines.append(f'The sum of the exponents differs from the mean divergence by {worst:.1e} of it')
    return '\n'.join(lines)


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    count = arrays['sections'].shape[1]
    return {
        'friction_coefficient [1]': np.repeat(arrays['friction'], count),
        'cycle': np.tile(np.arange(count), len(arrays['friction'])),
        'delta [b]': arrays['sections'][..., 0].ravel(),
        'delta_dot [b wn]': arrays['sections'][..., 1].ravel(),
    }
