"""The look that the figures share."""

from __future__ import annotations

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
    # As text, so that Matplotlib is loaded by those who draw alone.
    'axes.prop_cycle': f'cycler("color", {list(COLOURS)})',
    'xtick.color': INK,
    'ytick.color': INK,
    'grid.color': '#eef1f4',
    'legend.frameon': False,
}
"""Settings of Matplotlib."""
