"""The `analyzer` executable: analyses the stream of a rig and logs it to MCAP."""

from __future__ import annotations

import collections
import functools
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from rclpy.node import Node
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from gear_dynamics.compiling import compiling
from gear_dynamics.config_files import config_file
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.machine.rig import rig_machine
from gear_dynamics.monitoring.catalogue import check_names
from gear_dynamics.monitoring.monitor import Monitor, warm_up
from gear_dynamics.monitoring.results import ConditionResult, Result, TableResult
from gear_dynamics.monitoring.thresholds import ThresholdError, Thresholds
from gear_dynamics.nodes.analyzer_health import AnalyzerHealth
from gear_dynamics.nodes.analyzer_log import AnalyzerLog
from gear_dynamics.nodes.condition import condition_bytes
from gear_dynamics.nodes.diagnostics import Diagnostics
from gear_dynamics.nodes.machine_analyzer import MachineAnalyzer
from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.run import run_node
from gear_dynamics.nodes.topics import Timed, listen, publisher
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.wire.messages import MessageError, deserialize
from gear_dynamics.wire.tables import DecodedTable, TableError, decode_table, encode_table
from gear_dynamics.wire.topics import (
    CONDITION,
    CONFIGURATION,
    DIAGNOSTICS,
    EVENTS_TOPIC,
    FRAME,
    INDICATOR,
    SAMPLES,
    TABLES,
    TOPICS,
    Topic,
    with_duration,
)

NAME = 'gear_analyzer'

ABOUT = 'Analyses the stream of gear_pair/samples and logs the topics of the rig to MCAP.'

Add = Callable[[int, np.ndarray], list[Result]]
"""What takes a table into the analysis: its stamp [ns] and its rows."""

_RIG = rig_machine(34, 59, 1.0, 1.0, 1.0, 1.0)
"""Names of channels and wheels, before a configuration tells the rest."""


