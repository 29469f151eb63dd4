"""The figures of the report, as PNG images."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from gear_dynamics.figure_style import COLOURS, FAINT, STYLE
from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import DEFECTS
from gear_dynamics.monitoring.spans.bearings import LEAST_LEVEL
from gear_dynamics.monitoring.spans.data import Average
from gear_dynamics.monitoring.spans.summary import BearingRecord, MeanSpectrum, Summary

WIDTH, HEIGHT, DPI = 9.0, 2.6, 110
POINTS = 4000


def image(draw: Callable[[Any], None], height: float = HEIGHT) -> str:
    """Return a figure of one pair of axes as the address of an image within the page."""
    with mpl.rc_context(STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(WIDTH, height), dpi=DPI, layout='constrained')
        axes = figure.add_subplot()
        axes.grid(True)
        draw(axes)
        stream = io.BytesIO()
        figure.savefig(stream, format='png')
    return 'data:image/png;base64,' + base64.b64encode(stream.getvalue()).decode('ascii')


def spectrum_image(spectrum: MeanSpectrum, channel: str, unit: str, summary: Summary) -> str:
    """Return the mean amplitude spectrum of a channel, its mesh lines marked."""

    def draw(axes: Any) -> None:
        frequency, amplitude = _thinned(spectrum.frequency[1:], spectrum.amplitude[1:])
        axes.plot(frequency, np.maximum(amplitude, amplitude.max() * 1e-6), lw=0.7)
        if amplitude.max() > 0:
            axes.set_yscale('log')
        for mesh, line in _mesh_frequencies(summary):
            for harmonic in range(1, 6):
                if harmonic * line < frequency[-1]:
                    axes.axvline(harmonic * line, color=COLOURS[1], lw=0.6, alpha=0.6)
            if line < frequency[-1]:
                axes.annotate(
                    f' {mesh}', (line, 0.95), xycoords=('data', 'axes fraction'), va='top'
                )
        axes.set(
            xlim=(0, frequency[-1]),
            xlabel='frequency [Hz]',
            ylabel=f'peak amplitude [{unit}]',
            title=f'{channel}: spectrum, mean of {spectrum.count} segments of '
            f'{spectrum.length / spectrum.rate:.3g} s',
        )

    return image(draw)


def _mesh_frequencies(summary: Summary) -> Iterator[tuple[str, float]]:
    machine = summary.machine
    for mesh in machine.meshes:
        wheel = machine.wheel(mesh.driver)
        line = wheel.teeth * summary.mean_speed(wheel.shaft)
        if not math.isnan(line):
            yield mesh.name, line


def order_image(average: Average, channel: str, shaft: str, unit: str, machine: Machine) -> str:
    """Return the lines of a synchronous average by order, mesh lines and sidebands coloured."""

    def draw(axes: Any) -> None:
        lines = 2 / len(average.values) * np.abs(np.fft.rfft(average.values))
        teeth = [wheel.teeth for wheel in machine.wheels if wheel.shaft == shaft]
        last = int(min(average.highest_order, len(lines) - 1, 5.5 * max(teeth, default=20)))
        orders = np.arange(1, last + 1)
        floor = 1e-4 * lines[1 : last + 1].max()
        axes.vlines(orders, floor, lines[1 : last + 1], color=FAINT, lw=1.2, label='other orders')
        for index, wheel in enumerate(w for w in machine.wheels if w.shaft == shaft):
            colour = COLOURS[index % len(COLOURS)]
            distance = np.abs(orders - wheel.teeth * np.maximum(np.round(orders / wheel.teeth), 1))
            side = (distance > 0) & (distance <= 3)
            axes.vlines(
                orders[side], floor, lines[orders[side]], color=colour, lw=1.2, alpha=0.5,
                label=f'sidebands of {wheel.name}',
            )  # fmt: skip
            mesh = distance == 0
            axes.vlines(
                orders[mesh], floor, lines[orders[mesh]], color=colour, lw=2.0,
                label=f'mesh lines of {wheel.name}',
            )  # fmt: skip
        axes.legend(loc='upper right')
        axes.set(
            xlim=(0, last + 1),
            ylim=(floor, None),
            yscale='log' if floor > 0 else 'linear',
            xlabel=f'order of shaft {shaft} [1/rev]',
            ylabel=f'peak amplitude [{unit}]',
            title=f'{channel}: orders of {shaft}, average of {average.revolutions} revolutions',
        )

    return image(draw)


def average_image(average: Average, channel: str, shaft: str, unit: str) -> str:
    """Return the synchronous average over one revolution."""

    def draw(axes: Any) -> None:
        count = len(average.values)
        axes.plot(np.arange(count) / count, average.values, lw=0.7)
        axes.set(
            xlim=(0, 1),
            xlabel=f'revolution of shaft {shaft} (from its first one in the span)',
            ylabel=f'[{unit}]',
            title=f'{channel}: average of {average.revolutions} revolutions of {shaft}, '
            f'{average.share:.0%} of the variance is synchronous',
        )

    return image(draw)


def envelope_image(record: BearingRecord, channel: str, bearing: str, unit: str) -> str:
    """Return the squared envelope spectrum with the lines of the defects."""

    def draw(axes: Any) -> None:
        spectrum = record.shown.spectrum
        order, amplitude = _thinned(spectrum.order[1:], spectrum.amplitude[1:])
        axes.plot(order, amplitude, lw=0.7, color='#22303c')
        for index, defect in enumerate(DEFECTS):
            line = record.shown.lines.get(defect)
            if line is None or math.isnan(line.level):
                continue
            for harmonic in (1, 2, 3):
                axes.axvline(
                    harmonic * line.order, color=COLOURS[index], lw=1.0,
                    alpha=0.8 if line.level >= LEAST_LEVEL else 0.25,
                    label=f'{defect} {line.order:.3f}: {line.level:.1f} dB'
                    if harmonic == 1 else None,
                )  # fmt: skip
        axes.legend(loc='upper right')
        low, high = record.shown.band
        axes.set(
            xlim=(0, order[-1]),
            ylim=(0, None),
            xlabel='order of the shaft [1/rev]',
            ylabel=f'amplitude [({unit})$^2$]',
            title=f'{channel}: squared envelope of {low:.0f} to {high:.0f} Hz for bearing '
            f'{bearing}, the span in which lines stand out most',
        )

    return image(draw)


def trend_image(
    time: Sequence[float], columns: Mapping[str, Sequence[float]], unit: str, title: str
) -> str:
    """Return indicators of the same unit over time."""

    def draw(axes: Any) -> None:
        scale, name = _time_unit(max(time))
        for label, values in columns.items():
            axes.plot(np.asarray(time) / scale, values, marker='.', ms=3, lw=0.8, label=label)
        axes.legend(loc='upper left')
        axes.set(xlabel=f'time [{name}]', ylabel=f'[{unit}]', title=title)

    return image(draw)


def _time_unit(longest: float) -> tuple[float, str]:
    for scale, name in ((86400.0, 'days'), (3600.0, 'h')):
        if longest > 3 * scale:
            return scale, name
    return 1.0, 's'


def _thinned(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return few enough points for a figure, each the maximum of those around it."""
    group = math.ceil(len(x) / POINTS)
    count = len(x) // group
    if group == 1 or count == 0:
        return x, y
    cut = count * group
    return x[:cut:group], y[:cut].reshape(count, group).max(axis=1)
