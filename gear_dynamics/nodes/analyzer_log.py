"""The analyzer's log: which topics go to MCAP, and how the log is doing."""

from __future__ import annotations

import dataclasses
import functools
import time
from pathlib import Path

import yaml
from rclpy.node import Node

from gear_dynamics.bag.metadata import OfferedQos
from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.monitoring.level import Level
from gear_dynamics.nodes.diagnostics import Report
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.versions import versions
from gear_dynamics.wire.topics import EVENTS_TOPIC, SAMPLES, Qos, Topic

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

    Attributes
    ----------
    keep_all : bool
        Whether the sim publishes samples and events with keep all.

    Raises
    ------
    ParameterError
        If no log can be begun in `log_directory`.
    """

    def __init__(self, node: Node, settings: AnalyzerSettings, limits: str) -> None:
        self._node = node
        self.keep_all = False
        self._names: dict[Topic, str] = {}
        self._stream_ns: int | None = None
        self._overflows = 0
        self._configuration = {
            'analyzer': _analysis_text(settings),
            'thresholds': limits,
            'versions': yaml.safe_dump(versions(), sort_keys=False),
        }
        self._writer = None
        if settings.log:
            self._writer = _open(settings, node.get_namespace(), self._configuration)
            node.get_logger().info(f'logging to {self._writer.status().path}')

    def stream_reached(self, stamp_ns: int, duration: float) -> None:
        """Note that the stream has reached the end of a block; commands begin to act there."""
        self._stream_ns = stamp_ns + round(duration * 1e9)

    def write(self, topic: Topic, data: bytes, publish_time: int | None = None) -> None:
        """Log a message as it came or went.

        Parameters
        ----------
        topic : Topic
        data : bytes
        publish_time : int, optional
            Stamp [ns] on the time scale of the stream; by default where the stream is now, so that
            all messages of a log are on one scale whatever the real-time factor.
        """
        if self._writer is None:
            return
        name = self._names.get(topic)
        if name is None:
            name = self._names[topic] = self._node.resolve_topic_name(topic.name)
        now = time.time_ns()
        if publish_time is None:
            publish_time = now if self._stream_ns is None else self._stream_ns
        qos = _KEEP_ALL if self.keep_all and topic in (SAMPLES, EVENTS_TOPIC) else topic.qos
        self._writer.write(name, topic.type_name, data, now, publish_time, _offered(qos))

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
            'size [bytes]': status.bytes,
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


_KEEP_ALL = dataclasses.replace(SAMPLES.qos, history='keep_all')


@functools.cache
def _offered(qos: Qos) -> OfferedQos:
    return OfferedQos(**dataclasses.asdict(qos))


def _open(settings: AnalyzerSettings, namespace: str, configuration: dict[str, str]) -> LogWriter:
    directory = Path(settings.log_directory).expanduser()
    where = f'log_directory is {settings.log_directory!r}'
    if not directory.is_dir():
        raise ParameterError(f'{where}: there is no such folder; make it, or name another')
    writer = LogWriter(
        directory,
        configuration,
        settings.log_compression,
        settings.log_split_size,
        settings.log_split_duration,
        settings.log_total_cap,
        settings.log_free_floor,
        name='_'.join(['gear_log', *filter(None, namespace.split('/'))]),
    )
    reason = writer.status().reason
    if reason:
        writer.close()
        raise ParameterError(f'{where}: no log can be written there: {reason}')
    return writer


def _analysis_text(settings: AnalyzerSettings) -> str:
    """Return the settings as YAML, less those that belong to this machine."""
    values = settings.to_mapping()
    del values['log_directory'], values['thresholds']
    return yaml.safe_dump(values, sort_keys=False)
