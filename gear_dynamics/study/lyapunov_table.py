"""Lyapunov spectra for several friction coefficients, each from several initial states."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.study.exponents import (
    Exponents,
    exponent_columns,
    exponents,
    standard_error,
    sum_error,
)
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.kind import Kind, kind_of
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.records import records
from gear_dynamics.study.tasks import Arrays, Runner

UNITS = {
    'friction': '1',
    'kind': '-',
    'exponents': '1/tau',
    'standard_errors': '1/tau',
    'settled': '1',
    'convergence': '1/tau',
    'convergence_cycles': 'cycles',
    'discarded': 'cycles',
    'nearby': '1/tau',
    'nearby_error': '1/tau',
    'sections': 'b, b wn',
}

SOURCE = {0.0: 0.1263, 0.03: 0.0732, 0.05: -0.0462}
"""Largest exponents that the published study gives at w = 1.222, by friction coefficient."""


class Finding(NamedTuple):
    """What one motion did.

    Attributes
    ----------
    friction : float
    exponents : Exponents
    kind : Kind
    nearby, nearby_error : float
        Largest exponent and its standard error by two nearby motions.
    divergence : float
        Mean of the trace of the Jacobian along the orbit, per tau.
    """

    friction: float
    exponents: Exponents
    kind: Kind
    nearby: float
    nearby_error: float
    divergence: float

    @property
    def sum_error(self) -> float:
        """Relative difference of the sum of all exponents from the mean divergence."""
        total = self.exponents.values.sum()
        return abs(float(sum_error(total, np.asarray(self.divergence))))


def lyapunov(
    operation: Operation,
    frictions: Sequence[float] = (0.0, 0.03, 0.05),
    *,
    initial_states: int = 6,
    transient: int = 500,
    cycles: int = 10000,
    runner: Runner | None = None,
) -> Outcome:
    """Return all ten exponents of the reduced form per tau = wn t, with standard errors.

    Parameters
    ----------
    operation : Operation
    frictions : sequence of float
        Friction coefficients.
    initial_states : int
        From how many states each is run: the static one and others drawn about the gap.
    transient, cycles : int
        Mesh cycles before and in the record; more of the beginning of the record is dropped if
        its halves do not agree.
    runner : Runner, optional
        Where the work is done.

    Raises
    ------
    ParameterError
        If a friction coefficient is out of its range.
    """
    runner = runner or Runner()
    operations = [operation.with_value('friction_coefficient', mu) for mu in frictions]
    states = [scattered_states(each, initial_states) for each in operations]
    results = records(operations, states, transient, cycles, runner, 'lyapunov')
    findings = [
        finding(each, result, i)
        for each, result in zip(operations, results, strict=True)
        for i in range(initial_states)
    ]
    sections = np.concatenate([each['sections'] for each in results])
    return Outcome(
        'lyapunov',
        _text(operation, findings),
        _table(findings),
        finding_arrays(findings) | {'sections': sections},
        UNITS,
        {'_convergence': convergence_table(findings)},
    )


def finding(operation: Operation, result: Arrays, i: int) -> Finding:
    """Return what motion i of a task's result did."""
    cycle = operation.cycle
    all_ten = exponents(result['growth'][i], cycle)
    kept = slice(all_ten.discarded, None)
    near = result['nearby'][i] / cycle
    near = near[len(near) // 10 :]
    return Finding(
        operation.pair.friction_coefficient,
        all_ten,
        kind_of(result['sections'][i, kept], all_ten.values[0], all_ten.standard_errors[0]),
        float(near.mean()),
        float(standard_error(near)),
        float(result['divergence'][i, kept].mean() / cycle),
    )


def support_exponents(operation: Operation) -> tuple[float, float]:
    """Return the exponents of x1 and of x2, twice each, in closed form.

    x1 and x2 are driven by the friction force and feed nothing back: free, they decay at
    zeta_s sqrt(k_s / m).
    """
    pair, d = operation.pair, operation.pair.derived
    first = pair.support_damping_ratio * math.sqrt(pair.pinion_support_stiffness / d.pinion_mass)
    second = pair.support_damping_ratio * math.sqrt(pair.gear_support_stiffness / d.gear_mass)
    return -first / d.wn, -second / d.wn


def _groups(findings: Sequence[Finding]) -> dict[float, list[Finding]]:
    groups: dict[float, list[Finding]] = {}
    for each in findings:
        groups.setdefault(each.friction, []).append(each)
    return groups


def pooled(group: Sequence[Finding]) -> tuple[float, float]:
    """Return mean and standard error of the largest exponent over initial states.

    The error is the larger of that within the records and that between them.
    """
    values = np.array([each.exponents.values[0] for each in group])
    errors = np.array([each.exponents.standard_errors[0] for each in group])
    within = math.sqrt(float((errors**2).sum())) / len(group)
    between = values.std(ddof=1) / math.sqrt(len(group)) if len(group) > 1 else 0.0
    return float(values.mean()), max(within, float(between))


def _text(operation: Operation, findings: Sequence[Finding]) -> str:
    lines = [
        f'Lyapunov exponents per tau = wn t at w = {operation.frequency_ratio:.4f}, '
        f'load torque {operation.load_torque:g} N m',
        '',
    ]
    for mu, group in _groups(findings).items():
        lines += _paragraph(mu, group)
    first, second = support_exponents(operation)
    lines += [
        f'x1 and x2 feed nothing back: four exponents are exactly {first:.5f} and {second:.5f}, '
        'twice each.',
        'The sum of the ten differs from the mean divergence by at most '
        f'{max(each.sum_error for each in findings):.1e} of it.',
    ]
    return '\n'.join(lines)


def _paragraph(mu: float, group: Sequence[Finding]) -> list[str]:
    words = [each.kind.words for each in group]
    kinds = ', '.join(f'{words.count(word)} x {word}' for word in dict.fromkeys(words))
    value, error = pooled(group)
    near = np.mean([each.nearby for each in group])
    near_error = math.hypot(*[each.nearby_error for each in group]) / len(group)
    spectrum = np.mean([each.exponents.values for each in group], axis=0)
    lines = [
        f'mu = {mu:g}: {kinds}',
        f'  largest exponent {value:+.4f} +- {error:.4f}'
        + (f' (source: {SOURCE[mu]:+.4f})' if mu in SOURCE else ''),
        f'  by two nearby motions {near:+.4f} +- {near_error:.4f}',
        '  all: ' + ' '.join(f'{each:+.4f}' for each in spectrum),
    ]
    return [*lines, *unsettled_words(group), '']


def unsettled_words(group: Sequence[Finding]) -> list[str]:
    """Return a line about the records that are not settled, if there are any."""
    which = [np.flatnonzero(~each.exponents.settled) + 1 for each in group]
    count = sum(each.size > 0 for each in which)
    if not count:
        return []
    numbers = ', '.join(str(number) for number in np.unique(np.concatenate(which)))
    return [
        f'  not settled: {count} of {len(group)} records, in exponents {numbers}: run more cycles'
    ]


def _table(findings: Sequence[Finding]) -> dict[str, np.ndarray]:
    columns: dict[str, list] = {
        'friction_coefficient [1]': [each.friction for each in findings],
        'kind [-]': [each.kind.words for each in findings],
        'settled [1]': [int(each.exponents.settled.all()) for each in findings],
        'discarded [cycles]': [each.exponents.discarded for each in findings],
        'zero_one_test [1]': [each.kind.zero_one for each in findings],
        'nearby [1/tau]': [each.nearby for each in findings],
        'nearby_error [1/tau]': [each.nearby_error for each in findings],
        'mean_divergence [1/tau]': [each.divergence for each in findings],
        'sum_error [1]': [each.sum_error for each in findings],
    }
    values = np.array([each.exponents.values for each in findings])
    errors = np.array([each.exponents.standard_errors for each in findings])
    return {name: np.array(column) for name, column in columns.items()} | exponent_columns(
        values, errors
    )


def finding_arrays(findings: Sequence[Finding]) -> dict[str, np.ndarray]:
    """Return exponents and their convergence, by the names of UNITS, a row for each motion."""
    all_ten = [each.exponents for each in findings]
    return {
        'friction': np.array([each.friction for each in findings]),
        'kind': np.array([each.kind.words for each in findings]),
        'exponents': np.array([each.values for each in all_ten]),
        'standard_errors': np.array([each.standard_errors for each in all_ten]),
        'settled': np.array([each.settled for each in all_ten]),
        'convergence': np.array([each.convergence for each in all_ten]),
        'convergence_cycles': np.array([each.convergence_cycles for each in all_ten]),
        'discarded': np.array([each.discarded for each in all_ten]),
        'nearby': np.array([each.nearby for each in findings]),
        'nearby_error': np.array([each.nearby_error for each in findings]),
    }


def convergence_table(findings: Sequence[Finding]) -> dict[str, np.ndarray]:
    """Return the means of all exponents over the first cycles, as a table."""
    each = finding_arrays(findings)
    motions, points, k = each['convergence'].shape
    running = each['convergence'].reshape(-1, k)
    return {
        'friction_coefficient [1]': np.repeat(each['friction'], points),
        'motion [1]': np.repeat(np.arange(1, motions + 1), points),
        'cycles [cycles]': each['convergence_cycles'].ravel(),
        **{f'exponent_{i + 1} [1/tau]': running[:, i] for i in range(k)},
    }
