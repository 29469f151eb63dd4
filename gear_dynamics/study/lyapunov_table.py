"""Lyapunov spectra for several friction coefficients, each from several initial states."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.study.exponents import (
    AGREE,
    EXPONENT_UNITS,
    FLOOR,
    Exponents,
    convergence_table,
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
    **EXPONENT_UNITS,
    'discarded': 'cycles',
    'nearby': '1/tau',
    'nearby_error': '1/tau',
    'sections': 'b, b wn',
}

SOURCE = {0.0: 0.1263, 0.03: 0.0732, 0.05: -0.0462}
"""Largest exponents that the published study gives at SOURCE_W, by friction coefficient."""

SOURCE_W = 1.222

GIVEN = {
    'pinion_teeth': 34,
    'gear_teeth': 59,
    'module': 0.002,
    'pressure_angle_deg': 20.0,
    'tooth_pair_stiffness': 5.33e8,
    'mesh_stiffness': 'rectangular',
    'damping_in_gap': True,
    'half_backlash': 150e-6,
    'transmission_error_amplitude': 15e-6,
    'pinion_support_stiffness': 5e8,
    'gear_support_stiffness': 5e8,
}
"""What the published study gives of the pair, but for the damping ratio of the mesh, which may be
read in two ways. It leaves out masses, inertias, load, support damping, and the error's phase."""

FRICTION = 'friction_coefficient'


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
        Friction coefficients, each once.
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
        If a friction coefficient is out of its range, or given twice.
    """
    runner = runner or Runner()
    operations = with_frictions(operation, frictions)
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
        {'_convergence': convergence_of(findings)},
    )


def with_frictions(operation: Operation, frictions: Sequence[float]) -> list[Operation]:
    """Return the operation with each friction coefficient.

    Raises
    ------
    ParameterError
        If one is out of its range, or given twice.
    """
    operations = [operation.with_value(FRICTION, mu) for mu in frictions]
    values = [each.pair.friction_coefficient for each in operations]
    for mu in values:
        if values.count(mu) > 1:
            raise ParameterError(
                f'{FRICTION} {mu:g} is given {values.count(mu)} times: give it once'
            )
    return operations


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


def pooled(values: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean over motions, (motions, ...), and its standard error.

    The error is the larger of that within the records and that between them.
    """
    count = len(values)
    within = np.sqrt((errors**2).sum(axis=0)) / count
    between = values.std(axis=0, ddof=1) / math.sqrt(count) if count > 1 else 0.0
    return values.mean(axis=0), np.maximum(within, between)


def differing_words(near: float, near_error: float, value: float, error: float) -> list[str]:
    """Return a line if two nearby motions tell another largest exponent than variations."""
    apart, combined = abs(near - value), math.hypot(near_error, error)
    if apart <= AGREE * combined + FLOOR:
        return []
    return [
        f'  the two differ by {apart:.2g}, more than {AGREE:g} of their standard errors '
        f'({combined:.2g}): run more cycles'
    ]


def _text(operation: Operation, findings: Sequence[Finding]) -> str:
    lines = [
        f'Lyapunov exponents per tau = wn t at w = {operation.frequency_ratio:.4f}, '
        f'load torque {operation.load_torque:g} N m',
        '',
    ]
    published = SOURCE if is_published(operation) else {}
    for mu in dict.fromkeys(each.friction for each in findings):
        motions = [each for each in findings if each.friction == mu]
        for words in dict.fromkeys(each.kind.words for each in motions):
            group = [each for each in motions if each.kind.words == words]
            lines.append(f'mu = {mu:g}: {len(group)} of {len(motions)} {words}')
            lines += [*_paragraph(group), *unsettled_words(group), '']
        if mu in published:
            lines[-1:] = [f'  published for mu = {mu:g}: {published[mu]:+.4f}', '']
    first, second = support_exponents(operation)
    lines += [
        f'x1 and x2 feed nothing back: four exponents are exactly {first:.5f} and {second:.5f}, '
        'twice each.',
        'The sum of the ten differs from the mean divergence by at most '
        f'{max(each.sum_error for each in findings):.1e} of it.',
    ]
    return '\n'.join(lines)


def _paragraph(group: Sequence[Finding]) -> list[str]:
    """Return the exponents of motions of one kind."""
    values, errors = pooled(
        np.array([each.exponents.values for each in group]),
        np.array([each.exponents.standard_errors for each in group]),
    )
    near, near_error = pooled(
        np.array([each.nearby for each in group]), np.array([each.nearby_error for each in group])
    )
    pairs = zip(values, errors, strict=True)
    return [
        f'  largest exponent {values[0]:+.4f} +- {errors[0]:.4f}',
        f'  by two nearby motions {near:+.4f} +- {near_error:.4f}',
        *differing_words(float(near), float(near_error), values[0], errors[0]),
        '  all: ' + ', '.join(f'{value:+.4f} +- {error:.4f}' for value, error in pairs),
    ]


def is_published(operation: Operation) -> bool:
    """Return whether SOURCE is about this: what the study gives is so, whatever the friction."""
    given = operation.pair.to_mapping()
    return (
        all(given[name] == value for name, value in GIVEN.items())
        and abs(operation.frequency_ratio - SOURCE_W) < 1e-6
    )


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
        'sum_error': np.array([each.sum_error for each in findings]),
        'discarded': np.array([each.discarded for each in all_ten]),
        'nearby': np.array([each.nearby for each in findings]),
        'nearby_error': np.array([each.nearby_error for each in findings]),
    }


def convergence_of(findings: Sequence[Finding]) -> dict[str, np.ndarray]:
    """Return the table of the means of all exponents over the first cycles."""
    each = finding_arrays(findings)
    motions = {
        'friction_coefficient [1]': each['friction'],
        'motion [1]': np.arange(1, len(findings) + 1),
    }
    return convergence_table(motions, each)
