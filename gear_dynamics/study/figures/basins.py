"""The picture of the basins of attraction."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from gear_dynamics.figure_style import COLOURS, FAINT, INK
from gear_dynamics.study.figures.style import Arrays, legend_below, new_figure

SURFACE = '#ffffff'

NAMED = len(COLOURS)
"""Attractors with a colour of their own; those that few states reach share one."""


def draw(arrays: Arrays) -> Figure:
    """Draw the attractor of each initial state in its colour, with shares, and its points."""
    figure = new_figure(8, 6.5, 'Which motion an initial state ends in')
    axes = figure.subplots()
    label = np.minimum(arrays['label'], NAMED)
    colours = ListedColormap([*COLOURS, FAINT])
    axes.pcolormesh(
        arrays['delta'], arrays['delta_dot'], label, cmap=colours, vmin=-0.5, vmax=NAMED + 0.5
    )
    for i in range(min(NAMED, len(arrays['share']))):
        points = arrays['points'][arrays['points_of'] == i]
        size, edge = (28, 0.8) if arrays['period'][i] else (1, 0)
        axes.scatter(*points.T, s=size, color=SURFACE if edge else INK, edgecolor=INK, lw=edge)
    axes.set(xlabel='δ / b', ylabel="δ' / (b ωn)")
    axes.grid(False)
    shares = arrays['share']
    handles = [
        Patch(color=COLOURS[i], label=f'{arrays["names"][i]}: {shares[i]:.1%}')
        for i in range(min(NAMED, len(shares)))
    ]
    if len(shares) > NAMED:
        handles.append(Patch(color=FAINT, label=f'others: {shares[NAMED:].sum():.1%}'))
    legend_below(axes, handles)
    return figure
