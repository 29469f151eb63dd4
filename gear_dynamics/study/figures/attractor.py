"""The figure of an attractor: a row for each friction coefficient."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gear_dynamics.figure_style import COLOURS
from gear_dynamics.study.figures.style import Arrays, new_figure


def draw(arrays: Arrays) -> Figure:
    """Draw history, spectrum, phase portrait, section and exponents side by side."""
    frictions = arrays['friction']
    figure = new_figure(17, 0.6 + 2.9 * len(frictions), 'The motion on the line of action')
    grid = figure.subplots(
        len(frictions), 5, squeeze=False, sharex='col', width_ratios=(1.5, 1.2, 1, 1, 0.8)
    )
    for i, (row, mu) in enumerate(zip(grid, frictions, strict=True)):
        colour = COLOURS[i % len(COLOURS)]
        history, spectrum, portrait, section, exponents = row
        history.plot(arrays['tau'][i], arrays['delta'][i], color=colour, linewidth=0.6)
        history.set(ylabel='δ / b', title=f'μ = {mu:g}: {arrays["kind"][i]}')
        floor = arrays['amplitude'][i].max() * 1e-5
        spectrum.semilogy(
            arrays['order'][i], np.maximum(arrays['amplitude'][i], floor), color=colour, lw=0.6
        )
        spectrum.set(ylabel='amplitude of δ / b')
        portrait.plot(arrays['delta'][i], arrays['delta_dot'][i], color=colour, linewidth=0.4)
        portrait.set(ylabel="δ' / (b ωn)")
        size = 1 if str(arrays['kind'][i]).startswith('chaotic') else 12
        section.scatter(*arrays['sections'][i].T, s=size, color=colour, linewidths=0)
        section.set(ylabel="δ' / (b ωn)")
        values = arrays['exponents'][i]
        numbers = np.arange(1, len(values) + 1)
        exponents.bar(numbers, values, yerr=2 * arrays['standard_errors'][i], color=colour)
        settled = '' if arrays['settled'][i].all() else 'not settled'
        exponents.set(ylabel='exponents [1/τ]', xticks=numbers, title=settled)
    names = ('τ', 'mesh orders', 'δ / b, orbit', 'δ / b, section', 'number of the exponent')
    for axes, name in zip(grid[-1], names, strict=True):
        axes.set_xlabel(name)
    return figure
