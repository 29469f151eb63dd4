"""What the figures of the studies have in common."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics.figure_style import INK, STYLE
from gear_dynamics.study.outcome import Arrays

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

Draw = Callable[[Arrays], 'Figure']

BAND = 0.25
"""Opacity of what shades standard errors."""


def new_figure(width: float, height: float, title: str) -> Figure:
    """Return an empty figure with a title; sizes in inches."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    figure = Figure(figsize=(width, height), layout=ConstrainedLayoutEngine(h_pad=0.08, w_pad=0.08))
    figure.suptitle(title, x=0.012, ha='left', fontsize=12, fontweight='bold')
    return figure


def save_figure(draw: Draw, arrays: Arrays, path: Path) -> None:
    """Draw a figure and write it as PNG."""
    import matplotlib as mpl

    with mpl.rc_context({**STYLE, 'axes.grid': True}):
        draw(arrays).savefig(path, dpi=130)


def legend_below(axes: Axes, handles: Sequence[Artist], ncols: int = 3) -> None:
    """Put a legend below the labels of the axes, by default three in a row."""
    # Matplotlib 3.6, which Ubuntu 24.04 has, knows no legend outside of a figure's axes.
    below = {'loc': 'upper center', 'bbox_to_anchor': (0.5, 0.0), 'borderaxespad': 4.0}
    axes.legend(handles=handles, ncols=ncols, **below)


def draw_band(axes: Axes, x: np.ndarray, y: np.ndarray, error: np.ndarray, colour: str) -> None:
    """Shade two standard errors to either side of a curve."""
    low, high = y - 2 * error, y + 2 * error
    axes.fill_between(x, low, high, color=colour, alpha=BAND, linewidth=0)


def band_handle() -> Patch:
    """Return what stands for such bands in a legend."""
    from matplotlib.patches import Patch

    return Patch(color=INK, alpha=BAND, linewidth=0, label='± 2 standard errors')


def zero_line(axes: Axes) -> None:
    """Draw the line at zero."""
    axes.axhline(0, color=INK, linewidth=0.6)
