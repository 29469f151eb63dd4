"""Online statistics of every channel over consecutive spans."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from gear_dynamics.monitoring.task import OWN, Batch, Indicator, Row, Task, TaskResult
from gear_dynamics.signal.statistics import Moments

CONSTANT = 'the signal is constant: it has no shape'


class StatisticsTask(Task):
    """Statistics of every channel, summed batch by batch; a span ends with a batch.

    Parameters
    ----------
    length : int
        Samples in a span, at least.
    rate : float
        [Hz]
    channels : sequence of str
    """

    name = 'statistics'
    indicators = (
        Indicator('mean', OWN, 'mean'),
        Indicator('rms', OWN, 'root mean square, the mean included'),
        Indicator('std', OWN, 'standard deviation'),
        Indicator('peak', OWN, 'greatest distance from the mean'),
        Indicator('crest_factor', '', 'peak over standard deviation'),
        Indicator('kurtosis', '', 'fourth moment over variance squared, 3 for noise'),
        Indicator('skewness', '', 'third moment over standard deviation cubed'),
    )

    def __init__(self, length: int, rate: float, channels: Sequence[str]) -> None:
        self._length = length
        self._channels = channels
        self.seconds = length / rate
        self.restart()

    def restart(self) -> None:
        """Begin the span anew."""
        self._moments = Moments()

    def push(self, batch: Batch) -> Iterator[TaskResult]:
        """Take the next samples; yield what is complete."""
        moments = self._moments
        moments.add(batch.channels)
        if moments.count < self._length:
            return
        values = moments.indicators()
        rows = []
        for index, channel in enumerate(self._channels):
            own = {name: float(value[index]) for name, value in values.items()}
            reason = CONSTANT if any(map(math.isnan, own.values())) else ''
            rows.append(Row(channel, own, reason=reason))
        end = batch.first + len(batch.channels)
        yield TaskResult(end - moments.count, moments.count, rows)
        self.restart()
