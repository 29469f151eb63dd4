"""The figure of the friction spectra: lines, and the map of where vibration rises."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from gear_dynamics.figure_style import COLOURS, FAINT, INK
from gear_dynamics.study.figures.style import Arrays, legend_below, new_figure
from gear_dynamics.study.friction_spectrum import QUANTITIES, regular_places

CLAIMED = {
    'all_directions': 'claim 1: rises in all directions',
    'most_in_x': 'claim 2: rises most in x',
    'into_first': 'claim 3: into the first harmonic',
}
"""Maps of where the source's claims hold."""


def draw(arrays: Arrays) -> Figure:
    """Draw the lines of the pinion's acceleration above the maps over phase and speed."""
    has_map = 'map' in arrays
    figure = new_figure(12, 11 if has_map else 4, 'What friction does to the vibration')
    parts = figure.subfigures(3 if has_map else 1, 1, squeeze=False)[:, 0]
    left, right = parts[0].subplots(1, 2)
    _lines(left, arrays, 'ay_lines', 'pinion, along the line of action (y)')
    _lines(right, arrays, 'ax_lines', 'pinion, across the line of action (x)')
    if has_map:
        left, right = parts[1].subplots(1, 2)
        _ratio(left, arrays, 'pinion_ay', 0, "RMS of the pinion's acceleration along y")
        _ratio(right, arrays, 'mesh_force', 1, 'first mesh harmonic of the mesh force')
        parts[2].suptitle(
            'Where the claims hold: shares of the places where both motions have a period',
            fontsize=10,
        )
        claims = parts[2].subplots(1, 3, sharey=True)
        for axes, name in zip(claims, CLAIMED, strict=True):
            _claim(axes, arrays, name)
        true, false = Patch(color=COLOURS[0], label='holds'), Patch(color=FAINT, label='does not')
        irregular = Line2D([], [], color=INK, marker='.', linestyle='none', label='no period')
        legend_below(claims[1], [true, false, irregular])
    return figure


def _lines(axes: Axes, arrays: Arrays, name: str, title: str) -> None:
    for i, mu in enumerate(arrays['friction']):
        orders = arrays['order'] + 0.3 * (i - 0.5)
        label = f'μ = {mu:g}' + ('' if arrays['period'][i] else ', no period')
        axes.bar(orders, arrays[name][i], 0.3, color=COLOURS[i], label=label)
    axes.set(xlabel='mesh harmonic', ylabel='amplitude [m/s²]', title=title)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend()


def _ratio(axes: Axes, arrays: Arrays, name: str, which: int, title: str) -> None:
    rows = arrays['map'][..., QUANTITIES.index(name), which]
    with np.errstate(divide='ignore', invalid='ignore'):
        change = 100 * (rows[1] / rows[0] - 1)
    limit = 20.0
    norm = mpl.colors.Normalize(-limit, limit)
    axes.pcolormesh(*_map_axes(arrays), change, cmap='RdBu_r', norm=norm)
    _label_map(axes, arrays, title)
    bar = axes.figure.colorbar(mpl.cm.ScalarMappable(norm, 'RdBu_r'), ax=axes, extend='both')
    bar.set_label('change by friction [%]')


def _claim(axes: Axes, arrays: Arrays, name: str) -> None:
    where = arrays[f'map_{name}']
    colours = ListedColormap([FAINT, COLOURS[0]])
    axes.pcolormesh(*_map_axes(arrays), where, cmap=colours, vmin=0, vmax=1)
    regular = regular_places(arrays)
    share = f'{where[regular].mean():.0%}' if regular.any() else 'none has one'
    _label_map(axes, arrays, f'{CLAIMED[name]}: {share}')


def _map_axes(arrays: Arrays) -> tuple[np.ndarray, np.ndarray]:
    return arrays['map_speed'] * 30 / np.pi, np.degrees(arrays['map_phase'])


def _label_map(axes: Axes, arrays: Arrays, title: str) -> None:
    """Label a map, and dot it where one of the two motions has no period."""
    irregular = ~regular_places(arrays)
    if irregular.any():
        speed, phase = np.meshgrid(*_map_axes(arrays))
        axes.plot(speed[irregular], phase[irregular], '.', color=INK, markersize=1.5)
    axes.set(xlabel='speed [rpm]', ylabel='φ0 [deg]', title=title)
    axes.grid(False)
