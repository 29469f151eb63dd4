"""A rig seen from the outside: hears its blocks, tells it speeds and faults. The demo drives it."""

from __future__ import annotations

import time
from types import TracebackType

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Float64


class Remote:
    """A node of its own that counts the blocks of a rig and commands its speed.

    Attributes
    ----------
    blocks : int
        Blocks heard so far.
    heard : float
        When the last one was heard, by a steady clock [s].
    heard_result : float
        When a spectrum of the analyzer was last heard [s].
    """

    def __init__(self) -> None:
        self.blocks = 0
        self.heard = self.heard_result = 0.0
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node('gear_remote', context=self._context)
        self._speed = self._node.create_publisher(Float64, 'gear_pair/cmd/speed', 10)
        self._parameters = AsyncParameterClient(self._node, 'gear_sim')
        hear = self._node.create_subscription
        hear(PointCloud2, 'gear_pair/samples', self._on_block, 1000, raw=True)
        hear(PointCloud2, 'gear_pair/spectrum', self._on_spectrum, 10, raw=True)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

    def __enter__(self) -> Remote:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def listen(self, seconds: float) -> None:
        """Let messages come in, for at most this long and at least one message if one is there."""
        self._executor.spin_once(timeout_sec=seconds)

    def set_speed(self, speed: float) -> None:
        """Command the pinion speed [rad/s]."""
        self._speed.publish(Float64(data=speed))

    def crack(self, tooth: int, severity: float) -> None:
        """Crack a tooth of the pinion at its root."""
        values = {'tooth': tooth, 'severity': severity}
        self._parameters.set_parameters(
            [Parameter(f'fault.root_crack.{name}', value=each) for name, each in values.items()]
        )

    @property
    def analyzer_listens(self) -> bool:
        """Whether somebody else listens to the samples."""
        return self._node.count_subscribers('gear_pair/samples') > 1

    def _on_block(self, data: bytes) -> None:
        self.blocks += 1
        self.heard = time.monotonic()

    def _on_spectrum(self, data: bytes) -> None:
        self.heard_result = time.monotonic()
