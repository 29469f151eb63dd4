"""A stretch of the stream without a gap, and all the work that is done on it."""

from __future__ import annotations

import collections
import math
from collections.abc import Iterator

import numpy as np

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.monitoring.angle_task import AngleTask, Orders
from gear_dynamics.monitoring.blocks import channels_of, column_of
from gear_dynamics.monitoring.phase_stream import PhaseStream
from gear_dynamics.monitoring.poincare import (
    poincare_points,
    section_by_contact_loss,
    section_by_phase,
)
from gear_dynamics.monitoring.results import (
    ConditionResult,
    ConditionRow,
    Result,
    Span,
    TableResult,
    columns_table,
    condition_row,
)
from gear_dynamics.monitoring.section_task import Motion, SectionTask
from gear_dynamics.monitoring.spread import Spread
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.monitoring.time_tasks import (
    CHOICE,
    Envelope,
    EnvelopeTask,
    SpectrumTask,
    Statistics,
    StatisticsTask,
)
from gear_dynamics.monitoring.wheel_task import WheelAverage
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.order_tracking import pinion_inertia_share

BATCH = 0.02
"""Seconds of samples that are worked on at once."""

EXACT = 'exact, from events'
INTERPOLATED = (
    'interpolated between samples: delta to (w h)^4 / 384, delta_dot to (w h)^3 / 125 '
    'between changes of contact'
)
"""What the states of a section are; w is the angular frequency of the motion, h the step."""


