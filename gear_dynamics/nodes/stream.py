"""The full-rate topics of the sim: samples, events and the clock, one message a block."""

from __future__ import annotations

import numpy as np
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import HistoryPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2

from gear_dynamics.nodes.publishing import clock_bytes, try_publish
from gear_dynamics.wire.tables import columns_as_float32, encode_table

FRAME = 'line_of_action'

DEPTH = 100
"""Blocks that are kept for a reliable listener that is behind."""

LAST = 0.5
"""Time that listeners have to receive the last block [s]."""


class Stream:
    """Publishes blocks of samples with their events.

    Parameters
    ----------
    node : rclpy.node.Node
    keep_all : bool
        Whether no block may be lost: then `publish` tells when a listener is too far behind.
    publish_clock : bool
        Whether the stamps drive /clock.
    """

    def __init__(self, node: Node, keep_all: bool, publish_clock: bool) -> None:
        history = HistoryPolicy.KEEP_ALL if keep_all else HistoryPolicy.KEEP_LAST
        qos = QoSProfile(history=history, depth=DEPTH)
        self._samples = node.create_publisher(PointCloud2, 'gear_pair/samples', qos)
        self._events = node.create_publisher(PointCloud2, 'gear_pair/events', qos)
        self._clock = node.create_publisher(Clock, '/clock', 10) if publish_clock else None
        self._waiting: list[tuple[Publisher, bytes]] = []

    def put(
        self, samples: np.ndarray, events: np.ndarray, start: float, stamp_ns: int, end_ns: int
    ) -> None:
        """Take a block to publish.

        Parameters
        ----------
        samples : ndarray
            Of dtype SAMPLES.
        events : ndarray
            Of dtype EVENTS.
        start : float
            Time of the first sample in the count of both columns t [s].
        stamp_ns, end_ns : int
            Stamps of the first sample of this block and of the next [ns].
        """
        events = events.copy()
        events['t'] -= start
        rows = columns_as_float32(samples, start)
        self._waiting = [
            (self._samples, encode_table(rows, stamp_ns, FRAME)),
            (self._events, encode_table(events, stamp_ns, FRAME)),
        ]
        if self._clock is not None:
            self._waiting.append((self._clock, clock_bytes(end_ns)))

    def publish(self) -> bool:
        """Publish what was taken; return whether all of it went out.

        What a listener far behind holds up waits for the next call.
        """
        while self._waiting:
            if not try_publish(*self._waiting[0]):
                return False
            del self._waiting[0]
        return True

    def close(self) -> None:
        """Give listeners that live a moment to receive what was published last."""
        for publisher in (self._samples, self._events):
            publisher.wait_for_all_acked(Duration(seconds=LAST))
