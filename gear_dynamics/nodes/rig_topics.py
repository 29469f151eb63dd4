"""The topics of one rig, as they come, into what the live page shows."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from gear_dynamics.nodes.topics import profile, ros_type
from gear_dynamics.parameters.yaml_text import YamlError, parse_yaml
from gear_dynamics.web.live_rig import LiveRig
from gear_dynamics.wire.messages import MessageError, deserialize
from gear_dynamics.wire.tables import TableError, decode_table
from gear_dynamics.wire.topics import (
    CONDITION,
    CONFIGURATION,
    DIAGNOSTICS,
    LABEL,
    SAMPLES,
    TABLES,
    Topic,
)

KEPT = 50
"""Messages that wait while the node is busy; of more the oldest are lost, for the page alone."""


class RigTopics:
    """Subscribe to the topics of a rig and feed a LiveRig.

    Parameters
    ----------
    node : rclpy.node.Node
    namespace : str
        Of the rig; empty for the root.
    rig : LiveRig
    """

    def __init__(self, node: Node, namespace: str, rig: LiveRig) -> None:
        self._node = node
        self._namespace = namespace
        self._rig = rig
        self._rate = 0.0
        self._listen(SAMPLES, self._on_samples)
        self._listen(CONFIGURATION, self._on_configuration)
        self._listen(CONDITION, self._on_condition)
        self._listen(LABEL, self._on_label)
        self._listen(DIAGNOSTICS, self._on_diagnostics)
        for table in TABLES:
            name = table.name.rpartition('/')[2]
            self._listen(table, functools.partial(self._on_table, name))

    def _listen(self, topic: Topic, take: Callable[[bytes], None]) -> None:
        """Subscribe so that a slow page never holds up the publisher."""
        qos = profile(topic.qos)
        if topic.qos.durability == 'volatile':
            qos = QoSProfile(depth=KEPT, reliability=ReliabilityPolicy.BEST_EFFORT)
        name = topic.name if topic.name.startswith('/') else f'{self._namespace}/{topic.name}'
        checked = functools.partial(self._checked, take, name)
        self._node.create_subscription(ros_type(topic.type_name), name, checked, qos, raw=True)

    def _checked(self, take: Callable[[bytes], None], name: str, data: bytes) -> None:
        try:
            take(data)
        except (MessageError, TableError, YamlError) as error:
            self._node.get_logger().warning(f'{name}: {error}', throttle_duration_sec=5.0)

    def _on_samples(self, data: bytes) -> None:
        rows = decode_table(data).rows
        names = rows.dtype.names or ()
        if 't' in names and len(rows) > 1 and rows['t'][-1] > rows['t'][0]:
            self._rate = float((len(rows) - 1) / (rows['t'][-1] - rows['t'][0]))
        if self._rate > 0:
            self._rig.add_block(rows, self._rate)

    def _on_table(self, name: str, data: bytes) -> None:
        self._rig.add_table(name, decode_table(data).rows)

    def _on_configuration(self, data: bytes) -> None:
        content = parse_yaml(deserialize(data, CONFIGURATION.type_name).data)
        if isinstance(content, Mapping):
            self._rig.configure(content)

    def _on_condition(self, data: bytes) -> None:
        for status in deserialize(data, CONDITION.type_name).status:
            subject = status.name.rpartition(': ')[2]
            self._rig.set_condition(subject, status.level, status.message, _values(status))

    def _on_label(self, data: bytes) -> None:
        labels = deserialize(data, LABEL.type_name).status
        self._rig.set_faults([_values(status) for status in labels])

    def _on_diagnostics(self, data: bytes) -> None:
        """Take what the nodes of this rig say of themselves; their names carry its namespace."""
        prefix = f'{self._namespace}/' if self._namespace else '/'
        for status in deserialize(data, DIAGNOSTICS.type_name).status:
            name = f'/{status.name.removeprefix("/")}'
            if name.startswith(prefix) and '/' not in name.removeprefix(prefix).partition(':')[0]:
                self._rig.set_health(
                    name.removeprefix(prefix), status.level, status.message, _values(status)
                )


def _values(status: Any) -> dict[str, Any]:
    return {pair.key: pair.value for pair in status.values}
