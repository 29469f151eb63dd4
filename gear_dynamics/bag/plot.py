"""A report of a log as one PNG figure."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gear_dynamics.bag.log import Log, LogPath
from gear_dynamics.bag.report import (
    Segments,
    find_rig,
    gather_indicators,
    gather_section,
    gather_segments,
)

UNITS = {
    'pinion_ax': 'm/s²',
    'pinion_ay': 'm/s²',
    'gear_ax': 'm/s²',
    'gear_ay': 'm/s²',
    'mesh_force': 'N',
    'friction_force': 'N',
    'delta': 'm',
    'delta_dot': 'm/s',
}

HARMONICS = 10
"""Multiples of the mesh frequency that are marked."""

REVOLUTIONS = 1.0
"""Pinion revolutions of waveform that are shown, or less where a segment is shorter."""


def plot(path: LogPath, file: Path, channel: str) -> None:
    """Draw waveform, spectrum, waterfall, Poincaré section and indicators of a log.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files.
    file : Path
        PNG file to write.
    channel : str
        Column of samples that is analysed.

    Raises
    ------
    LogError
        If there is no such log, or it has too few samples.
    OSError
        If the file cannot be written.
    """
    with Log(path) as log:
        segments = gather_segments(log, channel)
        rig = find_rig(log)
        section = gather_section(log, rig)
        indicators = gather_indicators(log, channel)
    mesh = rig.pinion_teeth * segments.speed / (2 * math.pi) if rig else None
    figure = Figure(figsize=(13, 11), layout='constrained')
    FigureCanvasAgg(figure)
    axes: dict[str, Axes] = figure.subplot_mosaic(
        [['wave', 'wave'], ['lines', 'section'], ['fall', 'trend']]
    )
    figure.suptitle(f'{log.sources[0].path.stem}   {channel}')
    _draw_waveform(axes['wave'], segments, channel)
    _draw_spectrum(axes['lines'], segments, channel, None if mesh is None else mesh[-1])
    _draw_section(axes['section'], section)
    _draw_waterfall(axes['fall'], segments, channel, mesh)
    _draw_indicators(axes['trend'], segments, channel, indicators)
    figure.savefig(file, dpi=110, format='png')


def _draw_waveform(axes: Axes, segments: Segments, channel: str) -> None:
    shown = np.ones(len(segments.last_t), bool)
    if segments.speed[-1] > 0:
        span = REVOLUTIONS * 2 * math.pi / segments.speed[-1]
        shown = segments.last_t < segments.last_t[0] + span
    axes.plot(segments.last_t[shown], segments.last_x[shown], linewidth=0.8)
    axes.set(
        title='Waveform at the end of the log, one pinion revolution',
        xlabel='time [s]',
        ylabel=f'{channel} [{UNITS[channel]}]',
    )
    axes.ticklabel_format(axis='x', useOffset=False)
    axes.margins(x=0)
    axes.grid(alpha=0.3)


def _draw_spectrum(axes: Axes, segments: Segments, channel: str, mesh: float | None) -> None:
    spectrum = segments.steady_spectrum()
    top = segments.frequency[-1]
    if mesh:
        top = min(top, (HARMONICS + 1) * mesh)
        label = f'multiples of the mesh frequency, {mesh:.1f} Hz'
        for harmonic in range(1, HARMONICS + 1):
            axes.axvline(harmonic * mesh, color='tab:orange', linewidth=0.7, label=label)
            label = ''
    inside = (segments.frequency <= top) & (segments.frequency > 0)
    lines = spectrum[inside]
    if lines.any():  # a logarithm has no place for a channel that stands still
        axes.set_yscale('log')
    axes.plot(segments.frequency[inside], lines, linewidth=0.8)
    if mesh:
        axes.legend(fontsize='small', loc='lower right')
    axes.set(
        title=f'Amplitude spectrum at {segments.speed[-1]:.1f} rad/s',
        xlabel='frequency [Hz]',
        ylabel=f'amplitude [{UNITS[channel]}]',
        xlim=(0, top),
    )
    axes.grid(alpha=0.3)


def _draw_section(axes: Axes, section: np.ndarray) -> None:
    axes.set(title='Poincaré section', xlabel='δ / b', ylabel="δ' / (b ωn)")
    axes.grid(alpha=0.3)
    if not len(section):
        axes.text(0.5, 0.5, 'none in this log', ha='center', transform=axes.transAxes)
        return
    axes.scatter(section[:, 0], section[:, 1], s=3, c=np.arange(len(section)), cmap='viridis')
    axes.set_title(f'Poincaré section, {len(section)} points, the latest bright')


def _draw_waterfall(axes: Axes, segments: Segments, channel: str, mesh: np.ndarray | None) -> None:
    top = segments.frequency[-1]
    if mesh is not None and mesh.max() > 0:
        top = min(top, (HARMONICS + 1) * mesh.max())
    inside = segments.frequency <= top
    levels = 10 * np.log10(np.maximum(segments.mean_square[:, inside], 1e-300))
    high = levels.max()
    image = axes.pcolormesh(
        segments.frequency[inside],
        segments.t,
        levels,
        vmin=high - 80,
        vmax=high,
        cmap='magma',
        shading='nearest',
        rasterized=True,
    )
    axes.figure.colorbar(image, ax=axes, label=f'RMS level [dB re 1 {UNITS[channel]}]')
    axes.set(title='Waterfall', xlabel='frequency [Hz]', ylabel='time [s]')


def _draw_indicators(
    axes: Axes, segments: Segments, channel: str, indicators: dict[str, np.ndarray]
) -> None:
    """Draw the logged indicators, or RMS and kurtosis where none were logged."""
    axes.set(title=f'Indicators of {channel}, each over its median', xlabel='time [s]')
    axes.grid(alpha=0.3)
    curves = indicators or {
        'rms': np.column_stack([segments.t, segments.rms]),
        'kurtosis': np.column_stack([segments.t, segments.kurtosis]),
    }
    for name, points in curves.items():
        points = points[points[:, 1] > 0]
        if len(points):
            median = np.median(points[:, 1])
            label = f'{name} ({median:.3g})'
            axes.plot(points[:, 0], points[:, 1] / median, '.-', linewidth=0.8, label=label)
    if axes.lines:
        axes.set_yscale('log')
        axes.legend(fontsize='small', ncols=2)
