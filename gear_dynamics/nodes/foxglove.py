"""The `foxglove` node: the topics of a rig, live in the Foxglove app.

Bytes are passed on as they are. A topic is subscribed to only while somebody looks at it.
"""

from __future__ import annotations

import queue
import sys
from collections.abc import Callable, Sequence
from typing import Any

import foxglove
from foxglove.websocket import ChannelView, Client, ServerListener
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.run import NodeError, run_node
from gear_dynamics.nodes.topics import profile, ros_type
from gear_dynamics.parameters.settings import FoxgloveSettings
from gear_dynamics.wire.messages import message_type
from gear_dynamics.wire.topics import INDICATOR, TOPICS, Topic

ABOUT = 'Shows the topics of a rig in the Foxglove app.'

TURN = 0.02
"""Time after which a look at a topic is answered, at most [s]."""

KEPT = 50
"""Messages that wait while the node is busy; of more the oldest are lost, for the app alone."""


class Listener(ServerListener):
    """Hands the looks of clients over from the server's thread to the node's."""

    def __init__(self) -> None:
        self.looks: queue.SimpleQueue[tuple[str, int]] = queue.SimpleQueue()

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Note that a client looks at a topic."""
        self.looks.put((channel.topic, 1))

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:
        """Note that a client looks no more."""
        self.looks.put((channel.topic, -1))


class Bridge:
    """Serve the topics of this node's namespace."""

    def __init__(self, node: Node, parameters: NodeParameters) -> None:
        self._node = node
        settings = parameters.get(FoxgloveSettings)
        self._listener = Listener()
        self._context = foxglove.Context()
        self._server = self._start(settings)
        topics = [topic for topic in TOPICS if topic is not INDICATOR]
        self._bridged = {
            bridged.name: bridged
            for bridged in (BridgedTopic(node, topic, self._context) for topic in topics)
        }
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(TURN, self._answer, clock=steady)
        node.get_logger().info(
            f'Foxglove: open the connection ws://{settings.address}:{self._server.port}'
        )

    def close(self) -> None:
        """Let the clients go."""
        self._server.stop()

    def _start(self, settings: FoxgloveSettings) -> Any:
        try:
            return foxglove.start_server(
                name='gear_dynamics',
                host=settings.address,
                port=settings.port,
                server_listener=self._listener,
                context=self._context,
            )
        except (OSError, RuntimeError) as error:
            raise NodeError(
                f'cannot listen on {settings.address} port {settings.port}: {error}; '
                'take another port, or port 0 for a free one'
            ) from None

    def _answer(self) -> None:
        while not self._listener.looks.empty():
            name, change = self._listener.looks.get()
            self._bridged[name].look(change)


class BridgedTopic:
    """Pass a topic on while it is looked at.

    A topic that is kept for late listeners is always subscribed to, and its last message goes out
    again whenever another client begins to look.
    """

    def __init__(self, node: Node, topic: Topic, context: Any) -> None:
        self._node = node
        self._topic = topic
        self.name = node.resolve_topic_name(topic.name)
        definition = message_type(topic.type_name).definition
        schema = foxglove.Schema(name=topic.type_name, encoding='ros2msg', data=definition.encode())
        self._channel = foxglove.Channel(
            self.name, schema=schema, message_encoding='cdr', context=context
        )
        self._clients = 0
        self._last = b''
        self._subscription: Any = None
        self._latched = topic.qos.durability != 'volatile'
        if self._latched:
            self._subscribe(self._keep)

    def look(self, change: int) -> None:
        """Take one more client (1), or one less (-1)."""
        self._clients += change
        if self._latched:
            if change > 0 and self._last:
                self._channel.log(self._last)
        elif self._clients > 0 and self._subscription is None:
            self._subscribe(self._channel.log)
        elif self._clients == 0 and self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    def _keep(self, data: bytes) -> None:
        self._last = data
        self._channel.log(data)

    def _subscribe(self, take: Callable[[bytes], None]) -> None:
        """Subscribe so that a slow client never holds up the publisher."""
        qos = profile(self._topic.qos)
        if not self._latched:
            qos = QoSProfile(depth=KEPT, reliability=ReliabilityPolicy.BEST_EFFORT)
        kind = ros_type(self._topic.type_name)
        self._subscription = self._node.create_subscription(kind, self.name, take, qos, raw=True)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the node until it is told to stop; return the exit code."""
    return run_node('gear_foxglove', ABOUT, (FoxgloveSettings,), Bridge, argv)


if __name__ == '__main__':
    sys.exit(main())
