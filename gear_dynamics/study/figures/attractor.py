"""The figure of an attractor: a row for each friction coefficient."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gear_dynamics.figure_style import COLOURS
from gear_dynamics.study.attractor_portrait import SAMPLED, SAMPLES, SHOWN
from gear_dynamics.study.figures.style import Arrays, new_figure


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
