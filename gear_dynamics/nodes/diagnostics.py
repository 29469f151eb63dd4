"""Health of a node in /diagnostics at 1 Hz, put together from small tasks."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node

from gear_dynamics.monitoring.level import Level
from gear_dynamics.nodes.topics import publisher
from gear_dynamics.wire.topics import DIAGNOSTICS

PERIOD = 1.0
"""Time between two messages [s]."""


@dataclasses.dataclass(frozen=True)
class Report:
    """What one task has to say: a level, a line, and values by name."""

    level: Level
    message: str
    values: Mapping[str, object]


Task = Callable[[], Report]


class Diagnostics:
    """Publishes the reports of its tasks once a second, and a last time when closed.

    Parameters
    ----------
    node : rclpy.node.Node
        Its name with the namespace begins the name of every status.
    tasks : mapping of str to Task
        Each is called once a message.
    """

    def __init__(self, node: Node, tasks: Mapping[str, Task]) -> None:
        self._node = node
        self._tasks = dict(tasks)
        self._prefix = node.get_fully_qualified_name().lstrip('/')
        self._publisher = publisher(node, DIAGNOSTICS)
        # A timer on ROS time would stall when that clock is set back.
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._timer = node.create_timer(PERIOD, self.publish, clock=clock)

    def publish(self) -> None:
        """Publish one message now."""
        message = DiagnosticArray()
        # Under use_sim_time this clock stands at 0 until /clock comes.
        now = self._node.get_clock().now().nanoseconds or time.time_ns()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(now, 1_000_000_000)
        message.status = [self._status(name, task()) for name, task in self._tasks.items()]
        self._publisher.publish(message)

    def close(self) -> None:
        """Publish the last state and stop."""
        self._timer.cancel()
        self.publish()
        self._publisher.wait_for_all_acked(Duration(seconds=0.5))

    def _status(self, name: str, report: Report) -> DiagnosticStatus:
        return DiagnosticStatus(
            level=bytes([report.level]),
            name=f'{self._prefix}: {name}',
            message=report.message,
            hardware_id=self._prefix,
            values=[KeyValue(key=key, value=_text(value)) for key, value in report.values.items()],
        )


def _text(value: object) -> str:
    return f'{value:.6g}' if isinstance(value, float) else str(value)
