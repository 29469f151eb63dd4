"""The orbit diagrams, with the largest exponent below."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_dynamics.figure_style import COLOURS
from gear_dynamics.study.chaos_edges import SIDES, edge_in
from gear_dynamics.study.figures.style import (
    Arrays,
    band_handle,
    draw_band,
    new_figure,
    zero_line,
)
from gear_dynamics.study.sweep import DOWN, UP, unit_of

WORDS = ('swept up', 'swept down')


def draw(arrays: Arrays) -> Figure:
    """Draw a column for each friction coefficient."""
    frictions, parameter = arrays['friction'], str(arrays['parameter'])
    label = 'mesh frequency / ωn' if parameter == 'w' else f'{parameter} [{unit_of(parameter)}]'
    title = f'Motion on the section against {label}'
    figure = new_figure(6.5 * max(len(frictions), 1.4), 7.5, title)
    grid = figure.subplots(
        2, len(frictions), squeeze=False, sharex=True, sharey='row', height_ratios=(3, 1.4)
    )
    for i, mu in enumerate(frictions):
        named = '' if parameter == 'friction_coefficient' else f'μ = {mu:g}'
        _orbits(grid[0, i], arrays['values'], arrays['sections'][i, ..., 0], named)
        _exponents(grid[1, i], arrays, i)
        grid[1, i].set_xlabel(label)
    grid[0, 0].set_ylabel('δ / b')
    grid[1, 0].set_ylabel('largest exponent [1/τ]')
    lowest = float(arrays['exponents'][..., 0].min())
    highest = float(arrays['exponents'][..., 0].max())
    grid[1, 0].set_ylim(max(lowest * 1.05, -0.12), highest * 1.1 + 0.01)
    return figure


def _orbits(axes: Axes, values: np.ndarray, delta: np.ndarray, title: str) -> None:
    # Down first and larger, so that both show where they agree.
    for direction, size in ((DOWN, 1.6), (UP, 0.5)):
        x = np.repeat(values, delta.shape[-1])
        y = delta[direction].ravel()
        colour = COLOURS[direction]
        axes.scatter(x, y, s=size, color=colour, linewidths=0, rasterized=True)
        axes.plot([], [], 'o', color=colour, markersize=4, label=WORDS[direction])
    axes.set_title(title)
    axes.legend(loc='lower left')


def _exponents(axes: Axes, arrays: Arrays, i: int) -> None:
    values = arrays['values']
    for direction in (DOWN, UP):
        colour = COLOURS[direction]
        exponent = arrays['exponents'][i, direction, :, 0]
        draw_band(axes, values, exponent, arrays['standard_errors'][i, direction, :, 0], colour)
        axes.plot(values, exponent, color=colour, linewidth=0.8)
        for side, word in enumerate(SIDES):
            fine = arrays['fine_values'][i, direction, side]
            place = edge_in(fine, arrays['fine_kind'][i, direction, side], side)
            if np.isfinite(place):
                label = f'chaos {word}s, {WORDS[direction]}: {place:.{_decimals(fine)}f}'
                axes.axvline(place, color=colour, linewidth=0.8, linestyle=':', label=label)
    axes.legend(handles=[*axes.get_legend_handles_labels()[0], band_handle()], loc='upper left')
    zero_line(axes)


def _decimals(fine: np.ndarray) -> int:
    """Return how many decimals the steps of a grid resolve."""
    return max(0, math.ceil(-math.log10(fine[1] - fine[0])))
