"""One motion from all sides: history, spectrum, phase portrait, section, exponents."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics.analysis.spectrum import amplitude_spectrum
from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.lyapunov_table import (
    UNITS,
    Finding,
    convergence_of,
    differing_words,
    finding,
    finding_arrays,
    unsettled_words,
    with_frictions,
)
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.records import records
from gear_dynamics.study.tasks import Arrays, Runner

SHOWN = 32
"""Mesh cycles in the history and the phase portrait."""

SPECTRUM_CYCLES = 512

SAMPLES = 64
"""Samples in a mesh cycle."""


SAMPLED_UNITS = {
    'tau': '1',
    'delta': 'b',
    'delta_dot': 'b wn',
    'order': '1',
    'amplitude': 'b',
}


def portrait_task(operation: Operation, states: np.ndarray) -> Arrays:
    """Return history and spectrum of one motion."""
    sampled = run_cycles(
        [operation.pair],
        operation.speed,
        operation.load_torque,
        SPECTRUM_CYCLES,
        states=states,
        samples_per_cycle=SAMPLES,
    )
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
        If a value is out of its range, or given twice.
    """
    runner = runner or Runner()
    operations = with_frictions(operation, frictions)
    begins = [scattered_states(each, 1) for each in operations]
    results = records(operations, begins, transient, cycles, runner, 'attractor')
    arguments = [
        {'operation': each, 'states': result['states']}
        for each, result in zip(operations, results, strict=True)
    ]
    portraits = runner.run(portrait_task, arguments, 'portraits')
    findings = [finding(each, result, 0) for each, result in zip(operations, results, strict=True)]
    arrays = {name: np.array([each[name] for each in portraits]) for name in SAMPLED_UNITS}
    arrays['sections'] = np.array([result['sections'][0] for result in results])
    arrays |= finding_arrays(findings)
    return Outcome(
        'attractor',
        _text(operation, findings),
        _table(arrays),
        arrays,
        UNITS | SAMPLED_UNITS,
        {'_convergence': convergence_of(findings)},
    )


def _text(operation: Operation, findings: Sequence[Finding]) -> str:
    lines = [f'w = {operation.frequency_ratio:.4f}, load torque {operation.load_torque:g} N m']
    for each in findings:
        lines.append(
            f'mu = {each.friction:g}: {each.kind.words}, by two nearby motions {each.nearby:+.4f} '
            f'+- {each.nearby_error:.4f} per tau, by variations'
        )
        values, errors = each.exponents.values, each.exponents.standard_errors
        pairs = zip(values, errors, strict=True)
        lines.append('  ' + ', '.join(f'{value:+.4f} +- {error:.4f}' for value, error in pairs))
        lines += differing_words(each.nearby, each.nearby_error, values[0], errors[0])
        lines += unsettled_words([each])
    worst = max(each.sum_error for each in findings)
    lines.append(f'The sum of the exponents differs from the mean divergence by {worst:.1e} of it')
    return '\n'.join(lines)


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    count = arrays['sections'].shape[1]
    return {
        'friction_coefficient [1]': np.repeat(arrays['friction'], count),
        'cycle [cycles]': np.tile(np.arange(count), len(arrays['friction'])),
        'delta [b]': arrays['sections'][..., 0].ravel(),
        'delta_dot [b wn]': arrays['sections'][..., 1].ravel(),
    }
