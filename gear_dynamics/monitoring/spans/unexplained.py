"""Strong lines that no shaft, mesh or bearing of the machine explains."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import ndimage

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import DEFECTS
from gear_dynamics.monitoring.spans.summary import MeanSpectrum, Summary

LEAST_HEIGHT = 20.0
"""Least height of a line over its surroundings [dB]."""

MOST_LINES = 12


class Line(NamedTuple):
    """A line: frequency [Hz], peak amplitude, and height over its surroundings [dB]."""

    frequency: float
    amplitude: float
    height: float


def unexplained_lines(summary: Summary, channel: str) -> list[Line]:
    """Return the strongest lines of a channel that nothing of the machine explains.

    Known are all orders of a shaft up to 20, mesh lines with 5 sidebands of both shafts on either
    side, bearing lines with 2 sidebands, and all lines of a defect that was named with 3.
    """
    spectrum = summary.spectra.get(channel)
    if spectrum is None or spectrum.count == 0:
        return []
    known = _known_frequencies(summary)
    tolerance = 2.5 * spectrum.frequency[1]
    found = []
    for line in strong_lines(spectrum):
        # Speeds wander a little, and so do lines of a high order.
        near = tolerance + 3e-4 * line.frequency
        if not len(known) or np.min(np.abs(known - line.frequency)) > near:
            found.append(line)
    found.sort(key=lambda line: -line.amplitude)
    return found[:MOST_LINES]


def strong_lines(spectrum: MeanSpectrum) -> list[Line]:
    """Return all maxima at least 20 dB above the median of their surroundings."""
    amplitude = spectrum.amplitude
    floor = np.maximum(ndimage.median_filter(amplitude, 101, mode='nearest'), 1e-300)
    height = 20 * np.log10(np.maximum(amplitude, 1e-300) / floor)
    inner = slice(3, -1)
    top = (amplitude[inner] >= amplitude[2:-2]) & (amplitude[inner] > amplitude[4:])
    places = np.flatnonzero(top & (height[inner] >= LEAST_HEIGHT)) + 3
    return [
        Line(float(spectrum.frequency[k]), float(amplitude[k]), float(height[k])) for k in places
    ]


def _known_frequencies(summary: Summary) -> np.ndarray:
    machine: Machine = summary.machine
    known = []
    speeds = {shaft.name: summary.mean_speed(shaft.name) for shaft in machine.shafts}
    for speed in speeds.values():
        known.append(speed * np.arange(1, 21))
    for mesh in machine.meshes:
        driver, driven = machine.wheel(mesh.driver), machine.wheel(mesh.driven)
        mesh_lines = driver.teeth * speeds[driver.shaft] * np.arange(1, 200)
        for wheel in (driver, driven):
            side = speeds[wheel.shaft] * np.arange(-5, 6)
            known.append((mesh_lines[:, np.newaxis] + side).ravel())
    for bearing in machine.bearings:
        speed = speeds[bearing.shaft]
        for order in bearing.orders.values():
            lines = order * np.arange(1, 11)[:, np.newaxis]
            known.append(((lines + np.arange(-2, 3)) * speed).ravel())
        for (_, name), record in summary.bearings.items():
            if name == bearing.name and record.shown.named in DEFECTS:
                # A fault rings at resonances, with its lines and sidebands far up.
                order = record.shown.lines[record.shown.named].order
                lines = order * np.arange(1, 200)[:, np.newaxis]
                known.append(((lines + np.arange(-3, 4)) * speed).ravel())
    joined = np.concatenate(known) if known else np.empty(0)
    return joined[np.isfinite(joined)]
