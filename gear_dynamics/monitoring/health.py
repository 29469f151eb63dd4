"""Counters of what came in, what was judged, and what is missing."""

from __future__ import annotations

import collections
import dataclasses


class Restarts(collections.Counter[str]):
    """Counts new beginnings by reason, and remembers the last reason."""

    last = ''

    def __setitem__(self, reason: str, count: int) -> None:
        self.last = reason
        super().__setitem__(reason, count)


@dataclasses.dataclass
class Health:
    """Counters of a monitor.

    Attributes
    ----------
    configured : bool
        Whether the rig is known.
    blocks : int
        Blocks analysed.
    waiting : int
        Blocks that were dropped because no configuration had come.
    gaps, missing : int
        Gaps between blocks, and samples missing in them.
    restarts : Restarts
        Times that the analysis, or a part of it, began anew, by reason.
    dropped : Counter
        Messages that were not used, by kind of fault.
    last_fault : str
        The latest reason for which a message was dropped.
    failed : Counter
        Spans that a task has failed on, by task.
    last_failure : str
        The latest of these failures.
    seconds, steady_seconds : float
        Time analysed, and the part of it in which the operating state was steady [s].
    judged : int
        Results of `condition` that were judged.
    not_judged : Counter
        Those that were not, by reason.
    starving : dict of str to str
        Tasks that have long given no result, with the reason.
    bins : dict of str to bool
        Operating bins seen, and whether each is learned.
    baseline : str
        What is wrong with the baseline's file; empty if nothing is.
    """

    configured: bool = False
    blocks: int = 0
    waiting: int = 0
    gaps: int = 0
    missing: int = 0
    restarts: Restarts = dataclasses.field(default_factory=Restarts)
    dropped: collections.Counter[str] = dataclasses.field(default_factory=collections.Counter)
    last_fault: str = ''
    failed: collections.Counter[str] = dataclasses.field(default_factory=collections.Counter)
    last_failure: str = ''
    seconds: float = 0.0
    steady_seconds: float = 0.0
    judged: int = 0
    not_judged: collections.Counter[str] = dataclasses.field(default_factory=collections.Counter)
    starving: dict[str, str] = dataclasses.field(default_factory=dict)
    bins: dict[str, bool] = dataclasses.field(default_factory=dict)
    baseline: str = ''

    def drop(self, kind: str, reason: str) -> None:
        """Count a message that is not used."""
        self.dropped[kind] += 1
        self.last_fault = reason

    def fail(self, task: str, error: Exception) -> None:
        """Count a span that a task has failed on."""
        self.failed[task] += 1
        self.last_failure = f'{task}: {type(error).__name__}: {error}'

    def judge(self, reason: str) -> None:
        """Count a result that was judged, or the reason why it was not."""
        if reason:
            self.not_judged[reason] += 1
        else:
            self.judged += 1

    @property
    def steady_share(self) -> float:
        """Fraction of the time in which the operating state was steady."""
        return self.steady_seconds / self.seconds if self.seconds else 0.0
