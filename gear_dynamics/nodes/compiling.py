"""Compile while starting: said if it takes long, and ended by a signal at once."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator

from rclpy.node import Node

from gear_dynamics.nodes.run import interruptible

LONG = 2.0
"""Time after which it is said what is going on [s]; with a warm cache it does not come to it."""


@contextlib.contextmanager
def compiling(node: Node, what: str) -> Iterator[None]:
    """Announce that `what` is compiled if that takes long.

    Nothing that needs closing may be open yet: SIGINT and SIGTERM end the node at once.
    """
    line = f'compiling {what} for this machine; only a first start takes this long'
    notice = threading.Timer(LONG, node.get_logger().info, [line])
    notice.start()
    try:
        with interruptible():
            yield
    finally:
        notice.cancel()
