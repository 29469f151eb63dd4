"""The figure of the frequency response."""

from __future__ import annotations

from matplotlib.figure import Figure

from gear_dynamics.figure_style import COLOURS, FAINT
from gear_dynamics.study.figures.style import Arrays, band_handle, draw_band, new_figure


def draw(arrays: Arrays) -> Figure:
    """Draw RMS with two standard errors, extremes and force against w, both directions."""
    figure = new_figure(9, 8, 'Frequency response, swept up and down')
    grid = figure.subplots(3, 1, sharex=True)
    for i, (label, style) in enumerate((('swept up', '.-'), ('swept down', '.--'))):
        look = {'color': COLOURS[i], 'linewidth': 0.8, 'markersize': 3}
        for axes, name, scale in ((grid[0], 'rms', 1), (grid[2], 'force_rms', 1e-3)):
            centre, error = arrays[name][i] * scale, arrays[f'{name}_error'][i] * scale
            draw_band(axes, arrays['w'], centre, error, COLOURS[i])
        grid[0].plot(arrays['w'], arrays['rms'][i], style, label=label, **look)
        grid[1].plot(arrays['w'], arrays['greatest'][i], style, **look)
        grid[1].plot(arrays['w'], arrays['least'][i], style, **look)
        grid[2].plot(arrays['w'], arrays['force_rms'][i] / 1000, style, **look)
    for edge in (1, -1):
        grid[1].axhline(edge, color=FAINT, linewidth=1, label='edges of the gap' * (edge > 0))
    grid[1].legend()
    grid[0].set(ylabel='RMS of δ / b')
    grid[0].legend(handles=[*grid[0].get_legend_handles_labels()[0], band_handle()])
    grid[1].set(ylabel='least and greatest δ / b')
    grid[2].set(ylabel='RMS of the mesh force [kN]', xlabel='mesh frequency / ωn')
    return figure
