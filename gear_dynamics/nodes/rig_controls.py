"""Commands of the live page to a rig: topics, parameters and services of its sim."""

from __future__ import annotations

import queue
from collections.abc import Callable, Mapping
from typing import Any

from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.task import Future
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger

from gear_dynamics.config_files import config_file
from gear_dynamics.simulation.faults import fault_values
from gear_dynamics.web.commands import Command, Pause, Reset, SetFault, SetValue, UsePreset
from gear_dynamics.web.live_rig import LiveRig
from gear_dynamics.web.presets import preset_of
from gear_dynamics.wire.topics import SPEED_COMMAND, TORQUE_COMMAND

SIM = 'gear_sim'

TOPICS = {'speed': SPEED_COMMAND, 'load_torque': TORQUE_COMMAND}
"""Values that are commanded by a topic; the others are parameters."""


class RigControls:
    """Carry out the commands of a page; what comes of each is said in the rig's notices.

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
        self._commands: queue.SimpleQueue[Command] = queue.SimpleQueue()
        self._publishers = {
            name: node.create_publisher(Float64, f'{namespace}/{topic.name}', 10)
            for name, topic in TOPICS.items()
        }
        sim = f'{namespace}/{SIM}'
        self._parameters = AsyncParameterClient(node, sim)
        self._reset = node.create_client(Trigger, f'{sim}/reset')
        self._pause = node.create_client(SetBool, f'{sim}/pause')
        self.fault_kinds: tuple[str, ...] = ()
        """Faults that the sim knows."""

    def carry_out(self, command: Command) -> None:
        """Take a command from the server's thread; it is passed on in the node's."""
        self._commands.put(command)

    def look(self) -> None:
        """Tell the rig whether a sim is there to be steered, and ask which faults it knows."""
        there = (SIM, self._namespace or '/') in self._node.get_node_names_and_namespaces()
        self._rig.controllable = there
        if there and not self.fault_kinds and self._parameters.services_are_ready():
            self._parameters.list_parameters(['fault'], 3, callback=self._take_faults)

    def _take_faults(self, future: Future) -> None:
        names = future.result().result.names
        kinds = {name.split('.')[1] for name in names if name.endswith('.severity')}
        self.fault_kinds = tuple(sorted(kinds))

    def pass_on(self) -> None:
        """Pass on the commands that came."""
        while not self._commands.empty():
            self._pass_on(self._commands.get())

    def _pass_on(self, command: Command) -> None:
        if isinstance(command, SetValue):
            self._set({command.name: command.value})
        elif isinstance(command, SetFault):
            self._set(fault_values(command.kind, vars(command)))
        elif isinstance(command, Pause):
            request = SetBool.Request(data=command.held)
            self._call(self._pause, request)
        elif isinstance(command, Reset):
            self._call(self._reset, Trigger.Request())
        elif isinstance(command, UsePreset):
            self._use_preset(command.name)

    def _use_preset(self, name: str) -> None:
        preset = preset_of(name)
        path = config_file(preset.pair_file)
        if path is None:
            self._rig.notice(f'{name}: config/{preset.pair_file} is not installed')
            return
        faults: dict[str, Any] = {f'fault.{kind}.severity': 0.0 for kind in self.fault_kinds}
        for kind, values in preset.faults.items():
            faults.update(fault_values(kind, values))
        self._rig.clear_points()
        # The pair first: its own friction coefficient would replace that of the preset.
        self._set({'pair_file': str(path)}, lambda: self._set({**preset.values, **faults}))

    def _set(self, values: Mapping[str, Any], then: Callable[[], None] | None = None) -> None:
        """Command what has a topic, set the rest as parameters, and go on with `then`."""
        for name, value in values.items():
            if name in self._publishers:
                self._publishers[name].publish(Float64(data=float(value)))
                self._rig.notice(f'{name} commanded to {value:g}')
        parameters = [
            Parameter(name, value=value)
            for name, value in values.items()
            if name not in self._publishers
        ]
        if not parameters:
            return
        if not self._parameters.services_are_ready():
            self._rig.notice(f'{self._namespace}/{SIM} does not answer')
            return

        def done(future: Future) -> None:
            for parameter, result in zip(parameters, future.result().results, strict=True):
                if result.successful:
                    self._rig.notice(f'{parameter.name} set to {parameter.value}')
                else:
                    self._rig.notice(result.reason)
            if then is not None and all(result.successful for result in future.result().results):
                then()

        self._parameters.set_parameters(parameters, callback=done)

    def _call(self, client: Any, request: Any) -> None:
        if not client.service_is_ready():
            self._rig.notice(f'{client.srv_name} does not answer')
            return
        client.call_async(request).add_done_callback(
            lambda future: self._rig.notice(future.result().message)
        )
