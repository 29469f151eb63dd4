"""The figure of the Lyapunov spectra: convergence and sections."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_dynamics.study.figures.style import COLOURS, Arrays, new_figure, zero_line


def draw(arrays: Arrays) -> Figure:
    """Draw the convergence of all exponents and the section, a column for each friction."""
    frictions = np.unique(arrays['friction'])
    figure = new_figure(4 * len(frictions), 7, 'Lyapunov exponents per τ = ωn t')
    grid = figure.subplots(2, len(frictions), squeeze=False, sharey='row')
    for column, mu in zip(grid.T, frictions, strict=True):
        which = np.flatnonzero(arrays['friction'] == mu)
        _convergence(column[0], arrays, which, mu)
        half = arrays['sections'].shape[1] // 2
        points = arrays['sections'][which, half:].reshape(-1, 2)
        periodic = len(np.unique(points.round(3), axis=0)) <= 64
        column[1].plot(points[:, 0], points[:, 1], '.' if periodic else ',', color=COLOURS[0])
        column[1].set(xlabel='δ / b', title='section, second half of the records')
    grid[0, 0].set_ylabel('mean over the first cycles [1/τ]')
    grid[1, 0].set_ylabel("δ' / (b ωn)")
    return figure


def _convergence(axes: Axes, arrays: Arrays, which: np.ndarray, mu: float) -> None:
    for i in which:
        cycles = arrays['convergence_cycles'][i]
        rest = arrays['convergence'][i, :, 1:]
        axes.plot(cycles, rest, color='#c3ccd4', linewidth=0.5)
        axes.plot(cycles, arrays['convergence'][i, :, 0], color=COLOURS[1], linewidth=1)
    zero_line(axes)
    value = arrays['exponents'][which, 0].mean()
    axes.set(xlabel='mesh cycles', title=f'μ = {mu:g}: largest {value:+.4f}')
