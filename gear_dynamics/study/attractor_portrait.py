"""One motion from all sides: history, spectrum, phase portrait, section, exponents."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.signal.spectrum import amplitude_spectrum
from gear_dynamics.study.exponents import exponent_columns
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

SAMPLED = 512
"""Mesh cycles in the history, the spectrum and the phase portrait. Fewer may all lie near one
unstable orbit of a chaotic motion."""

SHOWN = 32
"""Of these, in the picture of the history."""

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
        SAMPLED,
        states=states,
        samples_per_cycle=SAMPLES,
    )
    b, wn = operation.pair.half_backlash, operation.pair.derived.wn
    delta = sampled.samples[0]['delta'] / b
    slope = sampled.samples[0]['delta_dot'] / (b * wn)
    order, lines = amplitude_spectrum(delta - delta.mean(), SAMPLES, length=len(delta) // 2)
    low = order <= 4
    return {
        'tau': sampled.samples[0]['t'] * wn,
        'delta': delta,
        'delta_dot': slope,
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

    Returns
    -------
    Outcome
        Its table is the section; further ones are the history (`_history`), the spectrum
        (`_spectrum`), the exponents (`_exponents`) and their means over the first cycles
        (`_convergence`).

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
        _section_table(arrays),
        arrays,
        UNITS | SAMPLED_UNITS,
        {
            '_history': _sampled_table(arrays, ('tau', 'delta', 'delta_dot')),
            '_spectrum': _sampled_table(arrays, ('order', 'amplitude')),
            '_exponents': _exponents_table(arrays),
            '_convergence': convergence_of(findings),
        },
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


def _section_table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    count = arrays['sections'].shape[1]
    return {
        'friction_coefficient [1]': np.repeat(arrays['friction'], count),
        'cycle [cycles]': np.tile(np.arange(count), len(arrays['friction'])),
        'delta [b]': arrays['sections'][..., 0].ravel(),
        'delta_dot [b wn]': arrays['sections'][..., 1].ravel(),
    }


def _sampled_table(arrays: dict[str, np.ndarray], names: Sequence[str]) -> dict[str, np.ndarray]:
    """Return arrays by the names of SAMPLED_UNITS, (frictions, n), as a table."""
    count = arrays[names[0]].shape[1]
    columns = {f'{name} [{SAMPLED_UNITS[name]}]': arrays[name].ravel() for name in names}
    return {'friction_coefficient [1]': np.repeat(arrays['friction'], count), **columns}


def _exponents_table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {
        'friction_coefficient [1]': arrays['friction'],
        'kind [-]': arrays['kind'],
        'settled [1]': arrays['settled'].all(axis=-1).astype(int),
        'discarded [cycles]': arrays['discarded'],
        'nearby [1/tau]': arrays['nearby'],
        'nearby_error [1/tau]': arrays['nearby_error'],
        'sum_error [1]': arrays['sum_error'],
        **exponent_columns(arrays['exponents'], arrays['standard_errors']),
    }
