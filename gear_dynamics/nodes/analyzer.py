"""The `analyzer` executable: analyses the stream of a rig and logs it to MCAP."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Float64, String

from gear_dynamics.config_files import config_file
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.machine.rig import rig_machine
from gear_dynamics.monitoring.catalogue import check_names
from gear_dynamics.monitoring.monitor import Monitor, warm_up
from gear_dynamics.monitoring.results import ConditionResult, Result, TableResult, span_of_table
from gear_dynamics.monitoring.thresholds import ThresholdError, Thresholds
from gear_dynamics.nodes.analyzer_health import AnalyzerHealth
from gear_dynamics.nodes.analyzer_log import (
    CONDITION,
    LATCHED,
    NUMBER,
    STREAM,
    TABLE,
    TEXT,
    AnalyzerLog,
)
from gear_dynamics.nodes.compiling import compiling
from gear_dynamics.nodes.condition import condition_bytes
from gear_dynamics.nodes.diagnostics import Diagnostics
from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.run import run_node
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.wire.messages import MessageError, deserialize
from gear_dynamics.wire.tables import Table, TableError, decode_table, encode_table

ABOUT = 'Analyses the stream of gear_pair/samples and logs the topics of the rig to MCAP.'

FRAME = 'line_of_action'

_RIG = rig_machine(34, 59, 1.0, 1.0, 1.0, 1.0)
"""Names of channels and wheels, before a configuration tells the rest."""

TABLES = ('spectrum', 'envelope_spectrum', 'order_spectrum', 'poincare')


class Analyzer:
    """Takes message bytes once: as they are into the log, decoded into the analysis."""

    def __init__(self, node: Node, parameters: NodeParameters) -> None:
        self._node = node
        settings = parameters.get(AnalyzerSettings)
        file = _threshold_file(settings.thresholds)
        thresholds = _thresholds(file)
        _check_names('indicators', settings.indicators)
        self._monitor = Monitor(settings, thresholds)
        # Whatever must be compiled or loaded is, before the first block can come.
        with compiling(node, 'the analysis'):
            warm_up()
        self._log = AnalyzerLog(node, settings, file.read_text(encoding='utf-8'))
        self._health = AnalyzerHealth(self._monitor.health)
        self._drops = 0
        self._make_publishers(settings)
        tasks = {'stream': self._health.stream, 'log': self._log.report}
        self._diagnostics = Diagnostics(node, tasks)
        self._subscribe()

    def close(self) -> None:
        """Publish the last diagnostics and finish the log."""
        self._diagnostics.close()
        self._monitor.save()
        self._log.close()

    def _make_publishers(self, settings: AnalyzerSettings) -> None:
        node = self._node
        self._subject_prefix = node.resolve_topic_name('gear_pair').lstrip('/')
        self._tables = {
            name: node.create_publisher(PointCloud2, f'gear_pair/{name}', 10) for name in TABLES
        }
        self._condition = node.create_publisher(DiagnosticArray, 'gear_pair/condition', 10)
        self._indicators = {
            name: node.create_publisher(Float64, f'gear_pair/indicators/{name}', 10)
            for name in settings.indicators
        }

    def _subscribe(self) -> None:
        node = self._node
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        # A sim that runs as fast as its listeners allow waits for those that keep all; what is
        # kept has a bound in the middleware, 5000 blocks.
        stream = QoSProfile(history=HistoryPolicy.KEEP_ALL)
        node.create_subscription(
            String, 'gear_pair/configuration', self._on_configuration, latched, raw=True
        )
        node.create_subscription(PointCloud2, 'gear_pair/samples', self._on_block, stream, raw=True)
        node.create_subscription(PointCloud2, 'gear_pair/events', self._on_events, stream, raw=True)
        for name in ('speed', 'torque'):
            self._log_only(Float64, f'gear_pair/cmd/{name}', NUMBER)
        node.create_subscription(
            DiagnosticArray, '/diagnostics', self._on_diagnostics, 100, raw=True
        )

    def _log_only(self, message_type: type, topic: str, type_name: str) -> None:
        def take(data: bytes) -> None:
            self._log.write(topic, type_name, data)

        self._node.create_subscription(message_type, topic, take, 100, raw=True)

    def _on_diagnostics(self, data: bytes) -> None:
        try:
            stamp = deserialize(data, CONDITION).header.stamp
        except MessageError as error:
            self._monitor.health.drop('diagnostics', f'/diagnostics: {error}')
            return
        stamp_ns = max(stamp.sec, 0) * 1_000_000_000 + stamp.nanosec
        self._log.write('/diagnostics', CONDITION, data, stamp_ns)

    def _on_configuration(self, data: bytes) -> None:
        self._log.write('gear_pair/configuration', TEXT, data, qos=LATCHED)
        try:
            text = deserialize(data, TEXT).data
            self._monitor.configure(Rig.from_text(text))
        except (MessageError, ValueError) as error:
            self._node.get_logger().error(f'gear_pair/configuration: {error}')
            return
        self._log.configure(text)

    def _on_block(self, data: bytes) -> None:
        with self._health.block():
            table = self._decoded('gear_pair/samples', data)
            if table is not None:
                self._publish(self._monitor.add_block(table.stamp_ns, table.rows))
            self._warn_of_drops()

    def _on_events(self, data: bytes) -> None:
        table = self._decoded('gear_pair/events', data)
        if table is not None:
            self._publish(self._monitor.add_events(table.stamp_ns, table.rows))
        self._warn_of_drops()

    def _decoded(self, topic: str, data: bytes) -> Table | None:
        """Log the bytes, and return the table that they hold."""
        try:
            table = decode_table(data)
        except TableError as error:
            self._monitor.health.drop('no table', f'{topic}: {error}')
            self._log.write(topic, TABLE, data, qos=STREAM)
            return None
        self._log.write(topic, TABLE, data, table.stamp_ns, STREAM)
        return table

    def _warn_of_drops(self) -> None:
        health = self._monitor.health
        drops = health.dropped.total()
        if drops != self._drops:
            self._drops = drops
            self._node.get_logger().warning(
                f'{drops} messages dropped so far, the last because {health.last_fault}',
                throttle_duration_sec=5.0,
            )

    def _publish(self, results: list[Result]) -> None:
        for result in results:
            if isinstance(result, TableResult):
                self._publish_table(result)
            else:
                self._publish_condition(result)

    def _publish_table(self, result: TableResult) -> None:
        data = encode_table(result.rows, result.span.start_ns, FRAME)
        self._tables[result.name].publish(data)
        self._log.write(f'gear_pair/{result.name}', TABLE, data, result.span.start_ns)
        self._publish_condition(span_of_table(result))

    def _publish_condition(self, result: ConditionResult) -> None:
        data = condition_bytes(result, self._subject_prefix)
        self._condition.publish(data)
        self._log.write('gear_pair/condition', CONDITION, data, result.span.start_ns)
        for row in result.rows:
            for name, value in row.values.items():
                publisher = self._indicators.get(f'{row.subject}/{name}')
                if publisher is not None:
                    publisher.publish(Float64(data=value))


def _threshold_file(path: str) -> Path:
    file = Path(path).expanduser() if path else config_file('thresholds.yaml')
    if file is None:
        raise ParameterError("thresholds is '': the package's config/thresholds.yaml is missing")
    return file


def _thresholds(file: Path) -> Thresholds:
    try:
        thresholds = Thresholds.from_yaml(file)
    except ThresholdError as error:
        raise ParameterError(f'thresholds: {error}') from error
    _check_names(f'thresholds: {file}', thresholds.names)
    return thresholds


def _check_names(where: str, names: Iterable[str]) -> None:
    try:
        check_names(names, _RIG)
    except ValueError as error:
        raise ParameterError(f'{where}: {error}') from error


def main(argv: Sequence[str] | None = None) -> int:
    """Run the node until it is told to stop; return the exit code."""
    return run_node('gear_analyzer', ABOUT, (AnalyzerSettings,), Analyzer, argv)


if __name__ == '__main__':
    sys.exit(main())
