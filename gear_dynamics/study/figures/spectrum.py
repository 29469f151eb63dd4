"""The figure of the friction spectra: lines, and the map of where vibration rises."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_dynamics.study.figures.style import COLOURS, INK, Arrays, new_figure
from gear_dynamics.study.friction_spectrum import QUANTITIES


def draw(arrays: Arrays) -> Figure:
    """Draw the lines of the pinion's acceleration above the maps over phase and speed."""
    has_map = 'map' in arrays
    figure = new_figure(12, 7.5 if has_map else 4, 'What friction does to the vibration')
    grid = figure.subplots(1 + has_map, 2, squeeze=False)
    _lines(grid[0, 0], arrays, 'ay_lines', 'pinion, along the line of action')
    _lines(grid[0, 1], arrays, 'ax_lines', 'pinion, across the line of action')
    if has_map:
        _ratio(grid[1, 0], arrays, 'pinion_ay', 0, 'RMS of the acceleration along y')
        _ratio(grid[1, 1], arrays, 'mesh_force', 1, 'first mesh harmonic of the mesh force')
    return figure


def _lines(axes: Axes, arrays: Arrays, name: str, title: str) -> None:
    for i, mu in enumerate(arrays['friction']):
        at_orders = arrays[name][i][:: _per_order(arrays)]
        orders = np.arange(len(at_orders)) + 0.3 * (i - 0.5)
        axes.bar(orders[1:], at_orders[1:], 0.3, color=COLOURS[i], label=f'μ = {mu:g}')
    axes.set(xlabel='mesh harmonic', ylabel='amplitude [m/s²]', title=title)
    axes.legend()


def _per_order(arrays: Arrays) -> int:
    return round(1 / arrays['order'][0, 1])


def _ratio(axes: Axes, arrays: Arrays, name: str, which: int, title: str) -> None:
    rows = arrays['map'][..., QUANTITIES.index(name), which]
    with np.errstate(divide='ignore', invalid='ignore'):
        change = 100 * (rows[1] / rows[0] - 1)
    limit = 20.0
    phases, speeds = np.degrees(arrays['map_phase']), arrays['map_speed']
    mesh = axes.pcolormesh(
        speeds * 30 / np.pi, phases, change, cmap='RdBu_r', vmin=-limit, vmax=limit
    )
    axes.contour(speeds * 30 / np.pi, phases, change, [0.0], colors=INK, linewidths=0.6)
    axes.set(xlabel='speed [rpm]', ylabel='φ0 [deg]', title=title)
    axes.grid(False)
    bar = axes.figure.colorbar(mpl.cm.ScalarMappable(mesh.norm, mesh.cmap), ax=axes, extend='both')
    bar.set_label('change by friction [%]')
