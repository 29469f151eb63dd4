"""Lyapunov spectra for several friction coefficients, each from several initial states."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.model.nearby import nearby_growth
from gear_dynamics.study.exponents import Exponents, exponents, standard_error
from gear_dynamics.study.initial import first_variations, scattered_states
from gear_dynamics.study.kind import Kind, kind_of
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner

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
        return abs(float(self.exponents.values.sum()) / self.divergence - 1)


def spectrum_task(
    operation: Operation, states: np.ndarray, transient: int, cycles: int, nearby: int
) -> Arrays:
    """Return sections, growth and divergence of the motions from each row of `states`."""
    pairs = [operation.pair] * len(states)
    speed, torque = operation.speed, operation.load_torque
    vectors = first_variations(len(states))
    before = run_cycles(pairs, speed, torque, transient, states=states, vectors=vectors)
    after = run_cycles(pairs, speed, torque, cycles, states=before.states, vectors=before.vectors)
    return {
        'sections': operation.scaled(after.sections),
        'growth': after.growth,
        'divergence': after.divergence,
        'nearby': nearby_growth(pairs, speed, torque, nearby, after.states),
    }


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
    arguments = [
        {
            'operation': each,
            'states': scattered_states(each, initial_states),
            'transient': transient,
            'cycles': cycles,
            'nearby': max(cycles // 5, 200),
        }
        for each in operations
    ]
    results = runner.run(spectrum_task, arguments, 'lyapunov')
    findings = [
        finding(each, result, i)
        for each, result in zip(operations, results, strict=True)
        for i in range(initial_states)
    ]
    return Outcome(
        'lyapunov', _text(operation, findings), _table(findings), _arrays(findings, results)
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
    unsettled = sum(not each.exponents.settled for each in group)
    lines = [
        f'mu = {mu:g}: {kinds}',
        f'  largest exponent {value:+.4f} +- {error:.4f}'
        + (f' (source: {SOURCE[mu]:+.4f})' if mu in SOURCE else ''),
        f'  by two nearby motions {near:+.4f} +- {near_error:.4f}',
        '  all: ' + ' '.join(f'{each:+.4f}' for each in spectrum),
    ]
    if unsettled:
        lines.append(f'  {unsettled} of {len(group)} records are not settled: run more cycles')
    return [*lines, '']


def _table(findings: Sequence[Finding]) -> dict[str, np.ndarray]:
    columns: dict[str, list] = {
        'friction_coefficient [1]': [each.friction for each in findings],
        'kind': [each.kind.words for each in findings],
        'settled': [int(each.exponents.settled) for each in findings],
        'discarded [cycles]': [each.exponents.discarded for each in findings],
        'zero_one_test [1]': [each.kind.zero_one for each in findings],
        'nearby [1/tau]': [each.nearby for each in findings],
        'nearby_error [1/tau]': [each.nearby_error for each in findings],
        'mean_divergence [1/tau]': [each.divergence for each in findings],
    }
    for i in range(len(findings[0].exponents.values)):
        name = f'exponent_{i + 1}'
        columns[f'{name} [1/tau]'] = [each.exponents.values[i] for each in findings]
        columns[f'{name}_error [1/tau]'] = [each.exponents.standard_errors[i] for each in findings]
    return {name: np.array(column) for name, column in columns.items()}


def _arrays(findings: Sequence[Finding], results: Sequence[Arrays]) -> dict[str, np.ndarray]:
    longest = max(len(each.exponents.convergence) for each in findings)
    k = findings[0].exponents.values.size
    convergence = np.full((len(findings), longest, k), np.nan)
    cycles = np.full((len(findings), longest), np.nan)
    for i, each in enumerate(findings):
        count = len(each.exponents.convergence)
        convergence[i, :count] = each.exponents.convergence
        cycles[i, :count] = each.exponents.convergence_cycles
    return {
        'friction': np.array([each.friction for each in findings]),
        'exponents': np.array([each.exponents.values for each in findings]),
        'standard_errors': np.array([each.exponents.standard_errors for each in findings]),
        'convergence': convergence,
        'convergence_cycles': cycles,
        'sections': np.concatenate([each['sections'] for each in results]),
    }
