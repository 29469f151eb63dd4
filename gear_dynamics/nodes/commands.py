"""Commands on speed and load torque: the latest of each goes to the simulator with a block."""

from __future__ import annotations

import functools

from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node
from std_msgs.msg import Float64

from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.topics import listen
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.wire.topics import SPEED_COMMAND, TORQUE_COMMAND

TARGETS = {SPEED_COMMAND: 'speed', TORQUE_COMMAND: 'load_torque'}
"""The parameter that each topic commands."""


class Commands:
    """Takes commands at any rate.

    A command takes effect with the next block, and only the latest before it counts, so that
    thousands of commands a second cost no more than their reception. The ROS parameters follow
    when `mirror` is called.

    Parameters
    ----------
    node : rclpy.node.Node
    parameters : NodeParameters

    Attributes
    ----------
    names : frozenset of str
        The parameters that can be commanded.
    rejected : int
        Commands refused because they are not finite or out of range.
    """

    names = frozenset(TARGETS.values())

    def __init__(self, node: Node, parameters: NodeParameters) -> None:
        self.rejected = 0
        self._parameters = parameters
        self._about = {each.name: each for each in SimSettings.parameters()}
        self._targets: dict[str, float] = {}
        self._unmirrored: dict[str, float] = {}
        for topic, name in TARGETS.items():
            # A logger throttles by the line that calls it: each topic needs its own.
            logger = node.get_logger().get_child(name)
            listen(node, topic, functools.partial(self._command, name, logger), raw=False)

    def take(self) -> dict[str, float]:
        """Return the latest value of each command that came since the last call."""
        targets, self._targets = self._targets, {}
        return targets

    def forget(self, names: frozenset[str]) -> None:
        """Forget the commands of parameters that were set since."""
        for name in names:
            self._targets.pop(name, None)
            self._unmirrored.pop(name, None)

    def mirror(self) -> bool:
        """Set the ROS parameters to the commands that came; tell whether there was any."""
        values, self._unmirrored = self._unmirrored, {}
        if values:
            self._parameters.mirror(values)
        return bool(values)

    def _command(self, name: str, logger: RcutilsLogger, message: Float64) -> None:
        try:
            value = float(self._about[name].check(message.data))  # type: ignore[arg-type]
        except ParameterError as error:
            self.rejected += 1
            logger.warning(f'rejected: {error}', throttle_duration_sec=5.0)
            return
        self._targets[name] = self._unmirrored[name] = value
