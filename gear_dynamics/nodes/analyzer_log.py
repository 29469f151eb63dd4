"""The analyzer's log: which topics go to MCAP, and how the log is doing."""

from __future__ import annotations

import time
from pathlib import Path

import yaml
from rclpy.node import Node

from gear_dynamics.bag.metadata import OfferedQos
from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.nodes.diagnostics import Level, Report
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.versions import versions

TABLE = 'sensor_msgs/msg/PointCloud2'
CONDITION = 'diagnostic_msgs/msg/DiagnosticArray'
TEXT = 'std_msgs/msg/String'
NUMBER = 'std_msgs/msg/Float64'

STREAM = OfferedQos(depth=100)
LATCHED = OfferedQos(depth=1, durability='transient_local')
PLAIN = OfferedQos()

SLOW_SYNC = 1.0
"""Time that a disk may take to sync [s]; a power cut would lose as much."""


class AnalyzerLog:
    """Hands message bytes to the log writer, if there is to be a log.

    Parameters
    ----------
    node : rclpy.node.Node
    settings : AnalyzerSettings
    limits : str
        Content of the file of alarm limits.
    """

    def __init__(self, node: Node, settings: AnalyzerSettings, limits: str) -> None:
        self._node = node
        self._names: dict[str, str] = {}
        self._overflows = 0
        self._configuration = {
            'analyzer': _analysis_text(settings),
            'thresholds': limits,
            'versions': yaml.safe_dump(versions(), sort_keys=False),
        }
        self._writer = None
        if settings.log:
            self._writer = LogWriter(
                Path(settings.log_directory).expanduser(),
                self._configuration,
                settings.log_compression,
                settings.log_split_size,
                settings.log_split_duration,
                settings.log_total_cap,
                settings.log_free_floor,
            )
            status = self._writer.status()
            if status.reason:
                node.get_logger().error(f'not logging; see log_directory: {status.reason}')
            else:
                node.get_logger().info(f'logging to {status.path}')

    def write(
        self,
        topic: str,
        type_name: str,
        data: bytes,
        publish_time: int | None = None,
        qos: OfferedQos = PLAIN,
    ) -> None:
        """Log a message as it came or went; `publish_time` [ns] is now by default."""
        if self._writer is None:
            return
        name = self._names.get(topic)
        if name is None:
            name = self._names[topic] = self._node.resolve_topic_name(topic)
        now = time.time_ns()
        self._writer.write(
            name, type_name, data, now, now if publish_time is None else publish_time, qos
        )

    def configure(self, text: str) -> None:
        """Note the rig's configuration in the log's metadata."""
        if self._writer is not None:
            self._configuration['configuration'] = text
            self._writer.configure(self._configuration)

    def report(self) -> Report:
        """Return the state of the log for /diagnostics."""
        if self._writer is None:
            return Report(Level.OK, 'no log is wanted', {'state': 'off'})
        status = self._writer.status()
        values = {
            'state': status.state,
            'path': status.path,
            'bytes': status.bytes,
            'messages': status.messages,
            'dropped': status.dropped,
        }
        if status.state != 'writing':
            return Report(Level.ERROR, f'not logging: {status.reason}', values)
        fresh = status.overflows - self._overflows
        self._overflows = status.overflows
        if fresh:
            return Report(Level.WARN, f'{fresh} messages came too fast', values)
        if status.syncing > SLOW_SYNC:
            return Report(Level.WARN, f'the disk syncs for {status.syncing:.1f} s already', values)
        return Report(Level.OK, 'logging', values)

    def close(self) -> None:
        """Finish the log with index and metadata."""
        if self._writer is not None:
            status = self._writer.close()
            if status.reason and status.messages:
                self._node.get_logger().error(f'the log is not whole: {status.reason}')
            elif not status.reason:
                self._node.get_logger().info(f'{status.messages} messages in {status.path}')


def _analysis_text(settings: AnalyzerSettings) -> str:
    """Return the settings as YAML, less those that belong to this machine."""
    values = settings.to_mapping()
    del values['log_directory'], values['thresholds']
    return yaml.safe_dump(values, sort_keys=False)
