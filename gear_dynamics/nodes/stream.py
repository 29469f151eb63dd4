"""The full-rate topics of the sim: samples, events and the clock, one message a block."""

from __future__ import annotations

import numpy as np
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import HistoryPolicy

from gear_dynamics.nodes.topics import publisher
from gear_dynamics.simulation.sensor import TACHO, tacho_pulses
from gear_dynamics.wire.messages import message_class, serialize
from gear_dynamics.wire.tables import columns_as_float32, encode_table
from gear_dynamics.wire.topics import CLOCK, EVENTS_TOPIC, FRAME, SAMPLES

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
    tacho : bool
        Whether the samples get a column of tacho pulses.
    """

    def __init__(
        self, node: Node, keep_all: bool, publish_clock: bool, tacho: bool = False
    ) -> None:
        self._tacho = tacho
        self._samples = publisher(node, SAMPLES, keep_all=keep_all)
        self._events = publisher(node, EVENTS_TOPIC, keep_all=keep_all)
        self._clock = publisher(node, CLOCK) if publish_clock else None
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
        if self._tacho:
            rows = _with_tacho(rows, samples)
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
        for each in (self._samples, self._events):
            each.wait_for_all_acked(Duration(seconds=LAST))


def _with_tacho(rows: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Return rows of float32 with the column of pulses behind them."""
    wide = np.empty(len(rows), [*rows.dtype.descr, (TACHO, np.float32)])
    for name in rows.dtype.names or ():
        wide[name] = rows[name]
    wide[TACHO] = tacho_pulses(samples)
    return wide


def try_publish(publisher: Publisher, data: bytes) -> bool:
    """Publish serialized bytes; return whether the middleware took them.

    With a keep-all history, a listener that is too far behind makes the middleware refuse a
    message after a while (100 ms); it may be published again then. Any other failure is raised.
    """
    try:
        publisher.publish(data)
    except Exception as error:  # RCLError is a private class of the extension
        keep_all = publisher.qos_profile.history == HistoryPolicy.KEEP_ALL
        if keep_all and 'cannot publish data' in str(error):
            return False
        raise
    return True


def clock_bytes(stamp_ns: int) -> bytes:
    """Return the bytes of a rosgraph_msgs/Clock."""
    time = message_class('builtin_interfaces/msg/Time')(*divmod(stamp_ns, 1_000_000_000))
    return serialize(message_class(CLOCK.type_name)(time))
