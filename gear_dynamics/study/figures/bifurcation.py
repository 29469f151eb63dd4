"""The orbit diagrams, with the largest exponent below."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_dynamics.study.figures.style import COLOURS, Arrays, new_figure, zero_line

LABELS = {'w': 'mesh frequency / ωn', 'load_torque': 'load torque [N m]', 'speed': 'speed [rad/s]'}


def draw(arrays: Arrays) -> Figure:
    """Draw a column for each friction coefficient."""
    frictions, parameter = arrays['friction'], str(arrays['parameter'])
    title = f'Motion on the section against {LABELS.get(parameter, parameter)}'
    figure = new_figure(6.5 * max(len(frictions), 1.4), 7.5, title)
    grid = figure.subplots(
        2, len(frictions), squeeze=False, sharex=True, sharey='row', height_ratios=(3, 1.4)
    )
    for i, mu in enumerate(frictions):
        named = '' if parameter == 'friction_coefficient' else f'μ = {mu:g}'
        _orbits(grid[0, i], arrays['values'], arrays['sections'][i, ..., 0], named)
        _exponents(grid[1, i], arrays['values'], arrays['exponent'][i])
        grid[1, i].set_xlabel(LABELS.get(parameter, parameter))
    grid[0, 0].set_ylabel('δ / b')
    grid[1, 0].set_ylabel('largest exponent [1/τ]')
    return figure


def _orbits(axes: Axes, values: np.ndarray, delta: np.ndarray, title: str) -> None:
    # Down first and larger, so that both show where they agree.
    for direction, size, label in ((1, 1.6, 'swept down'), (0, 0.5, 'swept up')):
        x = np.repeat(values, delta.shape[-1])
        y = delta[direction].ravel()
        colour = COLOURS[direction]
        axes.scatter(x, y, s=size, color=colour, linewidths=0, label=label, rasterized=True)
    axes.set_title(title)
    axes.legend(markerscale=8, loc='lower left')


def _exponents(axes: Axes, values: np.ndarray, exponent: np.ndarray) -> None:
    for direction in (1, 0):
        axes.plot(values, exponent[direction], color=COLOURS[direction], linewidth=0.8)
    zero_line(axes)
    axes.set_ylim(max(float(exponent.min()) * 1.05, -0.12), float(exponent.max()) * 1.1 + 0.01)
