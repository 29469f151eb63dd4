"""Online synchronous average of one wheel, with its condition indicators."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gear_dynamics.monitoring.diagnosis import (
    LOCAL,
    ONCE_A_REVOLUTION,
    TEETH_ALIKE,
    local_fault,
    once_per_revolution,
    tooth_level,
)
from gear_dynamics.monitoring.task import OWN, Bin, Condition, Indicator, Learned, Row, TaskResult
from gear_dynamics.signal import indicators
from gear_dynamics.signal.interpolation import ACCURATE_BAND
from gear_dynamics.signal.segments import SegmentBuffer
from gear_dynamics.signal.statistics import rms
from gear_dynamics.signal.synchronous import (
    Parts,
    below_order,
    hunting_revolutions,
    other_wheel_leakage,
    separate,
)

NO_DIFFERENCE = 'no difference signal: its ratios would tell of rounding only'
NO_RESIDUAL = 'no residual signal: its ratios would tell of rounding only'

INDICATORS = (
    Indicator('fm0', '', 'peak-to-peak over the sum of the mesh harmonics'),
    Indicator('fm4', '', 'kurtosis of the difference signal'),
    Indicator('m6a', '', 'sixth moment of the difference signal'),
    Indicator('m8a', '', 'eighth moment of the difference signal'),
    Indicator('na4', '', 'fourth moment of the residual over its learned variance squared'),
    Indicator('nb4', '', 'the same of the envelope about the strongest mesh harmonic'),
    Indicator('energy_ratio', '', 'RMS of the difference over that of the regular signal'),
    Indicator('sideband_index', OWN, 'mean amplitude of the first sidebands'),
    Indicator('sideband_level_factor', '', 'first sidebands over the RMS of the average'),
)
"""Of a wheel and a channel; the wheel's name and an underscore come first."""

TOOTH_LEVEL = 'tooth_level'
"""Name of the learned level of the teeth."""

Harmonics = dict[Bin, np.ndarray]
"""The mesh harmonic that NB4 follows, by operating bin, one number a channel."""


