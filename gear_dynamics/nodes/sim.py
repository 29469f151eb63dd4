"""The `sim` executable: streams the vibration of a simulated gear pair in real time."""

from __future__ import annotations

import contextlib
import functools
import sys
import time
from collections.abc import Iterator, Sequence

from rclpy.clock import Clock, ClockType
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool, Trigger

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.nodes.compiling import compiling
from gear_dynamics.nodes.diagnostics import Diagnostics
from gear_dynamics.nodes.monitor import Monitor
from gear_dynamics.nodes.pacing import SECOND, Schedule, StampCounter
from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.run import NodeError, run_node
from gear_dynamics.nodes.sim_health import SimHealth
from gear_dynamics.nodes.stream import Stream
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.simulator import IntegrationError, Simulator

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
        self._parameters = parameters
        pair, settings = parameters.get(GearPair), parameters.get(SimSettings)
        self._block_size = settings.block_size
        self._rate = settings.sample_rate
        self._simulator = _make_simulator(node, pair, settings)
        fast = settings.real_time_factor == 0
        self._stream = Stream(node, keep_all=fast, publish_clock=settings.publish_clock)
        self._monitor = Monitor(node, settings.sample_rate, settings.monitor_rate)
        self._stamps = StampCounter(settings.sample_rate)
        block_ns = self._block_size / self._rate * SECOND
        self._schedule = Schedule(0.0 if fast else block_ns / settings.real_time_factor)
        self._paused = False
        self._health = SimHealth(settings, self._simulator, self._schedule)
        self._diagnostics = Diagnostics(node, self._health.tasks())
        self._publish_configuration_on(parameters)
        self._take_commands()
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
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        topic = 'gear_pair/configuration'
        self._configuration = self._node.create_publisher(String, topic, latched)
        self._configuration_changed = True
        parameters.on_change(self._changed)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._node.create_timer(CONFIGURATION_PERIOD, self._publish_configuration, clock=steady)
        self._publish_configuration()

    def _take_commands(self) -> None:
        node = self._node
        commands = {'gear_pair/cmd/speed': 'speed', 'gear_pair/cmd/torque': 'load_torque'}
        for topic, name in commands.items():
            # A logger throttles by the line that calls it: each topic needs its own.
            command = functools.partial(self._command, name, node.get_logger().get_child(name))
            node.create_subscription(Float64, topic, command, 10)
        node.create_service(Trigger, '~/reset', self._reset)
        node.create_service(SetBool, '~/pause', self._pause)

    def _command(self, name: str, logger: RcutilsLogger, message: Float64) -> None:
        try:
            self._parameters.set(name, message.data)
        except ParameterError as error:
            self._health.rejected_commands += 1
            logger.warning(f'rejected: {error}', throttle_duration_sec=5.0)

    def _changed(self, names: frozenset[str]) -> None:
        settings = self._parameters.get(SimSettings)
        with _one_line():
            if names & {'speed', 'load_torque'}:
                self._simulator.command(speed=settings.speed, load_torque=settings.load_torque)
            if names - {'speed', 'load_torque'}:
                self._simulator.change(
                    pair=self._parameters.get(GearPair),
                    speed_rate_limit=settings.speed_rate_limit,
                    torque_rate_limit=settings.torque_rate_limit,
                )
        self._configuration_changed = True

    def _publish_configuration(self) -> None:
        if self._configuration_changed:
            pair, settings = self._parameters.get(GearPair), self._parameters.get(SimSettings)
            self._configuration.publish(String(data=configuration_text(pair, settings)))
            self._configuration_changed = False

    def _reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
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
        first = self._simulator.samples_done
        with _one_line():
            samples = self._simulator.advance(self._block_size)
        stamp, end = self._stamps.stamp(first), self._stamps.stamp(first + len(samples))
        start = first / self._rate
        self._stream.put(samples, self._simulator.take_events(), start, stamp, end)
        self._monitor.publish(samples, self._simulator.shafts, first, self._stamps.stamp)


def _make_simulator(node: Node, pair: GearPair, settings: SimSettings) -> Simulator:
    with compiling(node, 'the model'), _one_line():
        simulator = Simulator(
            pair,
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
    return run_node('gear_sim', ABOUT, (GearPair, SimSettings), Sim, argv)


if __name__ == '__main__':
    sys.exit(main())