MOST_EARLY, LARGEST_EARLY = 200, 32 << 20
"""Tables that may wait for the configuration, and their bytes; of more the oldest are dropped."""


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
        with compiling('the analysis', node.get_logger().info):
            warm_up()
        self._log = AnalyzerLog(node, settings, file.read_text(encoding='utf-8'))
        self._health = AnalyzerHealth(self._monitor.health)
        self._drops = 0
        self._rate = float('inf')
        self._pass = 1
        self._early: collections.deque[tuple[Add, DecodedTable]] = collections.deque()
        self._make_publishers(settings)
        tasks = {
            'stream': self._health.stream,
            'condition': self._health.condition,
            'log': self._log.report,
        }
        self._diagnostics = Diagnostics(node, tasks)
        self._subscribe()

    def _learn(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._monitor.learn()
        response.success, response.message = True, 'learning anew what is normal'
        return response

    def _acknowledge(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._monitor.acknowledge()
        response.success, response.message = True, 'all levels are back to OK'
        return response

    def close(self) -> None:
        """Publish the last diagnostics and finish the log."""
        self._diagnostics.close()
        self._monitor.save()
        self._log.close()

    def _make_publishers(self, settings: AnalyzerSettings) -> None:
        node = self._node
        self._subject_prefix = node.resolve_topic_name('gear_pair').lstrip('/')
        self._tables = {topic.name: publisher(node, topic) for topic in TABLES}
        self._topics = {topic.name: topic for topic in TABLES}
        self._condition = publisher(node, CONDITION)
        self._indicators = {
            name: publisher(node, INDICATOR, f'gear_pair/indicators/{name}')
            for name in settings.indicators
        }

    def _subscribe(self) -> None:
        self._node.create_service(Trigger, '~/learn', self._learn)
        self._node.create_service(Trigger, '~/acknowledge', self._acknowledge)
        handlers: dict[Topic, Callable[..., None]] = {
            CONFIGURATION: self._on_configuration,
            SAMPLES: Timed(self._on_block),
            EVENTS_TOPIC: self._on_events,
            DIAGNOSTICS: self._on_diagnostics,
        }
        for topic in TOPICS:
            if topic.logged and topic.publisher != NAME:
                take = handlers.get(topic) or functools.partial(self._log.write, topic)
                # A sim that runs as fast as its listeners allow waits for those that keep all.
                listen(self._node, topic, take, keep_all=topic in (SAMPLES, EVENTS_TOPIC))

    def _on_diagnostics(self, data: bytes) -> None:
        try:
            statuses = deserialize(data, DIAGNOSTICS.type_name).status
        except MessageError as error:
            self._monitor.health.drop('diagnostics', f'/diagnostics: {error}')
            return
        # All rigs publish on this topic; a log holds what is said of its own.
        namespace = self._node.get_namespace().strip('/')
        if any(_namespace(status.name) == namespace for status in statuses):
            self._log.write(DIAGNOSTICS, data)

    def _on_configuration(self, data: bytes) -> None:
        try:
            text = deserialize(data, CONFIGURATION.type_name).data
            rig = Rig.from_text(text)
            self._configure(rig)
        except (MessageError, ValueError) as error:
            self._node.get_logger().error(f'gear_pair/configuration: {error}')
        else:
            self._log.keep_all = rig.real_time_factor == 0
            self._health.paced = rig.real_time_factor != 0
            self._log.configure(text)
        self._log.write(CONFIGURATION, data)

    def _configure(self, rig: Rig) -> None:
        if rig.replay_pass != self._pass:
            self._pass = rig.replay_pass
            self._publish(self._monitor.begin_again('replay begins again'))
        self._monitor.configure(rig)
        self._rate = rig.sample_rate
        while self._early:
            add, table = self._early.popleft()
            self._publish(add(table.stamp_ns, table.rows))

    def _on_block(self, data: bytes, waited: float) -> None:
        with self._health.block(waited):
            table = self._decoded(SAMPLES, data)
            if table is not None:
                self._log.stream_reached(table.stamp_ns, len(table.rows) / self._rate)
                self._analyse(self._monitor.add_block, table)
            self._warn_of_drops()

    def _on_events(self, data: bytes) -> None:
        table = self._decoded(EVENTS_TOPIC, data)
        if table is not None:
            self._analyse(self._monitor.add_events, table)
        self._warn_of_drops()

    def _analyse(self, add: Add, table: DecodedTable) -> None:
        """Analyse a table; one that overtook the first configuration waits for it."""
        if self._monitor.health.configured:
            self._publish(add(table.stamp_ns, table.rows))
            return
        early = self._early
        early.append((add, table))
        while len(early) > MOST_EARLY or sum(each.rows.nbytes for _, each in early) > LARGEST_EARLY:
            add, table = early.popleft()
            add(table.stamp_ns, table.rows)  # counted, as nothing is configured

    def _decoded(self, topic: Topic, data: bytes) -> DecodedTable | None:
        """Log the bytes, and return the table that they hold."""
        try:
            table = decode_table(data)
        except TableError as error:
            self._monitor.health.drop('no table', f'{topic.name}: {error}')
            self._log.write(topic, data)
            return None
        self._log.write(topic, data, table.stamp_ns)
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
        name, span = f'gear_pair/{result.name}', result.span
        rows = with_duration(result.rows, span.duration)
        data = encode_table(rows, span.start_ns, FRAME)
        self._tables[name].publish(data)
        self._log.write(self._topics[name], data, span.start_ns)

    def _publish_condition(self, result: ConditionResult) -> None:
        data = condition_bytes(result, self._subject_prefix)
        self._condition.publish(data)
        self._log.write(CONDITION, data, result.span.start_ns)
        for row in result.rows:
            for name, value in row.values.items():
                publisher = self._indicators.get(f'{row.subject}/{name}')
                if publisher is not None:
                    publisher.publish(Float64(data=value))
        for change in self._monitor.take_changes():
            logger = self._node.get_logger()
            # Each call stands on a line of its own: rclpy binds a severity to the place of a call.
            if change.after > change.before:
                logger.warning(str(change))
            else:
                logger.info(str(change))


def _namespace(status: str) -> str:
    """Return the namespace of the node that a status is of, as 'rig1' of 'rig1/gear_sim: pace'."""
    return status.partition(':')[0].strip('/').rpartition('/')[0]


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
    return run_node(NAME, ABOUT, (AnalyzerSettings,), _make, argv)


def _make(node: Node, parameters: NodeParameters) -> Analyzer | MachineAnalyzer:
    settings = parameters.get(AnalyzerSettings)
    return MachineAnalyzer(node, settings) if settings.machine else Analyzer(node, parameters)


if __name__ == '__main__':
    sys.exit(main())
