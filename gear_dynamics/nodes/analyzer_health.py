"""What the analyzer says of its stream in /diagnostics."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

from gear_dynamics.monitoring.health import Health
from gear_dynamics.nodes.diagnostics import Level, Report

SILENCE = 2.0
"""Seconds without a block after which the stream is said to be silent."""


class AnalyzerHealth:
    """Reports what came in since the last report, and how long the analysis took.

    Parameters
    ----------
    health : Health
        The counters of the monitor.
    """

    def __init__(self, health: Health) -> None:
        self._health = health
        self._seen = (0, 0)
        self._last_block = -float('inf')
        self._slowest = 0.0
        self._busy = 0.0

    @contextlib.contextmanager
    def block(self) -> Iterator[None]:
        """Time the work on one block."""
        begin = time.monotonic()
        yield
        self._last_block = time.monotonic()
        taken = self._last_block - begin
        self._slowest = max(self._slowest, taken)
        self._busy += taken

    def stream(self) -> Report:
        """Return the state of the stream."""
        health = self._health
        gaps, drops = health.gaps, health.dropped.total()
        new_gaps, new_drops = gaps - self._seen[0], drops - self._seen[1]
        self._seen = gaps, drops
        values = {
            'configured': str(health.configured).lower(),
            'blocks': health.blocks,
            'blocks_before_configuration': health.waiting,
            'gaps': gaps,
            'missing_samples': health.missing,
            **{f'restarts: {reason}': count for reason, count in health.restarts.items()},
            **{f'dropped: {kind}': count for kind, count in health.dropped.items()},
            'slowest_block [s]': self._slowest,
            'busy [s]': self._busy,
        }
        self._slowest = 0.0
        if new_drops:
            return Report(Level.WARN, f'dropped because {health.last_fault}', values)
        if new_gaps:
            return Report(Level.WARN, f'{new_gaps} gaps since the last report', values)
        if time.monotonic() - self._last_block > SILENCE:
            return Report(Level.WARN, 'no samples are coming', values)
        if not health.configured:
            return Report(Level.WARN, 'samples come, but no configuration of the rig', values)
        return Report(Level.OK, 'analysing', values)