class WheelAverage:
    """Average the revolutions of a wheel over complete hunting-tooth periods, again and again.

    Parameters
    ----------
    wheel : str
        Its name.
    teeth : tuple of two int
        Of this wheel and of the other.
    points : int
        Points in a mesh cycle.
    lead : int
        Complete mesh cycles by which this wheel's angle is ahead of the phase.
    channels : sequence of str
    lengths : tuple of two float
        Samples that a record shall have, in complete hunting-tooth periods, and may have: a period
        that lasts longer is cut to complete revolutions.
    harmonics : Harmonics
        What NB4 knows of this wheel.
    normal : Learned
        What is normal of it.
    """

    def __init__(
        self,
        wheel: str,
        teeth: tuple[int, int],
        points: int,
        lead: int,
        channels: Sequence[str],
        lengths: tuple[float, float],
        harmonics: Harmonics,
        normal: Learned,
    ) -> None:
        self._normal = normal
        self._wheel = wheel
        self._teeth, self._other = teeth
        self._points = self._teeth * points
        self._lead = lead * points
        self._shall, self._may = lengths
        self._channels = channels
        self._harmonics = harmonics
        self.restart()

    def restart(self) -> None:
        """Begin the average anew at the next zero of the wheel's angle."""
        self._segments: SegmentBuffer | None = None
        self._sum = np.zeros((self._points, len(self._channels)))
        self._count = 0
        self._first = 0.0

    def push(self, first: int, rows: np.ndarray, bin_: Bin) -> Iterator[TaskResult]:
        """Take rows at the points `first`, `first` + 1, ...; yield the averages completed.

        The last column of the rows is the sample number, which is not averaged.
        """
        if self._segments is None:
            skipped = -(first + self._lead) % self._points
            if skipped >= len(rows):
                return
            rows = rows[skipped:]
            self._segments = SegmentBuffer(self._points, self._points, rows.shape[1])
        for revolution in self._segments.push(rows):
            if self._count == 0:
                self._first = float(revolution[0, -1])
            self._sum += revolution[:, :-1]
            self._count += 1
            last = float(revolution[-1, -1])
            if self._complete(last):
                yield self._finish(last, bin_)

    def _complete(self, last: float) -> bool:
        taken = last - self._first
        each = taken / self._count
        period = hunting_revolutions(self._teeth, self._other)
        if self._count % period == 0 and taken + each * period > self._shall:
            return True
        return taken + each > self._may

    def _finish(self, last: float, bin_: Bin) -> TaskResult:
        each = (last - self._first) / self._count
        average = below_order(self._sum / self._count, ACCURATE_BAND * each)
        rows = self._rows(average, bin_)
        count = last - self._first + 1
        finding = TaskResult(self._first, count, rows)
        self._sum[:] = 0
        self._count = 0
        return finding

    def _rows(self, average: np.ndarray, bin_: Bin) -> list[Row]:
        notes = {'revolutions': f'{self._count} of the {self._wheel}'}
        leakage = other_wheel_leakage(self._count, self._teeth, self._other)
        if leakage:
            notes['other_wheel'] = (
                'shorter than the hunting-tooth period: up to '
                f'{20 * math.log10(leakage):.0f} dB of it are left'
            )
        parts = separate(average, self._teeth)
        residual = rms(parts.residual) >= indicators.NOTHING * rms(parts.regular)
        difference = indicators.has_difference(parts)
        values = self._values(average, parts, difference)
        references, over = self._references(average, parts, residual, bin_)
        rows = []
        for index, channel in enumerate(self._channels):
            reason = '' if difference[index] else NO_DIFFERENCE
            rows.append(
                Row(
                    channel,
                    {f'{self._wheel}_{name}': float(v[index]) for name, v in values.items()},
                    notes,
                    reason=reason if residual[index] else NO_RESIDUAL,
                    references={name: float(v[index]) for name, v in references.items()},
                    over_reference={
                        name: (float(v[index]), reference) for name, (v, reference) in over.items()
                    },
                )
            )
        rows.append(self._fault(parts, difference, notes, bin_))
        return rows

    def _fault(self, parts: Parts, there: np.ndarray, notes: dict[str, str], bin_: Bin) -> Row:
        fault = local_fault(parts, self._teeth, there, self._learned(TOOTH_LEVEL, bin_))
        once = once_per_revolution(parts, self._teeth)
        values = {
            'local_fault': fault.sure,
            'tooth': float(fault.tooth),
            'once_per_revolution': once,
        }
        conditions = [
            Condition('local_fault', LOCAL, fault.sure, fault.tooth, self._teeth),
            Condition('once_per_revolution', ONCE_A_REVOLUTION),
        ]
        return Row(self._wheel, values, notes, TEETH_ALIKE, conditions=conditions)

    def _learned(self, name: str, bin_: Bin) -> np.ndarray:
        """Return what was learned of this wheel by channel; NaN where it is not known."""
        learned = [
            self._normal(bin_, f'{channel}/{self._wheel}_{name}') for channel in self._channels
        ]
        return np.array([math.nan if each is None else each.mean for each in learned])

    def _values(
        self, average: np.ndarray, parts: Parts, there: np.ndarray
    ) -> dict[str, np.ndarray]:
        teeth = self._teeth
        of_difference = {
            'fm4': indicators.fm4(parts.difference),
            'm6a': indicators.m6a(parts.difference),
            'm8a': indicators.m8a(parts.difference),
            'energy_ratio': indicators.energy_ratio(parts),
        }
        return {
            'fm0': indicators.fm0(average, teeth),
            **{name: np.where(there, value, math.nan) for name, value in of_difference.items()},
            'sideband_index': indicators.sideband_index(average, teeth),
            'sideband_level_factor': indicators.sideband_level_factor(average, teeth),
        }

    def _references(
        self, average: np.ndarray, parts: Parts, residual: np.ndarray, bin_: Bin
    ) -> tuple[dict[str, np.ndarray], dict[str, tuple[np.ndarray, str]]]:
        """Return the variances that NA4 and NB4 are over, and their fourth moments."""
        harmonic = self._harmonics.get(bin_)
        if harmonic is None:
            harmonic = indicators.strongest_harmonic(average, self._teeth)
            self._harmonics[bin_] = harmonic
        envelope = indicators.mesh_envelope(average, self._teeth, harmonic)
        modulated = np.std(envelope, axis=0) >= indicators.NOTHING * np.mean(envelope, axis=0)
        level = tooth_level(parts, self._teeth)
        references = {f'{self._wheel}_{TOOTH_LEVEL}': np.where(residual, level, math.nan)}
        over = {}
        for name, signal, there in (
            ('na4', parts.residual, residual),
            ('nb4', envelope, modulated),
        ):
            reference = f'{self._wheel}_{name}_variance'
            references[reference] = np.where(there, np.var(signal, axis=0), math.nan)
            moment = indicators.variance_ratio_kurtosis(signal, np.ones(signal.shape[1]))
            over[f'{self._wheel}_{name}'] = (np.where(there, moment, math.nan), reference)
        return references, over
