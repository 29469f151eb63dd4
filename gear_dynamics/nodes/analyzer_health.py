"""What the analyzer says of its stream in /diagnostics."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

from gear_dynamics.monitoring.health import Health
from gear_dynamics.monitoring.level import Level
from gear_dynamics.nodes.diagnostics import Report

BINS = 20
"""Operating bins, those that were seen last for the first time, that are told one by one."""

SILENCE = 2.0
"""Seconds without a block after which the stream is said to be silent."""

BEHIND = 1.0
"""Age of the last analysed block [s] from which the analysis is said to be behind."""


class AnalyzerHealth:
    """Reports what came in since the last report, and how long the analysis took.

    Parameters
    ----------
    health : Health
        The counters of the monitor.

    Attributes
    ----------
    paced : bool
        Whether the stream comes at the pace of a clock. One that comes as fast as its listeners
        take it always waits for them.
    """

    def __init__(self, health: Health) -> None:
        self.paced = True
        self._health = health
        self._seen = (0, 0)
        self._failures = 0
        self._last_block = -float('inf')
        self._slowest = 0.0
        self._busy = 0.0
        self._behind = 0.0

    @contextlib.contextmanager
    def block(self, waited: float) -> Iterator[None]:
        """Time the work on one block, which has waited for some seconds."""
        begin = time.monotonic()
        yield
        self._last_block = time.monotonic()
        taken = self._last_block - begin
        self._behind = waited + taken
        self._slowest = max(self._slowest, taken)
        self._busy += taken

    def condition(self) -> Report:
        """Return what of the stream was judged, what is learned, and which results are missing."""
        health = self._health
        values = {
            'steady [1]': health.steady_share,
            'judged': health.judged,
            **{f'not judged: {reason}': count for reason, count in health.not_judged.items()},
            **{f'failed: {task}': count for task, count in health.failed.items()},
            **{f'starving: {task}': reason for task, reason in health.starving.items()},
            'bins': len(health.bins),
            'bins_learned': sum(health.bins.values()),
            **{
                f'baseline of {bin_}': 'learned' if learned else 'being learned'
                for bin_, learned in list(health.bins.items())[-BINS:]
            },
        }
        failures = health.failed.total()
        new_failures, self._failures = failures - self._failures, failures
        if new_failures:
            return Report(Level.WARN, f'a result is left out: {health.last_failure}', values)
        if health.baseline:
            return Report(Level.WARN, f'baseline: {health.baseline}', values)
        if health.starving:
            missing = ', '.join(f'{task} ({why})' for task, why in health.starving.items())
            return Report(Level.WARN, f'no results of {missing}', values)
        return Report(Level.OK, 'judging steady operation', values)

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
            'behind [s]': self._behind,
        }
        self._slowest = 0.0
        if new_drops:
            return Report(Level.WARN, f'dropped because {health.last_fault}', values)
        if new_gaps:
            return Report(Level.WARN, f'{new_gaps} gaps since the last report', values)
        if time.monotonic() - self._last_block > SILENCE:
            return Report(Level.WARN, 'no samples are coming', values)
        if self.paced and self._behind > BEHIND:
            message = f'the analysis is {self._behind:.3g} s behind the stream'
            return Report(Level.WARN, message, values)
        if not health.configured:
            return Report(Level.WARN, 'samples come, but no configuration of the rig', values)
        return Report(Level.OK, 'analysing', values)
