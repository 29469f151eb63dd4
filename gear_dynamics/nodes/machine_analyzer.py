"""The analyzer of a real machine: the columns that its machine file names, from any publisher."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from rclpy.node import Node
from std_msgs.msg import Float64

from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring.results import ConditionResult, Result, TableResult
from gear_dynamics.monitoring.spans.analysis import column_units
from gear_dynamics.monitoring.spans.stream import MachineMonitor
from gear_dynamics.nodes.analyzer_health import AnalyzerHealth
from gear_dynamics.nodes.analyzer_log import AnalyzerLog
from gear_dynamics.nodes.condition import condition_bytes
from gear_dynamics.nodes.diagnostics import Diagnostics
from gear_dynamics.nodes.topics import Timed, listen, publisher
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.wire.tables import TableError, decode_table, encode_table
from gear_dynamics.wire.topics import CONDITION, FRAME, INDICATOR, SAMPLES, TABLES, with_duration


class MachineAnalyzer:
    """Takes blocks of a machine's channels: as they are into the log, decoded into the analysis.

    Parameters
    ----------
    node : rclpy.node.Node
    settings : AnalyzerSettings
        Of which `machine`, `indicators` and those of the log count.

    Raises
    ------
    ParameterError
        If the machine file is wrong or an indicator does not exist.
    """

    def __init__(self, node: Node, settings: AnalyzerSettings) -> None:
        self._node = node
        machine, text = _machine(settings.machine)
        _check_indicators(settings.indicators, machine)
        self._monitor = MachineMonitor(machine)
        self._log = AnalyzerLog(node, settings, '')
        self._log.configure(text)
        self._health = AnalyzerHealth(self._monitor.health)
        self._prefix = node.resolve_topic_name(machine.name.replace(' ', '_')).lstrip('/')
        spectrum = next(topic for topic in TABLES if topic.name.endswith('/spectrum'))
        self._spectrum = spectrum, publisher(node, spectrum)
        self._condition = publisher(node, CONDITION)
        self._indicators = {
            name: publisher(node, INDICATOR, f'gear_pair/indicators/{name}')
            for name in settings.indicators
        }
        tasks = {'stream': self._health.stream, 'log': self._log.report}
        self._diagnostics = Diagnostics(node, tasks)
        self._samples = dataclasses.replace(SAMPLES, name=_topic(machine), publisher='')
        # Best effort hears reliable publishers as well; the other way round it hears none.
        qos = dataclasses.replace(SAMPLES.qos, reliability='best_effort', depth=1000)
        listen(node, dataclasses.replace(self._samples, qos=qos), Timed(self._on_block))

    def close(self) -> None:
        """Publish the last diagnostics and finish the log."""
        self._diagnostics.close()
        self._log.close()

    def _on_block(self, data: bytes, waited: float) -> None:
        with self._health.block(waited):
            try:
                table = decode_table(data)
            except TableError as error:
                self._monitor.health.drop('no table', f'{self._samples.name}: {error}')
                self._log.write(self._samples, data)
                return
            self._log.write(self._samples, data, table.stamp_ns)
            for result in self._monitor.add_block(table.stamp_ns, table.rows):
                self._publish(result)

    def _publish(self, result: Result) -> None:
        span = result.span
        if isinstance(result, TableResult):
            topic, out = self._spectrum
            data = encode_table(with_duration(result.rows, span.duration), span.start_ns, FRAME)
            out.publish(data)
            self._log.write(topic, data, span.start_ns)
            return
        assert isinstance(result, ConditionResult)
        data = condition_bytes(result, self._prefix)
        self._condition.publish(data)
        self._log.write(CONDITION, data, span.start_ns)
        for row in result.rows:
            for name, value in row.values.items():
                publish = self._indicators.get(f'{row.subject}/{name}')
                if publish is not None:
                    publish.publish(Float64(data=value))


def _machine(path: str) -> tuple[Machine, str]:
    file = Path(path).expanduser()
    try:
        return Machine.from_yaml(file), file.read_text(encoding='utf-8')
    except (ValueError, OSError) as error:
        raise ParameterError(f'machine: {error}') from None


def _topic(machine: Machine) -> str:
    """Return the topic of the machine's channels."""
    topics = {channel.source.topic or SAMPLES.name for channel in machine.channels}
    if len(topics) > 1:
        listed = ', '.join(sorted(topics))
        raise ParameterError(f'machine: the channels are on {listed}: one topic is heard')
    return topics.pop()


def _check_indicators(names: list[str], machine: Machine) -> None:
    known = column_units(machine)
    for name in names:
        if name not in known:
            raise ParameterError(
                f'indicators: {name!r} is none of the machine {machine.name}: '
                'docs/machines.md lists them'
            )
