"""Messages of one block, published evenly over the time that the block takes."""

from __future__ import annotations

import collections
import time
from typing import Any, NamedTuple

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.publisher import Publisher

from gear_dynamics.nodes.pacing import SECOND

TICK = 0.002
"""Time between two looks at what is due [s]."""


class Due(NamedTuple):
    """A message and when it is due, counted from the beginning of its block [ns]."""

    after_ns: float
    publisher: Publisher
    message: Any


class PublishSchedule:
    """Publishes messages when they are due.

    A block completes dozens of messages at once. Published at once they would overflow a listener
    with the usual depth of 10.

    Parameters
    ----------
    node : rclpy.node.Node
    """

    def __init__(self, node: Node) -> None:
        self._waiting: collections.deque[Due] = collections.deque()
        self._begin_ns = 0
        self._timer = node.create_timer(
            TICK, self._publish_due, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        self._timer.cancel()

    def put(self, messages: list[Due]) -> None:
        """Take the messages of the next block; those of the one before go out at once."""
        self.flush()
        if not messages:
            return
        self._waiting.extend(sorted(messages, key=lambda due: due.after_ns))
        self._begin_ns = time.monotonic_ns()
        if self._waiting[-1].after_ns <= 0:
            self.flush()
        else:
            self._timer.reset()

    def flush(self) -> None:
        """Publish whatever waits."""
        self._publish_until(float('inf'))

    def _publish_due(self) -> None:
        self._publish_until(time.monotonic_ns() - self._begin_ns + TICK / 2 * SECOND)

    def _publish_until(self, after_ns: float) -> None:
        while self._waiting and self._waiting[0].after_ns <= after_ns:
            due = self._waiting.popleft()
            due.publisher.publish(due.message)
        if not self._waiting:
            self._timer.cancel()
