"""What all spans of a recording show together: mean spectra, sidebands, bearings."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from scipy import fft

from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring.spans.data import Average, BearingState, Signal, Span, SpanResult
from gear_dynamics.monitoring.spans.gears import sidebands

LONGEST = 1 << 16
"""Most samples in a segment of a spectrum."""

REACH = 3
"""Sidebands on either side of a mesh line."""

TABULATED = 3
"""Mesh harmonics whose sidebands are tabulated."""


class MeanSpectrum:
    """The mean of power spectra of segments under a Hann window."""

    def __init__(self, signal: Signal) -> None:
        self.rate = signal.rate
        self.length = min(len(signal.values), LONGEST)
        self._window = np.hanning(self.length + 1)[:-1]
        self._sum = np.zeros(self.length // 2 + 1)
        self.count = 0

    def add(self, values: np.ndarray) -> None:
        """Take a stretch of samples; segments overlap by half."""
        for first in range(0, len(values) - self.length + 1, max(self.length // 2, 1)):
            segment = values[first : first + self.length]
            lines = fft.rfft((segment - segment.mean()) * self._window)
            self._sum += lines.real**2 + lines.imag**2
            self.count += 1

    @property
    def frequency(self) -> np.ndarray:
        """Of the lines [Hz]."""
        return fft.rfftfreq(self.length, 1 / self.rate)

    @property
    def amplitude(self) -> np.ndarray:
        """Peak amplitudes, so that a sine on a line shows its own."""
        return 2 / self._window.sum() * np.sqrt(self._sum / max(self.count, 1))


@dataclasses.dataclass
class BearingRecord:
    """What the spans say of a bearing in a channel.

    Attributes
    ----------
    named : list of str
        What each span named: a defect, `undecided` or nothing.
    shown : BearingState
        That of the span in which the lines stand out most.
    """

    named: list[str]
    shown: BearingState


class Summary:
    """Collects what the report and the findings need of all spans.

    Parameters
    ----------
    machine : Machine
    """

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.spectra: dict[str, MeanSpectrum] = {}
        self.averages: dict[tuple[str, str], Average] = {}
        self.bearings: dict[tuple[str, str], BearingRecord] = {}
        self.speeds: dict[str, list[float]] = {}
        self.origins: dict[str, str] = {}
        self.notes: dict[str, int] = {}
        self._sidebands: dict[tuple[str, str, str], list[np.ndarray]] = {}
        self.spans = 0

    def add(self, span: Span, result: SpanResult) -> None:
        """Take a span and its result."""
        self.spans += 1
        for note in result.notes:
            self.notes[note] = self.notes.get(note, 0) + 1
        for name, signal in span.channels.items():
            _spectrum(self.spectra, name, signal)
        for name, shaft in result.shafts.items():
            self.origins[name] = shaft.origin
            if shaft.phase is not None:
                self.speeds.setdefault(name, []).append(shaft.phase.speed)
        for key, average in result.averages.items():
            best = self.averages.get(key)
            if best is None or average.revolutions >= best.revolutions:
                self.averages[key] = average
            self._add_sidebands(*key, average)
        for key, state in result.bearings.items():
            record = self.bearings.setdefault(key, BearingRecord([], state))
            record.named.append(state.named)
            if _height(state) > _height(record.shown):
                record.shown = state

    def _add_sidebands(self, channel: str, shaft: str, average: Average) -> None:
        for mesh in self.machine.meshes:
            for wheel in (self.machine.wheel(mesh.driver), self.machine.wheel(mesh.driven)):
                if wheel.shaft == shaft:
                    table = np.array(
                        [sidebands(average, wheel.teeth, k, REACH) for k in range(1, TABULATED + 1)]
                    )
                    self._sidebands.setdefault((channel, mesh.name, wheel.name), []).append(table)

    def sidebands(self) -> dict[tuple[str, str, str], np.ndarray]:
        """Return the RMS over the spans of the amplitudes beside each mesh line.

        Returns
        -------
        dict
            By channel, mesh and wheel: shape (3, 7), a row a mesh harmonic, from 3 sidebands
            below to 3 above, spaced by the speed of the wheel's shaft.
        """
        return {
            key: np.sqrt(np.mean(np.square(tables), axis=0))
            for key, tables in self._sidebands.items()
        }

    def mean_speed(self, shaft: str) -> float:
        """Return the mean speed of a shaft over all spans [revolutions/s], NaN if unknown."""
        speeds = self.speeds.get(shaft)
        return float(np.mean(speeds)) if speeds else math.nan


def _spectrum(spectra: dict[str, MeanSpectrum], name: str, signal: Signal) -> None:
    if len(signal.values) < 16:
        return
    if name not in spectra:
        spectra[name] = MeanSpectrum(signal)
    spectra[name].add(signal.values)


def _height(state: BearingState) -> float:
    levels = [line.level for line in state.lines.values() if not math.isnan(line.level)]
    return max(levels, default=-math.inf)
