"""The look that the figures share."""

from __future__ import annotations

import matplotlib as mpl

COLOURS = ('#1f6f8b', '#d1495b', '#e8a33d', '#5b8e5a')
INK, FAINT = '#22303c', '#c3ccd4'

STYLE = {
    'font.size': 9,
    'text.color': INK,
    'axes.labelcolor': INK,
    'axes.edgecolor': FAINT,
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.titlesize': 10,
    'axes.titlelocation': 'left',
    'axes.axisbelow': True,
    'axes.prop_cycle': mpl.cycler(color=COLOURS),
    'xtick.color': INK,
    'ytick.color': INK,
    'grid.color': '#eef1f4',
    'legend.frameon': False,
}
"""Settings of Matplotlib."""
