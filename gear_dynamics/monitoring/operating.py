"""The operating state: whether speed and load are steady, and the bin that they lie in."""

from __future__ import annotations

import collections
import math
from typing import NamedTuple

from gear_dynamics.monitoring.task import Bin
from gear_dynamics.parameters.settings import AnalyzerSettings

SPEED_STEP = 1.05
"""Ratio of the speeds of neighbouring bins."""

LOAD_STEP = 1.1
"""Ratio of the loads of neighbouring bins."""

LEAST = 1e-3
"""Speed [rad/s] or load below which it counts as zero."""

STICKY = 0.75
"""Widths of a bin from its centre within which the previous bin is kept."""

MOST_STRETCHES = 4096
"""Stretches of one state that are remembered."""

SETTLING = 'the operating state is settling'
SPEED = 'the speed is changing'
LOAD = 'the load is changing'
NO_ROTATION = 'the shaft does not turn forward'


class BatchState(NamedTuple):
    """The operating state of a batch.

    Attributes
    ----------
    reason : str
        Why it is not steady; empty if it is.
    bin : Bin
    speed, load : float
        Means over the batch [rad/s], and in the unit of the load; NaN if unknown.
    """

    reason: str
    bin: Bin
    speed: float
    load: float


class Judgement(NamedTuple):
    """Whether a span may be judged: `reason` is empty if it may; and its operating bin."""

    reason: str
    bin: Bin


class OperatingState:
    """Follows speed and load batch by batch.

    A state is steady if, for the settling time and since, the mean of every batch was within
    `steady_speed` and `steady_load` of the first one's. It outlives gaps in the stream.

    Parameters
    ----------
    settings : AnalyzerSettings
    """

    def __init__(self, settings: AnalyzerSettings) -> None:
        self._speed_limit = settings.steady_speed
        self._load_limit = settings.steady_load
        self._settling = settings.settling_time
        self._largest_load = 0.0
        self._speed = self._load = math.nan
        self._age = 0.0
        self._why = SETTLING
        self._bin: Bin = (0, 0)

    def restart(self) -> None:
        """Begin to settle anew: the stream is another one."""
        self._speed = math.nan

    def push(self, speed: float, load: float, seconds: float) -> BatchState:
        """Take the means of the next batch and its duration [s].

        NaN stands for a speed or load that is not recorded; it never changes.
        """
        if not math.isnan(load):
            self._largest_load = max(self._largest_load, abs(load))
        change = self._change(speed, load)
        if change:
            self._why, self._age = change, 0.0
            self._speed, self._load = speed, load
        else:
            self._age += seconds
        self._bin = self._bin_of(speed, load)
        settled = self._age >= self._settling
        reason = NO_ROTATION if speed <= LEAST else '' if settled else self._why
        return BatchState(reason, self._bin, speed, load)

    def _change(self, speed: float, load: float) -> str:
        if math.isnan(speed) != math.isnan(self._speed) or math.isnan(load) != math.isnan(
            self._load
        ):
            return SETTLING
        if abs(speed - self._speed) > self._speed_limit * abs(self._speed) + LEAST:
            return SPEED
        # A load near zero is compared with the largest one: its own fraction would be noise.
        scale = max(abs(self._load), 0.1 * self._largest_load)
        if abs(load - self._load) > self._load_limit * scale + LEAST:
            return LOAD
        return ''

    def _bin_of(self, speed: float, load: float) -> Bin:
        return (
            _number(speed, SPEED_STEP, self._bin[0]),
            _number(load, LOAD_STEP, self._bin[1]),
        )


def _number(value: float, step: float, previous: int) -> int:
    """Return the bin of a value: 0 for zero or unknown, else counted in steps from LEAST."""
    if math.isnan(value) or abs(value) <= LEAST:
        return 0
    place = math.copysign(math.log(abs(value) / LEAST) / math.log(step) + 1, value)
    return previous if previous and abs(place - previous) <= STICKY else round(place)


def centre(bin_: Bin) -> tuple[float, float]:
    """Return speed and load at the centre of a bin."""
    speed, load = (
        math.copysign(LEAST * step ** (abs(number) - 1), number) if number else 0.0
        for number, step in zip(bin_, (SPEED_STEP, LOAD_STEP), strict=True)
    )
    return speed, load


class History:
    """The states of a record, by sample number, and the judgement of spans by them."""

    def __init__(self) -> None:
        self._stretches: collections.deque[tuple[int, int, BatchState]] = collections.deque(
            maxlen=MOST_STRETCHES
        )

    def add(self, first: int, end: int, state: BatchState) -> None:
        """Take the state of the samples from `first` to before `end`."""
        if self._stretches:
            begin, _, last = self._stretches[-1]
            if (last.reason, last.bin) == (state.reason, state.bin):
                self._stretches[-1] = (begin, end, last)
                return
        self._stretches.append((first, end, state))

    def judge(self, first: float, count: float) -> Judgement:
        """Return whether all of a span was steady, and the bin of most of it."""
        share: collections.Counter[Bin] = collections.Counter()
        reason = ''
        for begin, end, state in reversed(self._stretches):
            overlap = min(end, first + count) - max(begin, first)
            if overlap > 0:
                share[state.bin] += round(overlap)
                # The earliest cause in the span is named: later ones follow from it.
                reason = state.reason or reason
            if begin <= first:
                break
        return Judgement(reason, share.most_common(1)[0][0] if share else (0, 0))
