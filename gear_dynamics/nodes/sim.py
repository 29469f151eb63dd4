"""The `sim` executable: streams the vibration of a simulated gear pair in real time."""

from __future__ import annotations

import contextlib
import functools
import sys
import time
import warnings
from collections.abc import Iterator, Sequence

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from gear_dynamics.compiling import compiling
from gear_dynamics.model.faults import Fault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.nodes.commands import Commands
from gear_dynamics.nodes.diagnostics import Diagnostics
from gear_dynamics.nodes.faults import LabelTopic, concerns_faults, faults_of, refuse_unfit
from gear_dynamics.nodes.monitor_topics import MonitorTopics
from gear_dynamics.nodes.pacing import SECOND, Schedule, StampCounter
from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.run import NodeError, run_node
from gear_dynamics.nodes.sim_health import SimHealth
from gear_dynamics.nodes.stream import Stream
from gear_dynamics.nodes.topics import publisher
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.faults import FaultSettings
from gear_dynamics.simulation.pair_file import read_pair
from gear_dynamics.simulation.sensor import Sensor
from gear_dynamics.simulation.simulator import Simulator
from gear_dynamics.simulation.stepping import IntegrationError
from gear_dynamics.wire.topics import CONFIGURATION

ABOUT = 'Streams the vibration of a simulated spur gear pair on gear_pair/samples in real time.'

SHORTEST_TICK = SECOND // 1000
"""Least time between two looks at the schedule [ns]; blocks due in between go out together."""

LONGEST_TICK = 10**6 * SECOND
"""What a timer can hold; a pace so slow is as good as none [ns]."""

LONGEST_TURN = SECOND // 50
"""Time that blocks may take before commands and services have their turn [ns]."""

CONFIGURATION_PERIOD = 0.1
"""Least time between two configurations while parameters change [s]."""


