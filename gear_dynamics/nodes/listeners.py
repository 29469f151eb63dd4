"""Waiting for the listeners of a set of publishers."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.node import Node
from rclpy.publisher import Publisher

SETTLED = 1.0
"""Time without a new listener after which all that exist have been found [s]."""


class Listeners:
    """Tells when the listeners that exist are connected.

    Parameters
    ----------
    node : rclpy.node.Node
    publishers : sequence of Publisher
    patience : float
        Time after which it waits no longer [s].
    now : float
        A steady clock's time at the start [s].
    """

    def __init__(
        self, node: Node, publishers: Sequence[Publisher], patience: float, now: float
    ) -> None:
        self._node = node
        self._publishers = publishers
        self._deadline = now + patience
        self._since = now
        self._counts: list[int] = []

    @property
    def connected(self) -> int:
        """Number of listeners that receive what is published now."""
        return sum(each.get_subscription_count() for each in self._publishers)

    def complete(self, now: float) -> bool:
        """Tell whether all listeners that are known of are connected, or patience is over."""
        if now >= self._deadline:
            return True
        counts = [each.get_subscription_count() for each in self._publishers]
        if counts != self._counts:
            self._counts, self._since = counts, now
        if not any(counts) or now - self._since < SETTLED:
            return False
        known = (self._node.count_subscribers(each.topic_name) for each in self._publishers)
        return all(count >= wanted for count, wanted in zip(counts, known, strict=True))
