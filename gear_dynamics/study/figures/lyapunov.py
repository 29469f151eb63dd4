"""The figure of the Lyapunov spectra: convergence and sections."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gear_dynamics.figure_style import COLOURS
from gear_dynamics.study.figures.style import Arrays, legend_below, new_figure, zero_line

OTHERS = '#9aa7b2'


def draw(arrays: Arrays) -> Figure:
    """Draw the convergence of all exponents and the section, a column for each friction."""
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
