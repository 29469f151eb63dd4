"""The demo's picture: waveform, spectrum and Poincaré section at both speeds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from demo.report import Half
from gear_dynamics.figure_style import COLOURS, INK, STYLE

HIGHEST = 20.0
"""Right end of the spectra [kHz]."""

DECADES = 5
"""Height of the spectra."""

LABELS = (
    ('mesh cycles', 'acceleration of the pinion [km/s²]'),
    ('frequency [kHz]', 'amplitude [m/s²]'),
    ('displacement / half backlash', 'velocity, scaled'),
)


def draw(path: Path, halves: Sequence[Half], title: str) -> None:
    """Draw a row for each speed, on the same axes where they compare, into a PNG.

    Parameters
    ----------
    path : Path
        PNG file to write.
    halves : sequence of Half
    title : str
    """
    with mpl.rc_context(STYLE):
        layout = ConstrainedLayoutEngine(h_pad=0.1, w_pad=0.1)
        figure = Figure(figsize=(12, 0.8 + 3.0 * len(halves)), layout=layout)
        figure.suptitle(title, x=0.012, ha='left', fontsize=13, fontweight='bold')
        axes = figure.subplots(
            len(halves), 3, width_ratios=(4, 5, 3.6), sharex='col', squeeze=False
        )
        top = max(half.spectrum['pinion_ay'].max() for half in halves) * 3
        for row, half, colour in zip(axes, halves, COLOURS, strict=False):
            _waveform(row[0], half, colour)
            _spectrum(row[1], half, colour)
            row[1].set_ylim(top / 10**DECADES, top)
            _section(row[2], half, colour)
            row[2].sharey(axes[0, 2])
        axes[-1, 2].autoscale()
        for column, (x, y) in zip(axes.T, LABELS, strict=True):
            column[-1].set_xlabel(x)
            for axis in column:
                axis.set_ylabel(y)
        figure.savefig(path, dpi=110)


def _waveform(axis: Axes, half: Half, colour: str) -> None:
    cycles = (half.waveform['t'] - half.waveform['t'][0]) * half.expected
    axis.plot(cycles, half.waveform['pinion_ay'] / 1000, color=colour, linewidth=1.1)
    axis.set_title(f'{half.rpm:.0f} rpm', fontweight='bold', color=colour)
    axis.set_xlim(0, cycles[-1])
    axis.grid(True)


def _spectrum(axis: Axes, half: Half, colour: str) -> None:
    frequency, amplitude = half.spectrum['frequency'] / 1000, half.spectrum['pinion_ay']
    axis.semilogy(frequency, amplitude, color=colour, linewidth=0.7)
    mesh = half.expected / 1000
    multiples = np.arange(1, int(HIGHEST / mesh) + 1)
    lines = np.array([amplitude[abs(frequency - k * mesh) < 0.02].max() for k in multiples])
    circle = {'color': INK, 'markerfacecolor': 'white', 'markersize': 4, 'clip_on': False}
    axis.plot(multiples * mesh, lines, 'o', **circle)
    above = {'xytext': (0, 5), 'textcoords': 'offset points', 'ha': 'center'}
    step = 1 if mesh > 1 else 5
    for k, line in zip(multiples, lines, strict=True):
        if k == 1 or k % step == 0:
            axis.annotate(f'{k}×', (k * mesh, line), **above)
    axis.set_title(f'circles: multiples of the mesh frequency, {half.expected:.1f} Hz')
    axis.set_xlim(0, HIGHEST)


def _section(axis: Axes, half: Half, colour: str) -> None:
    x, y = half.section['x'], half.section['y']
    one_point = max(np.ptp(x), np.ptp(y)) < 0.01
    style = {'markersize': 7} if one_point else {'markersize': 2, 'alpha': 0.5}
    axis.plot(x, y, '.', color=colour, markeredgewidth=0, **style)
    axis.set_title(f'Poincaré section: {len(x)} mesh cycles')
    axis.grid(True)
