"""Plays the messages of a log with the recorded spacing; no ROS, so that any sink will do."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable, Iterable, Iterator

from gear_dynamics.nodes.playlist import Item

SECOND = 1e9
"""Nanoseconds in a second."""

AHEAD = 256
"""Messages read ahead of their time, so that unpacking a chunk does not delay one."""

LATE = 1.0
"""Lateness after which time begins anew [s]: the machine stood still."""


class Player:
    """A thread that hands each message to a sink when it is due.

    Parameters
    ----------
    items : iterable of Item
        In the order of their due times.
    sink : callable
        Takes an item; returns False if it cannot yet, to be asked again at once.
    rate : float
        Speed of playing, 1 as recorded; 0 as fast as the sink allows.
    paused : bool
        Whether to begin paused.
    """

    def __init__(
        self,
        items: Iterable[Item],
        sink: Callable[[Item], bool],
        rate: float,
        paused: bool,
    ) -> None:
        self._sink = sink
        self._rate = rate
        self._changed = threading.Condition()
        self._paused = paused
        self._steps = 0
        self._stopped = False
        # The due time `_position` [ns] was at `_wall`; while paused, so long before the resume.
        self._position: int | None = None
        self._wall = 0.0
        self.finished = False
        """Whether all is played."""
        self.error: Exception | None = None
        """What ended the playing before its time."""
        self._ahead = _ReadAhead(items)
        self._thread = threading.Thread(target=self._run, name='player')
        self._thread.start()

    @property
    def paused(self) -> bool:
        """Whether it waits to be resumed or stepped."""
        return self._paused

    def pause(self, paused: bool) -> None:
        """Pause or resume; time does not run while it is paused."""
        with self._changed:
            if paused != self._paused:
                self._wall += -time.monotonic() if paused else time.monotonic()
            self._paused = paused
            self._changed.notify()

    def step(self) -> None:
        """Play one message at once, and go on from there."""
        with self._changed:
            self._steps += 1
            self._changed.notify()

    def stop(self) -> None:
        """Stop for good and wait for the thread."""
        with self._changed:
            self._stopped = True
            self._changed.notify()
        self._ahead.stop()
        self._thread.join()

    def _run(self) -> None:
        try:
            for item in self._ahead.items():
                if not self._wait_until_due(item.due_ns) or not self._give(item):
                    return
            self.finished = not self._stopped
        except Exception as error:  # told by the node: a thread that dies tells nobody
            self.error = error

    def _give(self, item: Item) -> bool:
        while not self._stopped:
            if self._sink(item):
                return True
        return False

    def _wait_until_due(self, due_ns: int) -> bool:
        """Wait for a message's time; return whether it is to be played at all."""
        with self._changed:
            while not self._stopped:
                now = 0.0 if self._paused else time.monotonic()
                if self._steps:
                    self._steps -= 1
                    self._position, self._wall = due_ns, now
                    return True
                if self._paused:
                    self._changed.wait()
                    continue
                due = self._due(due_ns, now)
                if due <= now:
                    # Counted from the due time, so that lateness does not add up.
                    self._position, self._wall = due_ns, due if now - due < LATE else now
                    return True
                self._changed.wait(due - now)
            return False

    def _due(self, due_ns: int, now: float) -> float:
        if self._position is None or self._rate == 0:
            return now
        return self._wall + (due_ns - self._position) / SECOND / self._rate


class _ReadAhead:
    """A thread that reads messages into a bounded queue."""

    def __init__(self, items: Iterable[Item]) -> None:
        self._items = items
        self._queue: queue.Queue[Item | Exception | None] = queue.Queue(AHEAD)
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name='read ahead')
        self._thread.start()

    def items(self) -> Iterator[Item]:
        """Iterate over the items; raises what reading them raised."""
        while (item := self._queue.get()) is not None:
            if isinstance(item, Exception):
                raise item
            yield item

    def stop(self) -> None:
        """Stop reading, whatever is left."""
        self._stopped = True
        while self._thread.is_alive():
            self._drop()
            self._thread.join(0.01)
        self._drop()
        self._queue.put(None)  # for a reader that waits

    def _drop(self) -> None:
        with contextlib.suppress(queue.Empty):
            while True:
                self._queue.get_nowait()

    def _run(self) -> None:
        end: Exception | None = None
        try:
            for item in self._items:
                if self._stopped:
                    return
                self._queue.put(item)
        except Exception as error:
            end = error
        self._queue.put(end)
