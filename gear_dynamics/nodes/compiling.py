"""Compile while starting: said if it takes long, and ended by a signal at once."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from rclpy.node import Node

from gear_dynamics.compiling import announced, interruptible


@contextlib.contextmanager
def compiling(node: Node, what: str) -> Iterator[None]:
    """Announce that `what` is compiled if that takes long.

    Nothing that needs closing may be open yet: SIGINT and SIGTERM end the node at once.
    """
    with announced(what, node.get_logger().info), interruptible():
        yield
