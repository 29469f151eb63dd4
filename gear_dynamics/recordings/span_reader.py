"""Cuts the signals of a recording into spans, in memory bounded by a span."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np

from gear_dynamics.monitoring.spans.data import Signal, Span
from gear_dynamics.recordings.signals import FoundSignal, Signals

SHORTEST = 0.25
"""Shortest piece of a span, as a share of it, that is analysed where the span is cut."""


class _Stream:
    """Hands out the samples of a signal in order."""

    def __init__(self, blocks: Iterator[np.ndarray], rate: float) -> None:
        self._blocks = blocks
        self._rest = np.empty(0)
        self._taken = 0
        self.rate = rate
        self.ended = False

    def until(self, time: float) -> Signal:
        """Return the samples from where the last ones ended up to a time [s]."""
        wanted = math.inf
        if time < math.inf:
            wanted = max(0, math.ceil(time * self.rate - 1e-6) - self._taken)
        parts, have = [self._rest], len(self._rest)
        while have < wanted and not self.ended:
            block = next(self._blocks, None)
            if block is None:
                self.ended = True
            else:
                parts.append(block)
                have += len(block)
        values = np.concatenate(parts) if len(parts) > 1 else parts[0]
        count = min(len(values), wanted)
        taken, self._rest = values[: int(count)], values[int(count) :]
        start = self._taken / self.rate
        self._taken += len(taken)
        return Signal(taken, self.rate, start)


@dataclasses.dataclass
class Cuts:
    """What was cut out.

    Attributes
    ----------
    invalid : dict of str to int
        Samples that are no finite number, by channel.
    spans : int
        Spans that were cut.
    dropped : float
        Time that was too short between cuts to be analysed [s].
    """

    invalid: dict[str, int] = dataclasses.field(default_factory=dict)
    spans: int = 0
    dropped: float = 0.0

    def words(self) -> list[str]:
        """Return in sentences what was cut out; samples at the end are not worth one."""
        notes = [
            f'{name}: {count} samples are no finite number'
            for name, count in self.invalid.items()
            if count
        ]
        if self.spans:
            notes.append(f'{self.spans} spans are cut where samples or time are missing')
        return notes


def read_spans(signals: Signals, length: float | None, cuts: Cuts) -> Iterator[Span]:
    """Yield spans of equal length, cut where a channel has no number or the time jumps.

    Parameters
    ----------
    signals : Signals
    length : float, optional
        [s]; the whole recording by default.
    cuts : Cuts
        Counts what is left out.
    """
    channels, shafts = signals.open()
    constants = {
        name: next(iter(shafts[name]), np.empty(0))
        for name, found in signals.shafts.items()
        if found.rate == 0
    }
    streams = _streams(channels, signals.channels)
    speeds = _streams(shafts, signals.shafts)
    jumps = signals.gaps()
    number = 0
    while not all(stream.ended for stream in streams.values()):
        start = number * (length or 0.0)
        end = math.inf if length is None else start + length
        window = {name: stream.until(end) for name, stream in streams.items()}
        window = {name: each for name, each in window.items() if len(each.values)}
        if not window:
            break
        known = {name: stream.until(end) for name, stream in speeds.items()}
        known = {name: each for name, each in known.items() if len(each.values)}
        known |= {name: Signal(each, 1.0, start) for name, each in constants.items()}
        covered = max(each.start + len(each.values) / each.rate for each in window.values())
        covered = min(covered, end) if covered - end > -1e-9 else covered
        number += 1
        if length is not None and covered - start < 0.5 * length and number > 1:
            cuts.dropped += covered - start
            continue
        yield from _cut(window, known, start, covered, jumps, cuts)


def _streams(
    blocks: dict[str, Iterator[np.ndarray]], found: dict[str, FoundSignal]
) -> dict[str, _Stream]:
    return {
        name: _Stream(each, found[name].rate)
        for name, each in blocks.items()
        if found[name].rate > 0
    }


def _cut(
    window: dict[str, Signal],
    speeds: dict[str, Signal],
    start: float,
    end: float,
    jumps: list[float],
    cuts: Cuts,
) -> Iterator[Span]:
    """Yield the pieces of a window in which every channel has numbers."""
    holes: list[tuple[float, float]] = [(at, at) for at in jumps if start < at < end]
    usable = {}
    for name, signal in window.items():
        bad = ~np.isfinite(signal.values)
        count = int(np.count_nonzero(bad))
        cuts.invalid[name] = cuts.invalid.get(name, 0) + count
        if count > 0.5 * len(bad):
            continue  # a channel that is mostly missing does not cut the others
        usable[name] = signal
        if count:
            holes += _runs(bad, signal)
    if not holes:
        yield Span(start, end - start, usable, speeds)
        return
    cuts.spans += 1
    least = SHORTEST * (end - start)
    at = start
    for low, high in [*sorted(holes), (end, end)]:
        if low - at >= least:
            parts = {name: _part(signal, at, low) for name, signal in usable.items()}
            known = {
                name: _part(signal, at, low) if len(signal.values) > 1 else signal
                for name, signal in speeds.items()
            }
            yield Span(
                at,
                low - at,
                {name: each for name, each in parts.items() if len(each.values)},
                {name: each for name, each in known.items() if len(each.values)},
            )
        elif low > at:
            cuts.dropped += low - at
        at = max(at, high)


def _runs(bad: np.ndarray, signal: Signal) -> list[tuple[float, float]]:
    """Return the times from and to which samples are no numbers."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], bad.astype(np.int8), [0]])))
    times = signal.start + edges / signal.rate
    return [(float(low), float(high)) for low, high in times.reshape(-1, 2)]


def _part(signal: Signal, start: float, end: float) -> Signal:
    first = max(0, math.ceil((start - signal.start) * signal.rate - 1e-6))
    last = max(first, math.ceil((end - signal.start) * signal.rate - 1e-6))
    return Signal(signal.values[first:last], signal.rate, signal.start + first / signal.rate)
