"""Collect the content of a report in one pass over the samples and in bounded memory."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.log import SAMPLES_TOPIC, Log
from gear_dynamics.bag.reader import iter_rows
from gear_dynamics.machine.columns import EventKind
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.signal.spectrum import amplitudes, mean_square_lines, window_samples
from gear_dynamics.signal.statistics import kurtosis, rms
from gear_dynamics.wire.messages import MessageError, deserialize

SEGMENT = 8192
"""Samples in a spectrum: 6.25 Hz a line at the default rate."""

MOST_SEGMENTS = 400
"""Spectra in a waterfall; in a longer log, they are taken further apart."""

MOST_POINTS = 20_000
"""Points of a Poincaré section that are drawn, the last ones of the log."""

INDICATORS = ('rms', 'peak', 'crest_factor', 'kurtosis', 'pinion_fm4', 'gear_fm4')
"""Condition indicators that are drawn, by their names in `gear_pair/condition`."""


@dataclasses.dataclass(frozen=True)
class Segments:
    """Segments of one channel along a log.

    Attributes
    ----------
    t : ndarray
        Middle of each [s].
    speed : ndarray
        Mean pinion speed [rad/s].
    rms, kurtosis : ndarray
        Of the channel without its mean.
    mean_square : ndarray, shape (segments, lines)
        Spectra.
    frequency : ndarray
        Their lines [Hz].
    last_t, last_x : ndarray
        Time [s] and channel of the last segment.
    """

    t: np.ndarray
    speed: np.ndarray
    rms: np.ndarray
    kurtosis: np.ndarray
    mean_square: np.ndarray
    frequency: np.ndarray
    last_t: np.ndarray
    last_x: np.ndarray

    def steady_spectrum(self) -> np.ndarray:
        """Return the amplitude spectrum of all segments that ran at the last one's speed."""
        same = np.isclose(self.speed, self.speed[-1], rtol=2e-3)
        length = len(self.last_x)
        return amplitudes(self.mean_square[same].mean(axis=0), length)


def gather_segments(log: Log, channel: str) -> Segments:
    """Return segments of a channel, evenly spread over the log.

    Raises
    ------
    LogError
        If the log has fewer samples than one segment.
    """
    window = window_samples('hann', SEGMENT)
    parts = []
    last: Any = None
    step = 1.0
    for segment in _segments(log, channel):
        x = segment[channel] - segment[channel].mean()
        step = (segment['t'][-1] - segment['t'][0]) / (SEGMENT - 1)
        parts.append(
            (
                segment['t'].mean(),
                segment['speed'].mean(),
                rms(x),
                kurtosis(x),
                mean_square_lines(segment[channel][:, np.newaxis], window)[:, 0],
            )
        )
        last = segment
    if not parts:
        raise LogError(f'the log has fewer than {SEGMENT} samples in a row: too few for a report')
    t, speed, level, peaked, mean_square = (np.array(column) for column in zip(*parts, strict=True))
    frequency = np.fft.rfftfreq(SEGMENT, step)
    return Segments(
        t, speed, level, peaked, mean_square, frequency, last['t'].copy(), last[channel].copy()
    )


def _segments(log: Log, channel: str) -> Iterator[np.ndarray]:
    """Iterate over segments without a gap, as many as a waterfall can show."""
    apart = max(SEGMENT, _count_samples(log) // MOST_SEGMENTS)
    buffer = np.empty(0)
    skip = 0
    for rows in iter_rows(log, SAMPLES_TOPIC, columns=('t', 'speed', channel)):
        if skip >= len(rows):
            skip -= len(rows)
            continue
        rows, skip = rows[skip:], 0
        if len(buffer) and not _joins(buffer, rows):
            buffer = rows
        else:
            buffer = np.concatenate([buffer, rows]) if len(buffer) else rows
        while len(buffer) >= SEGMENT:
            yield buffer[:SEGMENT]
            skip = max(apart - len(buffer), 0)
            buffer = buffer[apart:]


def _joins(before: np.ndarray, after: np.ndarray) -> bool:
    if len(before) < 2:
        return True
    step = before['t'][1] - before['t'][0]
    return bool(abs(after['t'][0] - before['t'][-1] - step) < step / 2)


def _count_samples(log: Log) -> int:
    """Return the number of samples, if blocks are as long as the first."""
    name = log.resolve(SAMPLES_TOPIC)
    first = next(iter_rows(log, name, columns=('t',)), None)
    if first is None:
        return 0
    return len(first) * sum(
        count.messages for channel, count in log.contents().items() if channel.topic == name
    )


def find_rig(log: Log) -> Rig | None:
    """Return the rig that the log describes, None if it describes none."""
    for text in _configuration_texts(log):
        with contextlib.suppress(ValueError):
            return Rig.from_text(text)
    return None


def _configuration_texts(log: Log) -> Iterator[str]:
    names = [name for name in log.topics() if name.endswith('/gear_pair/configuration')]
    for _, message in log.messages(names) if names else ():
        with contextlib.suppress(MessageError):
            yield deserialize(message.data, message.channel.type_name).data
    for source in log.sources:
        for record in source.configurations():
            yield from record.values()


def gather_section(log: Log, rig: Rig | None) -> np.ndarray:
    """Return points x, y of the Poincaré section [-], from `poincare` or from `events`."""
    with contextlib.suppress(LogError):
        rows = _last_rows(iter_rows(log, 'gear_pair/poincare', columns=('x', 'y')))
        if len(rows):
            return np.column_stack([rows['x'], rows['y']])
    if rig is not None:
        with contextlib.suppress(LogError):
            rows = _last_rows(
                block[block['kind'] == EventKind.SECTION]
                for block in iter_rows(
                    log, 'gear_pair/events', columns=('kind', 'delta', 'delta_dot')
                )
            )
            if len(rows):
                scale = rig.half_backlash
                return np.column_stack(
                    [rows['delta'] / scale, rows['delta_dot'] / (scale * rig.wn)]
                )
    return np.empty((0, 2))


def _last_rows(blocks: Iterator[np.ndarray]) -> np.ndarray:
    kept = np.empty(0)
    for block in blocks:
        kept = np.concatenate([kept, block])[-MOST_POINTS:] if len(kept) else block[-MOST_POINTS:]
    return kept


def gather_indicators(log: Log, channel: str) -> dict[str, np.ndarray]:
    """Return the logged condition indicators of a channel: name to array of t [s] and value."""
    found: dict[str, list[tuple[float, float]]] = {}
    with contextlib.suppress(LogError):
        for rows in iter_rows(log, 'gear_pair/condition', columns=('t', 'name', 'key', 'value')):
            for t, name, key, text in rows.tolist():
                if name.endswith(channel) and key in INDICATORS:
                    with contextlib.suppress(ValueError):
                        value = float(text)
                        found.setdefault(key, []).append((t, value))
    curves = {key: np.array(points) for key, points in found.items()}
    return {key: points[np.isfinite(points[:, 1])] for key, points in curves.items()}
