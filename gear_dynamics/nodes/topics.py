"""Publishers and subscriptions of the topics that `gear_dynamics.wire.topics` lists."""

from __future__ import annotations

import importlib
import inspect
import time
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from gear_dynamics.wire.topics import Qos, Topic

LISTENING_DEPTH = 100
"""Messages that a subscription keeps while its node is busy."""


def ros_type(type_name: str) -> type:
    """Return the message class of a type such as 'std_msgs/msg/String'.

    Raises
    ------
    ImportError, AttributeError
        If this ROS installation does not have it.
    """
    package, kind, message = type_name.split('/')
    return getattr(importlib.import_module(f'{package}.{kind}'), message)


def profile(qos: Qos) -> QoSProfile:
    """Return the profile of ROS."""
    return QoSProfile(
        depth=qos.depth,
        history=getattr(HistoryPolicy, qos.history.upper()),
        reliability=getattr(ReliabilityPolicy, qos.reliability.upper()),
        durability=getattr(DurabilityPolicy, qos.durability.upper()),
    )


def publisher(node: Node, topic: Topic, name: str = '', keep_all: bool = False) -> Publisher:
    """Make a publisher of a topic.

    Parameters
    ----------
    node : rclpy.node.Node
    topic : Topic
    name : str, optional
        Name to publish on, for topics whose listed name stands for several.
    keep_all : bool
        Whether no message may be lost; publishing then waits for slow listeners.
    """
    qos = profile(topic.qos)
    if keep_all:
        qos.history = HistoryPolicy.KEEP_ALL
    return node.create_publisher(ros_type(topic.type_name), name or topic.name, qos)


def listen(
    node: Node, topic: Topic, take: Callable[[Any], None], keep_all: bool = False, raw: bool = True
) -> None:
    """Subscribe to a topic.

    Parameters
    ----------
    node : rclpy.node.Node
    topic : Topic
    take : callable
        Is given each message: its bytes, or the message object unless `raw`.
    keep_all : bool
        Whether no message may be lost; what is kept has a bound in the middleware, with Fast DDS
        5000 messages.
    raw : bool
    """
    qos = profile(topic.qos)
    if keep_all:
        qos.history = HistoryPolicy.KEEP_ALL
    elif topic.qos.durability == 'volatile':
        qos.depth = LISTENING_DEPTH
    node.create_subscription(ros_type(topic.type_name), topic.name, take, qos, raw=raw)


class Timed:
    """Callback of a subscription that also says how long a message has waited.

    The executors of rclpy pass on when a message was sent in two ways: as a second argument, or as
    a pair in place of the first one.

    Parameters
    ----------
    take : callable
        Is given each message and the seconds since it was sent. The least time on the way so far
        is taken off: it is the difference between the clocks of two computers.
    """

    __signature__ = inspect.Signature(
        [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in ('data', 'info')]
    )

    def __init__(self, take: Callable[[Any, float], None]) -> None:
        self._take = take
        self._least: int | None = None

    def __call__(self, *arguments: Any) -> None:
        """Pass on a message."""
        data, info = arguments if len(arguments) == 2 else arguments[0]
        sent, received = info['source_timestamp'], info['received_timestamp']
        on_the_way = received - sent
        self._least = on_the_way if self._least is None else min(self._least, on_the_way)
        self._take(data, max((time.time_ns() - sent - self._least) / 1e9, 0.0))
