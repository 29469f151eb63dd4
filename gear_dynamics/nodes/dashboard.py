"""The `dashboard` node: the live page, fed by the topics of every rig that is found."""

from __future__ import annotations

import asyncio
import sys
import threading
from collections.abc import Sequence

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.rig_controls import RigControls
from gear_dynamics.nodes.rig_topics import RigTopics
from gear_dynamics.nodes.run import NodeError, run_node
from gear_dynamics.parameters.settings import DashboardSettings
from gear_dynamics.web.address import cannot_listen, lines_of_address
from gear_dynamics.web.hub import Hub
from gear_dynamics.web.live_rig import LiveRig
from gear_dynamics.web.server import PageServer
from gear_dynamics.wire.topics import SAMPLES

ABOUT = 'Shows rigs live in the browser, and lets it steer them.'

LOOK_PERIOD = 1.0
"""Time between two looks for new rigs [s]."""

TURN = 0.02
"""Time after which a command of a page is passed on, at most [s]."""


class Dashboard:
    """Finds rigs by their `gear_pair/samples`, and serves their page."""

    def __init__(self, node: Node, parameters: NodeParameters) -> None:
        self._node = node
        self._hub = Hub(f'waiting for {SAMPLES.name}')
        self._rigs: dict[str, tuple[RigTopics, RigControls]] = {}
        settings = parameters.get(DashboardSettings)
        self._thread = ServerThread(settings, self._hub)
        for line in self._thread.start():
            node.get_logger().info(line)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(LOOK_PERIOD, self._look, clock=steady)
        node.create_timer(TURN, self._pass_on, clock=steady)
        self._look()

    def close(self) -> None:
        """Let the pages go."""
        self._thread.stop()

    def _look(self) -> None:
        """Take in rigs that are new, and tell whether those known can be steered."""
        end = f'/{SAMPLES.name}'
        for topic, _ in self._node.get_topic_names_and_types():
            name = topic.removesuffix(end)
            if topic.endswith(end) and name not in self._rigs:
                rig = LiveRig(name or '/', controllable=False)
                controls = RigControls(self._node, name, rig)
                self._rigs[name] = RigTopics(self._node, name, rig), controls
                self._hub.add(rig, controls)
        for _, controls in self._rigs.values():
            controls.look()
            self._hub.fault_kinds = controls.fault_kinds or self._hub.fault_kinds

    def _pass_on(self) -> None:
        for _, controls in self._rigs.values():
            controls.pass_on()


class ServerThread:
    """The page's server in a thread of its own, since ROS has the main one."""

    def __init__(self, settings: DashboardSettings, hub: Hub) -> None:
        self._settings = settings
        self._server = PageServer(hub, settings.address, settings.port)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name='page', daemon=True)

    def start(self) -> list[str]:
        """Listen, and return what there is to say of the address.

        Raises
        ------
        NodeError
            If the address cannot be listened on.
        """
        self._thread.start()
        try:
            asyncio.run_coroutine_threadsafe(self._server.start(), self._loop).result()
        except OSError as error:
            raise NodeError(cannot_listen(self._settings, error)) from None
        return lines_of_address(self._settings, self._server)

    def stop(self) -> None:
        """Let the pages go and end the thread."""
        asyncio.run_coroutine_threadsafe(self._server.stop(), self._loop).result(3.0)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(1.0)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the node until it is told to stop; return the exit code."""
    return run_node('gear_dashboard', ABOUT, (DashboardSettings,), Dashboard, argv)


if __name__ == '__main__':
    sys.exit(main())