class Record:
    """Everything computed on blocks that follow each other; another record begins at a gap.

    Parameters
    ----------
    settings : AnalyzerSettings
    rig : Rig
    thresholds : Thresholds
    start_ns : int
        Stamp of the first sample [ns].
    restarts : Counter
        Where work that begins anew within the record is counted, by reason.
    """

    def __init__(
        self,
        settings: AnalyzerSettings,
        rig: Rig,
        thresholds: Thresholds,
        start_ns: int,
        restarts: collections.Counter[str],
    ) -> None:
        self._settings = settings
        self._thresholds = thresholds
        self.start_ns = start_ns
        self._rate = rig.sample_rate
        self._done = 0
        self._waiting: list[np.ndarray] = []
        self._interpolate = False
        share = pinion_inertia_share(
            rig.pinion_inertia, rig.gear_inertia, rig.pinion_teeth, rig.gear_teeth
        )
        self._phase = PhaseStream(rig.pinion_teeth, rig.gear_teeth, share)
        length = max(2, round(settings.statistics_duration * self._rate))
        self._spectrum = SpectrumTask(settings, settings.spectrum_length, len(CHANNELS))
        self._statistics = StatisticsTask(length, rig.half_backlash)
        high = min(settings.envelope_high, self._rate / 2)
        self._envelope = EnvelopeTask(length, self._rate, settings.envelope_low, high)
        self._last: np.ndarray | None = None
        self._restarts = restarts
        self._source = ''
        self._spread = Spread(self._rate)
        self.angle = AngleTask(settings, rig, restarts)
        self.rig = rig

    def use(self, rig: Rig) -> None:
        """Take over scales that changed while the rig runs."""
        self.rig = rig
        self._statistics.use(rig.half_backlash)

    def add_block(self, values: np.ndarray, interpolate: bool) -> list[Result]:
        """Take the next block, as `checked_columns` returns it; return what is complete.

        Blocks are worked on together, BATCH seconds at a time: what a step costs whatever its
        length is then paid less often.

        Parameters
        ----------
        values : ndarray, shape (n, 13)
        interpolate : bool
            Whether the section must come from the samples, for want of events.
        """
        self._waiting.append(values)
        self._interpolate = interpolate
        if sum(map(len, self._waiting)) < BATCH * self._rate:
            return []
        return self.flush()

    def flush(self) -> list[Result]:
        """Work on the blocks that wait; return what is complete."""
        if not self._waiting:
            return []
        values = np.concatenate(self._waiting)
        self._waiting = []
        return self._work_on(values)

    def _work_on(self, values: np.ndarray) -> list[Result]:
        channels = channels_of(values)
        phase = self._phase.push(column_of(values, 'pinion_angle'), column_of(values, 'gear_angle'))
        first, self._done = self._done, self._done + len(values)
        self._spread.add(column_of(values, 'delta'), column_of(values, 'delta_dot'))
        results: list[Result] = []
        for start, count, amplitude in self._spectrum.push(channels):
            frequency = np.fft.rfftfreq(self._spectrum.length, 1 / self._rate)
            results.append(self._table('spectrum', 'frequency', start, count, frequency, amplitude))
        for start, count, statistics in self._statistics.push(channels):
            results.append(self._statistics_rows(self._span(start, count), statistics))
        for start, count, envelope in self._envelope.push(channels):
            results += self._envelope_results(start, count, envelope)
        for outcome in self.angle.push(channels, phase, first, self._phase.gear_lead):
            results.append(self._angle_result(outcome))
        if self._interpolate:
            results += self._interpolated(values, phase, first)
        self._last = np.append(values[-1], phase[-1])
        return results

    def add_section(self, section: np.ndarray, source: str) -> list[Result]:
        """Take states of the section, t [s] from the start of the record; return what they tell."""
        if source != self._source:
            # States of different accuracy are not judged together.
            self._source = source
            self._section = SectionTask(
                self._settings.regime_cycles, self._settings.recurrence_tolerance, self._restarts
            )
        results: list[Result] = []
        for motion in self._section.push(section, self._spread.over):
            span = Span(self.start_ns + round(motion.start * 1e9), motion.end - motion.start)
            results.append(ConditionResult(span, (self._motion_row(motion, source),)))
        self._spread.forget(self._section.start)
        return results

    @property
    def end_ns(self) -> int:
        """Stamp of the first sample that is not yet worked on [ns]."""
        return self.start_ns + round(self._done * 1e9 / self._rate)

    def _span(self, first: float, count: float) -> Span:
        return Span(self.start_ns + round(first * 1e9 / self._rate), count / self._rate)

    def _table(
        self,
        name: str,
        axis: str,
        first: float,
        count: float,
        positions: np.ndarray,
        amplitude: np.ndarray,
    ) -> TableResult:
        rows = columns_table(axis, positions, CHANNELS, amplitude)
        return TableResult(name, self._span(first, count), rows)

    def _statistics_rows(self, span: Span, statistics: Statistics) -> ConditionResult:
        rows = [
            condition_row(
                channel,
                {name: float(value[index]) for name, value in statistics.values.items()},
                self._thresholds,
            )
            for index, channel in enumerate(CHANNELS)
        ]
        contact = statistics.contact
        values = {
            'out_of_contact': contact.out_of_contact,
            'contact_losses_per_second': contact.losses / span.duration,
            'back_impacts_per_second': contact.back_impacts / span.duration,
        }
        rows.append(
            condition_row(
                'contact', values, self._thresholds, {'state': contact.words}, contact.words
            )
        )
        return ConditionResult(span, tuple(rows))

    def _envelope_results(self, first: int, count: int, envelope: Envelope) -> list[Result]:
        rows = []
        for index, (channel, band) in enumerate(zip(CHANNELS, envelope.bands, strict=True)):
            line = int(np.argmax(envelope.amplitude[1:, index])) + 1
            values = {
                'envelope_low': band.low,
                'envelope_high': band.high,
                'envelope_band_kurtosis': band.kurtosis,
                'envelope_frequency': float(envelope.frequency[line]),
                'envelope_amplitude': float(envelope.amplitude[line, index]),
            }
            notes = {}
            if not math.isnan(band.kurtosis):
                choice = min(CHOICE, count) / self._rate
                notes['envelope_band'] = f'chosen on the last {choice:.3g} s of the span'
            rows.append(condition_row(channel, values, self._thresholds, notes))
        table = self._table(
            'envelope_spectrum', 'frequency', first, count, envelope.frequency, envelope.amplitude
        )
        return [table, ConditionResult(table.span, tuple(rows))]

    def _angle_result(self, outcome: Orders | WheelAverage) -> Result:
        count = outcome.last - outcome.first + 1
        if isinstance(outcome, Orders):
            return self._table(
                'order_spectrum', 'order', outcome.first, count, outcome.order, outcome.amplitude
            )
        rows = tuple(self._wheel_row(outcome, index) for index in range(len(CHANNELS)))
        return ConditionResult(self._span(outcome.first, count), rows)

    def _wheel_row(self, average: WheelAverage, index: int) -> ConditionRow:
        wheel = average.wheel
        values = {f'{wheel}_{name}': float(v[index]) for name, v in average.values.items()}
        notes = {'revolutions': f'{average.revolutions} of the {wheel}'}
        if average.leakage:
            decibel = 20 * math.log10(average.leakage)
            notes['other_wheel'] = (
                f'shorter than the hunting-tooth period: up to {decibel:.0f} dB of it are left'
            )
        if average.notes[index]:
            notes['not_a_number'] = average.notes[index]
        message = average.notes[index] or 'within its limits'
        return condition_row(CHANNELS[index], values, self._thresholds, notes, message)

    def _motion_row(self, motion: Motion, source: str) -> ConditionRow:
        values = {'mesh_frequency': motion.cycle_rate}
        notes = {'regime': motion.words, 'section': source}
        found = motion.regime
        if found is not None:
            values |= {
                'period': float(found.period),
                'recurrence': found.recurrence,
                'zero_one_k': found.zero_one,
            }
            if found.lyapunov is not None:
                values['lyapunov'] = found.lyapunov.exponent
                values['lyapunov_uncertainty'] = found.lyapunov.uncertainty
        return condition_row('motion', values, self._thresholds, notes, motion.words)

    def _interpolated(self, values: np.ndarray, phase: np.ndarray, first: int) -> Iterator[Result]:
        """Take the section from this block and the last sample of the one before."""
        rows = np.column_stack([values, phase])
        numbers = np.arange(first, first + len(values))
        if self._last is not None:
            rows = np.concatenate([self._last[np.newaxis], rows])
            numbers = np.append(first - 1, numbers)
        if len(rows) < 2 or not np.all(np.diff(rows[:, -1]) > 0):
            return
        arguments = (
            numbers / self._rate,
            rows[:, -1],
            column_of(rows, 'delta'),
            column_of(rows, 'delta_dot'),
        )
        section = section_by_phase(*arguments, self.rig.section_phase)
        points = section
        if self._settings.section == 'contact_loss':
            points = section_by_contact_loss(*arguments, self.rig.half_backlash)
        if len(points):
            table = poincare_points(points, self.rig.half_backlash, self.rig.wn)
            yield TableResult('poincare', self._span(first, len(values)), table)
        yield from self.add_section(section, INTERPOLATED)
