"""Lyapunov spectra for several friction coefficients, each from several initial states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics.figure_style import COLOURS
from gear_dynamics.study.declaration import CYCLES_OPTION, TRANSIENT_OPTION, Option, Study
from gear_dynamics.study.drawing import legend_below, new_figure, zero_line
from gear_dynamics.study.exponent_tables import exponent_columns
from gear_dynamics.study.findings import (
    UNITS,
    MotionResult,
    convergence_of,
    differing_words,
    finding,
    finding_arrays,
    pooled,
    support_exponents,
    unsettled_words,
)
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import OperatingPoint, friction_chaos, with_frictions
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.published import SOURCE, is_published
from gear_dynamics.study.records import records
from gear_dynamics.study.tasks import Runner

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STUDY = Study(
    'all Lyapunov exponents with standard errors, from several initial states',
    friction_chaos,
    {
        'frictions': Option('friction coefficients to compare', several=True),
        'initial_states': Option('initial states for each friction coefficient', 1),
        'transient': TRANSIENT_OPTION,
        'cycles': CYCLES_OPTION,
    },
)


def lyapunov(
    point: OperatingPoint,
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
    point : OperatingPoint
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
    points = with_frictions(point, frictions)
    states = [scattered_states(each, initial_states) for each in points]
    results = records(points, states, transient, cycles, runner, 'lyapunov')
    findings = [
        finding(each, result, i)
        for each, result in zip(points, results, strict=True)
        for i in range(initial_states)
    ]
    sections = np.concatenate([each['sections'] for each in results])
    return Outcome(
        'lyapunov',
        _text(point, findings),
        _table(findings),
        finding_arrays(findings) | {'sections': sections},
        UNITS,
        {'_convergence': convergence_of(findings)},
    )


def _text(point: OperatingPoint, findings: Sequence[MotionResult]) -> str:
    lines = [
        f'Lyapunov exponents per tau = wn t at w = {point.frequency_ratio:.4f}, '
        f'load torque {point.load_torque:g} N m',
        '',
    ]
    published = SOURCE if is_published(point) else {}
    for mu in dict.fromkeys(each.friction for each in findings):
        motions = [each for each in findings if each.friction == mu]
        for words in dict.fromkeys(each.regime.words for each in motions):
            group = [each for each in motions if each.regime.words == words]
            lines.append(f'mu = {mu:g}: {len(group)} of {len(motions)} {words}')
            lines += [*_paragraph(group), *unsettled_words(group), '']
        if mu in published:
            lines[-1:] = [f'  published for mu = {mu:g}: {published[mu]:+.4f}', '']
    first, second = support_exponents(point)
    lines += [
        f'x1 and x2 feed nothing back: four exponents are exactly {first:.5f} and {second:.5f}, '
        'twice each.',
        'The sum of the ten differs from the mean divergence by at most '
        f'{max(each.sum_error for each in findings):.1e} of it.',
    ]
    return '\n'.join(lines)


def _paragraph(group: Sequence[MotionResult]) -> list[str]:
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


def _table(findings: Sequence[MotionResult]) -> dict[str, np.ndarray]:
    columns: dict[str, list] = {
        'friction_coefficient [1]': [each.friction for each in findings],
        'kind [-]': [each.regime.words for each in findings],
        'settled [1]': [int(each.exponents.settled.all()) for each in findings],
        'discarded [cycles]': [each.exponents.discarded for each in findings],
        'zero_one_test [1]': [each.regime.zero_one for each in findings],
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


OTHERS = '#9aa7b2'


def draw(arrays: Arrays) -> Figure:
    """Draw the convergence of all exponents and the section, a column for each friction."""
    from matplotlib.lines import Line2D

    frictions = np.unique(arrays['friction'])
    figure = new_figure(4 * len(frictions), 7, 'Lyapunov exponents per τ = ωn t')
    grid = figure.subplots(2, len(frictions), squeeze=False, sharex='row', sharey='row')
    for column, mu in zip(grid.T, frictions, strict=True):
        which = np.flatnonzero(arrays['friction'] == mu)
        _convergence(column[0], arrays, which, mu)
        column[1].set_title('section, second half of the records')
        half = arrays['sections'].shape[1] // 2
        for i in which:
            periodic = str(arrays['kind'][i]).startswith('period-')
            points = arrays['sections'][i, half:].T
            column[1].plot(*points, '.' if periodic else ',', color=COLOURS[0])
        column[1].set(xlabel='δ / b')
    grid[0, 0].set_ylabel('mean over the first cycles [1/τ]')
    grid[1, 0].set_ylabel("δ' / (b ωn)")
    largest = Line2D([], [], color=COLOURS[1], label='largest exponent')
    others = Line2D([], [], color=OTHERS, label='the others')
    legend_below(grid[0, len(frictions) // 2], [largest, others])
    return figure


def _convergence(axes: Axes, arrays: Arrays, which: np.ndarray, mu: float) -> None:
    for i in which:
        cycles = arrays['convergence_cycles'][i]
        rest = arrays['convergence'][i, :, 1:]
        axes.plot(cycles, rest, color=OTHERS, linewidth=0.5)
        axes.plot(cycles, arrays['convergence'][i, :, 0], color=COLOURS[1], lw=1)
    zero_line(axes)
    words = list(arrays['kind'][which])
    kinds = ', '.join(f'{words.count(word)} × {word}' for word in dict.fromkeys(words))
    axes.set(xlabel='mesh cycles', title=f'μ = {mu:g}: {kinds}')
