"""The topics for people and plotters; each costs nothing while nobody listens to it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from geometry_msgs.msg import AccelStamped, WrenchStamped
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState

from gear_dynamics.nodes.pacing import SECOND
from gear_dynamics.signal.decimation import Decimator
from gear_dynamics.wire.stamped_vectors import ACCEL, WRENCH, StampedVectors

JOINT_STATE_RATE = 50.0
"""Joint states per second of model time [Hz]."""

JOINTS = ('pinion_joint', 'gear_joint')

Stamp = Callable[[int], int]
"""Gives the stamp [ns] of a sample by its number."""


class VectorTopic:
    """One low-passed and decimated topic of x and y.

    Parameters
    ----------
    publisher : rclpy.publisher.Publisher
    encoder : StampedVectors
    columns : tuple of two str or None
        Columns of `samples` that are x and y; None stays 0.
    ratio : int
        Samples for one message.
    """

    def __init__(
        self,
        publisher: Publisher,
        encoder: StampedVectors,
        columns: tuple[str | None, str | None],
        ratio: int,
    ) -> None:
        self._publisher = publisher
        self._encoder = encoder
        self._columns = columns
        self._decimator = Decimator(ratio)

    def reset(self) -> None:
        """Begin anew after a jump of the samples."""
        self._decimator.reset()

    def publish(self, samples: np.ndarray, first: int, stamp: Stamp) -> None:
        """Publish what of a block is due, if anybody listens."""
        if not self._publisher.get_subscription_count():
            self._decimator.reset()
            return
        block = np.zeros((len(samples), 2))
        for axis, name in enumerate(self._columns):
            if name is not None:
                block[:, axis] = samples[name]
        numbers, values = self._decimator.feed(block, first)
        stamps = np.array([stamp(number) for number in numbers.tolist()], dtype=np.int64)
        for message in self._encoder.encode(stamps, values):
            self._publisher.publish(message)


class JointStates:
    """Angle, speed and torque of both shafts at 50 Hz of model time.

    Parameters
    ----------
    publisher : rclpy.publisher.Publisher
    sample_rate : float
        [Hz]
    """

    def __init__(self, publisher: Publisher, sample_rate: float) -> None:
        self._publisher = publisher
        self._every = max(1, round(sample_rate / JOINT_STATE_RATE))

    def publish(self, samples: np.ndarray, shafts: np.ndarray, first: int, stamp: Stamp) -> None:
        """Publish what of a block is due, if anybody listens."""
        if not self._publisher.get_subscription_count():
            return
        for index in range(-first % self._every, len(samples), self._every):
            message = self._message(samples[index], shafts[index], stamp(first + index))
            self._publisher.publish(message)

    def _message(self, sample: np.void, shafts: np.void, stamp_ns: int) -> JointState:
        message = JointState(name=list(JOINTS))
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, SECOND)
        message.position = [float(sample['pinion_angle']), float(sample['gear_angle'])]
        message.velocity = [float(sample['speed']), float(shafts['gear_speed'])]
        message.effort = [float(shafts['drive_torque']), -float(sample['load_torque'])]
        return message


class Monitor:
    """All monitor topics of the sim.

    Parameters
    ----------
    node : rclpy.node.Node
    sample_rate, monitor_rate : float
        The second divides the first [Hz].
    """

    def __init__(self, node: Node, sample_rate: float, monitor_rate: float) -> None:
        every = round(sample_rate / monitor_rate)
        topics = (
            ('gear_pair/pinion/acceleration', ACCEL, ('pinion_ax', 'pinion_ay')),
            ('gear_pair/gear/acceleration', ACCEL, ('gear_ax', 'gear_ay')),
            ('gear_pair/mesh_force', WRENCH, (None, 'mesh_force')),
            ('gear_pair/friction_force', WRENCH, ('friction_force', None)),
        )
        self._vectors = [
            VectorTopic(
                node.create_publisher(AccelStamped if kind == ACCEL else WrenchStamped, topic, 100),
                StampedVectors(kind, 'line_of_action'),
                columns,
                every,
            )
            for topic, kind, columns in topics
        ]
        joints = node.create_publisher(JointState, 'gear_pair/joint_states', 10)
        self._joints = JointStates(joints, sample_rate)

    def publish(self, samples: np.ndarray, shafts: np.ndarray, first: int, stamp: Stamp) -> None:
        """Publish what of a block is due on each topic that has listeners.

        Parameters
        ----------
        samples : ndarray
            Of dtype SAMPLES.
        shafts : ndarray
            Of dtype SHAFTS, for the same instants.
        first : int
            Number of its first sample.
        stamp : callable
            Gives the stamp of a sample by its number.
        """
        for topic in self._vectors:
            topic.publish(samples, first, stamp)
        self._joints.publish(samples, shafts, first, stamp)

    def reset(self) -> None:
        """Begin anew after a jump of the samples."""
        for topic in self._vectors:
            topic.reset()
