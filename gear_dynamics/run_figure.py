"""A figure of a simulation."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np

from gear_dynamics.figure_style import COLOURS, INK, STYLE
from gear_dynamics.machine.columns import CHANNELS, EventKind
from gear_dynamics.model.derived import derive
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.signal.spectrum import amplitude_spectrum
from gear_dynamics.simulation.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

UNITS = dict(zip(CHANNELS, ['m/s²'] * 4 + ['N'] * 2 + ['m', 'm/s'], strict=True))

CYCLES = 10.0
"""Mesh cycles of waveform that are shown."""

HARMONICS = 20
"""Multiples of the mesh frequency that are shown."""


def plot(run: Run, file: str | Path | None = None, *, channel: str = 'gear_ay') -> Figure:
    """Draw the waveform, spectrum, phase portrait and Poincaré section of a run.

    Waveform and portrait are of its last ten mesh cycles.

    Parameters
    ----------
    run : Run
    file : path, optional
        Where to save the figure; the suffix gives the format.
    channel : str
        Column of waveform and spectrum: an acceleration, a force, delta or delta_dot.

    Returns
    -------
    matplotlib.figure.Figure
        Shown by a notebook; `matplotlib.pyplot` does not know it.

    Raises
    ------
    ParameterError
        If there is no such channel.
    OSError
        If the file cannot be written.
    """
    from matplotlib.figure import Figure

    if channel not in UNITS:
        raise ParameterError(f'channel is {channel!r}: it must be one of {", ".join(UNITS)}')
    mesh = run.pair.pinion_teeth * run.settings.speed / (2 * math.pi)
    cycles = CYCLES / mesh if mesh > 0 else math.inf
    last = run.samples[run['t'] > run['t'][-1] - cycles]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11, 6.5), layout='constrained')
        (wave, lines), (portrait, section) = figure.subplots(2, 2)
        title = f'{run.settings.speed * 30 / math.pi:.0f} rpm, {run.settings.load_torque:g} N m'
        figure.suptitle(title, x=0.012, ha='left', fontsize=13, fontweight='bold')
        _draw_waveform(wave, last, channel)
        _draw_spectrum(lines, run, channel, mesh)
        _draw_portrait(portrait, run, last)
        _draw_section(section, run)
        if file is not None:
            figure.savefig(file, dpi=110)
    return figure


def _draw_waveform(axes: Axes, last: np.ndarray, channel: str) -> None:
    axes.plot(last['t'], last[channel], linewidth=0.9)
    axes.set(title=channel, xlabel='time [s]', ylabel=f'{channel} [{UNITS[channel]}]')
    axes.margins(x=0)
    axes.grid(True)


def _draw_spectrum(axes: Axes, run: Run, channel: str, mesh: float) -> None:
    rate = run.settings.sample_rate
    frequency, amplitude = amplitude_spectrum(run[channel] - run[channel].mean(), rate)
    top = min(rate / 2, (HARMONICS + 1) * mesh) if mesh > 0 else rate / 2
    shown = (frequency > 0) & (frequency <= top)
    for harmonic in range(1, HARMONICS + 1):
        axes.axvline(harmonic * mesh, color=COLOURS[2], linewidth=0.6)
    if amplitude[shown].any():  # a logarithm has no place for a channel that stands still
        axes.set_yscale('log')
    axes.plot(frequency[shown], amplitude[shown], linewidth=0.8)
    axes.set(
        title=f'amplitude; lines: multiples of the mesh frequency, {mesh:.1f} Hz',
        xlabel='frequency [Hz]',
        ylabel=f'{channel} [{UNITS[channel]}]',
        xlim=(0, top),
    )
    axes.grid(True)


def _scaled(run: Run, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return delta in half backlashes, and its rate in those times wn."""
    b = run.pair.half_backlash
    return rows['delta'] / b, rows['delta_dot'] / (b * derive(run.pair).wn)


def _draw_portrait(axes: Axes, run: Run, last: np.ndarray) -> None:
    x, y = _scaled(run, last)
    axes.plot(x, y, linewidth=0.8)
    axes.axvline(1.0, color=INK, linewidth=0.6, linestyle=':')
    axes.set(title='phase portrait; dotted: contact', xlabel='δ / b', ylabel="δ' / (b ωn)")
    axes.grid(True)


def _draw_section(axes: Axes, run: Run) -> None:
    points = run.events[run.events['kind'] == EventKind.SECTION]
    x, y = _scaled(run, points)
    axes.scatter(x, y, s=5, c=np.arange(len(x)), cmap='viridis')
    title = f'Poincaré section, {len(x)} mesh cycles, the latest bright'
    axes.set(title=title, xlabel='δ / b', ylabel="δ' / (b ωn)")
    axes.grid(True)
