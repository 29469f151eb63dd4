"""The demo's picture: a healthy machine at two speeds, and with a cracked tooth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from demo.report import PER_TOOTH, Part
from gear_dynamics.figure_style import COLOURS, INK, STYLE
from gear_dynamics.model.gear_pair import GearPair

HIGHEST = 20.0
"""Right end of the spectra [kHz]."""

CONTACT_RATIO = GearPair().derived.contact_ratio

DECADES = 5
"""Height of the spectra."""

LABELS = (
    ('mesh cycles', 'acceleration of the pinion [km/s²]'),
    ('frequency [kHz]', 'amplitude [m/s²]'),
    ('displacement / half backlash', 'velocity, scaled'),
)


def draw(path: Path, parts: Sequence[Part], cracked_tooth: int, title: str) -> None:
    """Draw a row for each part, on the same axes where they compare, into a PNG.

    Parameters
    ----------
    path : Path
        PNG file to write.
    parts : sequence of Part
        In the last one the machine has a cracked tooth.
    cracked_tooth : int
    title : str
    """
    with mpl.rc_context(STYLE):
        layout = ConstrainedLayoutEngine(h_pad=0.1, w_pad=0.1)
        figure = Figure(figsize=(12, 0.8 + 3.0 * len(parts)), layout=layout)
        figure.suptitle(title, x=0.012, ha='left', fontsize=13, fontweight='bold')
        axes = figure.subplots(len(parts), 3, width_ratios=(4, 5, 3.6), squeeze=False)
        top = max(part.spectrum['pinion_ay'].max() for part in parts) * 3
        for row, part, colour in zip(axes, parts, COLOURS, strict=False):
            _waveform(row[0], part, colour)
            _spectrum(row[1], part, colour)
            row[1].set_ylim(top / 10**DECADES, top)
            if part is not parts[-1]:
                _section(row[2], part, colour)
                row[2].sharex(axes[0, 2])
                row[2].sharey(axes[0, 2])
            for axis, (x, y) in zip(row, LABELS, strict=True):
                axis.set_xlabel(x)
                axis.set_ylabel(y)
        axes[0, 2].autoscale()
        _average(axes[-1, 2], parts[-1], cracked_tooth, COLOURS[len(parts) - 1])
        axes[-1, 0].set_title(
            f'{parts[-1].rpm:.0f} rpm, a cracked tooth',
            fontweight='bold',
            color=COLOURS[len(parts) - 1],
        )
        figure.savefig(path, dpi=110)


def _waveform(axis: Axes, part: Part, colour: str) -> None:
    cycles = (part.waveform['t'] - part.waveform['t'][0]) * part.expected
    axis.plot(cycles, part.waveform['pinion_ay'] / 1000, color=colour, linewidth=1.1)
    axis.set_title(f'{part.rpm:.0f} rpm', fontweight='bold', color=colour)
    axis.set_xlim(0, cycles[-1])
    axis.grid(True)


def _spectrum(axis: Axes, part: Part, colour: str) -> None:
    frequency, amplitude = part.spectrum['frequency'] / 1000, part.spectrum['pinion_ay']
    axis.semilogy(frequency, amplitude, color=colour, linewidth=0.7)
    mesh = part.expected / 1000
    multiples = np.arange(1, int(HIGHEST / mesh) + 1)
    lines = np.array([amplitude[abs(frequency - k * mesh) < 0.02].max() for k in multiples])
    circle = {'color': INK, 'markerfacecolor': 'white', 'markersize': 4, 'clip_on': False}
    axis.plot(multiples * mesh, lines, 'o', **circle)
    above = {'xytext': (0, 5), 'textcoords': 'offset points', 'ha': 'center'}
    step = 1 if mesh > 1 else 5
    for k, line in zip(multiples, lines, strict=True):
        if k == 1 or k % step == 0:
            axis.annotate(f'{k}×', (k * mesh, line), **above)
    axis.set_title(f'circles: multiples of the mesh frequency, {part.expected:.1f} Hz')
    axis.set_xlim(0, HIGHEST)


def _section(axis: Axes, part: Part, colour: str) -> None:
    x, y = part.section['x'], part.section['y']
    one_point = max(np.ptp(x), np.ptp(y)) < 0.01
    style = {'markersize': 7} if one_point else {'markersize': 2, 'alpha': 0.5}
    axis.plot(x, y, '.', color=colour, markeredgewidth=0, **style)
    axis.set_title(f'Poincaré section: {len(x)} mesh cycles')
    axis.grid(True)


def _average(axis: Axes, part: Part, tooth: int, colour: str) -> None:
    """Draw the synchronous average over the teeth of the pinion, with the cracked one marked."""
    place = np.arange(part.average.size) / PER_TOOTH
    axis.axvspan(tooth, tooth + CONTACT_RATIO, color=INK, alpha=0.15, linewidth=0)
    axis.plot(place, part.average, color=colour, linewidth=0.9)
    axis.annotate(
        f'cracked tooth {tooth}', (tooth, 1), xycoords=('data', 'axes fraction'), xytext=(-4, -12),
        textcoords='offset points', ha='right',
    )  # fmt: skip
    axis.set_title('synchronous average; grey: in contact')
    axis.set_xlabel('tooth of the pinion')
    axis.set_ylabel('acceleration [m/s²]')
    axis.set_xlim(0, place[-1])
    axis.grid(True)
