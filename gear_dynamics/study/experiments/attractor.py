"""One motion from all sides: history, spectrum, phase portrait, section, exponents."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics import dynamics, signal
from gear_dynamics.figure_style import COLOURS
from gear_dynamics.study.declaration import CYCLES_OPTION, TRANSIENT_OPTION, Option, Study
from gear_dynamics.study.drawing import new_figure
from gear_dynamics.study.exponent_tables import exponent_columns
from gear_dynamics.study.findings import (
    UNITS,
    MotionResult,
    convergence_of,
    differing_words,
    finding,
    finding_arrays,
    unsettled_words,
)
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import OperatingPoint, friction_chaos, with_frictions
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.records import records
from gear_dynamics.study.tasks import Runner

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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

STUDY = Study(
    'history, spectrum, phase portrait, section and exponents of one motion',
    friction_chaos,
    {
        'frictions': Option('friction coefficients to compare', several=True),
        'transient': TRANSIENT_OPTION,
        'cycles': CYCLES_OPTION,
    },
)


def portrait_task(point: OperatingPoint, states: np.ndarray) -> Arrays:
    """Return history and spectrum of one motion."""
    sampled = dynamics.run_cycles(
        [point.pair],
        point.speed,
        point.load_torque,
        SAMPLED,
        states=states,
        samples_per_cycle=SAMPLES,
    )
    b, wn = point.pair.half_backlash, point.pair.derived.wn
    delta = sampled.samples[0]['delta'] / b
    slope = sampled.samples[0]['delta_dot'] / (b * wn)
    order, lines = signal.amplitude_spectrum(delta - delta.mean(), SAMPLES, length=len(delta) // 2)
    low = order <= 4
    return {
        'tau': sampled.samples[0]['t'] * wn,
        'delta': delta,
        'delta_dot': slope,
        'order': order[low],
        'amplitude': lines[low],
    }


def attractor(
    point: OperatingPoint,
    frictions: Sequence[float] = (0.0, 0.03, 0.05),
    *,
    transient: int = 1000,
    cycles: int = 4000,
    runner: Runner | None = None,
) -> Outcome:
    """Return the motion from the static state for each friction coefficient.

    Parameters
    ----------
    point : OperatingPoint
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
    points = with_frictions(point, frictions)
    begins = [scattered_states(each, 1) for each in points]
    results = records(points, begins, transient, cycles, runner, 'attractor')
    arguments = [
        {'point': each, 'states': result['states']}
        for each, result in zip(points, results, strict=True)
    ]
    portraits = runner.run(portrait_task, arguments, 'portraits')
    findings = [finding(each, result, 0) for each, result in zip(points, results, strict=True)]
    arrays = {name: np.array([each[name] for each in portraits]) for name in SAMPLED_UNITS}
    arrays['sections'] = np.array([result['sections'][0] for result in results])
    arrays |= finding_arrays(findings)
    return Outcome(
        'attractor',
        _text(point, findings),
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


def _text(point: OperatingPoint, findings: Sequence[MotionResult]) -> str:
    lines = [f'w = {point.frequency_ratio:.4f}, load torque {point.load_torque:g} N m']
    for each in findings:
        lines.append(
            f'mu = {each.friction:g}: {each.regime.words}, by two nearby motions '
            f'{each.nearby:+.4f} +- {each.nearby_error:.4f} per tau, by tangent vectors'
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


def draw(arrays: Arrays) -> Figure:
    """Draw history, spectrum, phase portrait, section and exponents side by side."""
    frictions = arrays['friction']
    figure = new_figure(17, 0.6 + 2.9 * len(frictions), 'The motion on the line of action')
    # The same axes in a column, so that the rows compare.
    grid = figure.subplots(
        len(frictions),
        5,
        squeeze=False,
        sharex='col',
        sharey='col',
        width_ratios=(1.5, 1.2, 1, 1, 0.8),
    )
    for i, row in enumerate(grid):
        _row(row, arrays, i)
    names = (
        f'τ, the first {SHOWN} cycles',
        'mesh orders',
        f'δ / b, orbit of {SAMPLED} cycles',
        f'δ / b, section of {arrays["sections"].shape[1]} cycles',
        'number of the exponent',
    )
    for axes, name in zip(grid[-1], names, strict=True):
        axes.set_xlabel(name)
    return figure


def _row(row: np.ndarray, arrays: Arrays, i: int) -> None:
    """Draw the motion with friction i."""
    colour = COLOURS[i % len(COLOURS)]
    history, spectrum, portrait, section, exponents = row
    first = slice(SHOWN * SAMPLES)
    history.plot(arrays['tau'][i, first], arrays['delta'][i, first], color=colour, linewidth=0.6)
    history.set(ylabel='δ / b', title=f'μ = {arrays["friction"][i]:g}: {arrays["kind"][i]}')
    floor = arrays['amplitude'].max() * 1e-5
    spectrum.semilogy(
        arrays['order'][i], np.maximum(arrays['amplitude'][i], floor), color=colour, lw=0.6
    )
    spectrum.set(ylabel='amplitude of δ / b')
    # Each cycle by itself, so thin and faint that what many of them share stands out.
    last = arrays['delta'].shape[1] - 1
    cycles = np.minimum(np.arange(0, last, SAMPLES) + np.arange(SAMPLES + 1)[:, np.newaxis], last)
    orbit = arrays['delta'][i, cycles], arrays['delta_dot'][i, cycles]
    portrait.plot(*orbit, color=colour, lw=0.3, alpha=0.2)
    portrait.set(ylabel="δ' / (b ωn)")
    size = 1 if str(arrays['kind'][i]).startswith('chaotic') else 12
    section.scatter(*arrays['sections'][i].T, s=size, color=colour, linewidths=0)
    section.set(ylabel="δ' / (b ωn)")
    values, errors = arrays['exponents'][i], arrays['standard_errors'][i]
    numbers = np.arange(1, len(values) + 1)
    exponents.bar(numbers, values, yerr=2 * errors, color=colour)
    settled = '' if arrays['settled'][i].all() else 'not settled'
    exponents.set(ylabel='exponents ± 2 standard errors [1/τ]', xticks=numbers, title=settled)