class Sim:
    """Advances the model block by block, at the pace of a steady clock, and publishes it."""

    def __init__(self, node: Node, parameters: NodeParameters) -> None:
        self._node = node
        # Such as an operating point outside the range of the friction model.
        warnings.showwarning = lambda message, *_: node.get_logger().warning(str(message))
        self._parameters = parameters
        pair, settings = parameters.get(GearPair), parameters.get(SimSettings)
        self._block_size = settings.block_size
        self._rate = settings.sample_rate
        self._name = node.get_fully_qualified_name()
        parameters.add_check(functools.partial(refuse_unfit, node=self._name))
        if settings.pair_file:
            pair, settings = self._take_pair(settings.pair_file)
        self._sensor = Sensor(settings.noise_density, settings.noise_seed, self._rate)
        self._simulator = _make_simulator(node, pair, settings, faults_of(parameters.sets))
        fast = settings.real_time_factor == 0
        self._stream = Stream(node, fast, settings.publish_clock, settings.tacho)
        sample_ns = 0.0 if fast else SECOND / self._rate / settings.real_time_factor
        self._monitor = MonitorTopics(node, self._rate, settings.monitor_rate, sample_ns)
        self._stamps = StampCounter(settings.sample_rate)
        self._schedule = Schedule(self._block_size * sample_ns)
        self._paused = False
        self._commands = Commands(node, parameters)
        self._health = SimHealth(
            settings, self._simulator, self._schedule, lambda: self._commands.rejected
        )
        self._diagnostics = Diagnostics(node, self._health.tasks())
        self._labels = LabelTopic(node, self._rate)
        self._publish_configuration_on(parameters)
        node.create_service(Trigger, '~/reset', self._reset)
        node.create_service(SetBool, '~/pause', self._pause)
        tick = min(max(self._schedule.interval_ns, SHORTEST_TICK), LONGEST_TICK)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._timer = node.create_timer(tick / SECOND, self._tick, clock=steady)
        self._restart()
        node.get_logger().info(
            f'streaming {self._rate:g} samples/s in blocks of {self._block_size}'
        )

    def close(self) -> None:
        """Let listeners have the last blocks and diagnostics."""
        self._stream.close()
        self._diagnostics.close()

    def _publish_configuration_on(self, parameters: NodeParameters) -> None:
        self._configuration = publisher(self._node, CONFIGURATION)
        self._configuration_changed = True
        parameters.on_change(self._changed)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._node.create_timer(CONFIGURATION_PERIOD, self._publish_configuration, clock=steady)
        self._publish_configuration()

    def _changed(self, names: frozenset[str]) -> None:
        settings = self._parameters.get(SimSettings)
        with _one_line():
            commanded = names & Commands.names
            if commanded:
                self._commands.forget(commanded)
                self._simulator.command(**{name: getattr(settings, name) for name in commanded})
            if 'pair_file' in names and settings.pair_file:
                self._start_anew(settings.pair_file)
            elif names - commanded:
                faulty = any(concerns_faults(name) for name in names)
                self._simulator.change(
                    pair=self._parameters.get(GearPair),
                    faults=faults_of(self._parameters.sets) if faulty else None,
                    speed_rate_limit=settings.speed_rate_limit,
                    torque_rate_limit=settings.torque_rate_limit,
                )
        self._configuration_changed = True

    def _take_pair(self, path: str) -> tuple[GearPair, SimSettings]:
        """Take over the pair of a file, and the operating point that the file gives."""
        given = read_pair(path, self._name)
        self._parameters.replace(given.pair)
        self._parameters.mirror(given.operation)
        return given.pair, self._parameters.get(SimSettings)

    def _start_anew(self, path: str) -> None:
        """Start the model with the pair of a file, the present faults and the file's commands."""
        pair, settings = self._take_pair(path)
        self._commands.forget(Commands.names)
        self._simulator.command(speed=settings.speed, load_torque=settings.load_torque)
        self._simulator.reset(pair, faults_of(self._parameters.sets))
        self._restart()

    def _publish_configuration(self) -> None:
        self._configuration_changed |= self._commands.mirror()
        if self._configuration_changed:
            pair, settings = self._parameters.get(GearPair), self._parameters.get(SimSettings)
            self._configuration.publish(String(data=configuration_text(pair, settings)))
            self._configuration_changed = False

    def _obey(self) -> None:
        """Hand the commands that came to the simulator, which follows them from now on."""
        targets = self._commands.take()
        if targets:
            with _one_line():
                self._simulator.command(**targets)

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._obey()
        with _one_line():
            self._simulator.reset()
        self._restart()
        response.success = True
        response.message = 'back to the start, at the present commands'
        return response

    def _pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if self._paused and not request.data:
            self._restart()
        self._paused = self._health.paused = request.data
        response.success = True
        response.message = 'paused' if request.data else 'running'
        return response

    def _restart(self) -> None:
        """Set stamps and schedule to the clock; the next block ends one interval from now."""
        self._stamps.set(self._simulator.samples_done, time.time_ns())
        self._schedule.start(time.monotonic_ns())
        self._timer.reset()
        self._health.restart()
        self._monitor.reset()

    def _tick(self) -> None:
        end = time.monotonic_ns() + LONGEST_TURN
        now = time.monotonic_ns()
        while not self._paused and now < end and self._schedule.due(now):
            if not self._stream.publish():
                return
            self._advance()
            self._stream.publish()
            now = time.monotonic_ns()
            self._schedule.done(now)

    def _advance(self) -> None:
        self._obey()
        first = self._simulator.samples_done
        with _one_line():
            samples = self._sensor.measured(self._simulator.advance(self._block_size))
        stamp, end = self._stamps.stamp(first), self._stamps.stamp(first + len(samples))
        start = first / self._rate
        self._labels.publish(self._simulator.labels, first, stamp)
        self._stream.put(samples, self._simulator.take_events(), start, stamp, end)
        self._monitor.publish(samples, self._simulator.shafts, first, self._stamps.stamp)


def _make_simulator(
    node: Node, pair: GearPair, settings: SimSettings, faults: Sequence[Fault]
) -> Simulator:
    with compiling('the model', node.get_logger().info), _one_line():
        simulator = Simulator(
            pair,
            faults=faults,
            sample_rate=settings.sample_rate,
            speed=settings.speed,
            load_torque=settings.load_torque,
            speed_rate_limit=settings.speed_rate_limit,
            torque_rate_limit=settings.torque_rate_limit,
            anti_alias=settings.anti_alias,
            rtol=settings.rtol,
            atol=settings.atol,
            section_phase=settings.section_phase,
        )
        # Compiles what has not been: neither the first block nor the first command may be late.
        simulator.advance(1)
        simulator.command(speed=settings.speed)
        simulator.change(pair=pair)
        simulator.reset()
    return simulator


@contextlib.contextmanager
def _one_line() -> Iterator[None]:
    """Turn an error of the integrator into the one line that the node ends with."""
    try:
        yield
    except IntegrationError as error:
        raise NodeError(str(error)) from error


def main(argv: Sequence[str] | None = None) -> int:
    """Run the node until it is told to stop; return the exit code."""
    return run_node('gear_sim', ABOUT, (GearPair, SimSettings, FaultSettings), Sim, argv)


if __name__ == '__main__':
    sys.exit(main())
