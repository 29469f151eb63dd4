"""The topics for people and plotters; each costs nothing while nobody listens to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import JointState

from gear_dynamics.nodes.pacing import SECOND
from gear_dynamics.nodes.publish_schedule import Due, PublishSchedule
from gear_dynamics.nodes.topics import publisher
from gear_dynamics.signal.decimation import Decimator
from gear_dynamics.wire.stamped_vectors import StampedVectors
from gear_dynamics.wire.topics import FRAME, JOINT_STATES, VECTORS, Topic

JOINT_STATE_RATE = 50.0
"""Joint states per second of model time [Hz]."""

JOINTS = ('pinion_joint', 'gear_joint')

Stamp = Callable[[int], int]
"""Gives the stamp [ns] of a sample by its number."""

Numbered = Iterator[tuple[int, object]]
"""Messages, each with the number of the sample that it belongs to."""


class VectorTopic:
    """One low-passed and decimated topic of x and y.

    Parameters
    ----------
    node : rclpy.node.Node
    topic : Topic
    ratio : int
        Samples for one message.
    """

    def __init__(self, node: Node, topic: Topic, ratio: int) -> None:
        self.publisher = publisher(node, topic)
        self._encoder = StampedVectors(topic.type_name, FRAME)
        self._columns = topic.xy
        self._decimator = Decimator(ratio)
        self.delay = self._decimator.delay

    def reset(self) -> None:
        """Begin anew after a jump of the samples."""
        self._decimator.reset()

    def messages(
        self, samples: np.ndarray, shafts: np.ndarray, first: int, stamp: Stamp
    ) -> Numbered:
        """Iterate over the messages that a block completes."""
        block = np.zeros((len(samples), 2))
        for axis, name in enumerate(self._columns):
            if name is not None:
                block[:, axis] = samples[name]
        numbers, values = self._decimator.feed(block, first)
        stamps = np.array([stamp(number) for number in numbers.tolist()], dtype=np.int64)
        return zip(numbers.tolist(), self._encoder.encode(stamps, values), strict=True)


class JointStates:
    """Angle, speed and torque of both shafts at 50 Hz of model time.

    Each shaft counts positive in its own direction of rotation, as in docs/model.md.

    Parameters
    ----------
    node : rclpy.node.Node
    sample_rate : float
        [Hz]
    """

    delay = 0

    def __init__(self, node: Node, sample_rate: float) -> None:
        self.publisher = publisher(node, JOINT_STATES)
        self._every = max(1, round(sample_rate / JOINT_STATE_RATE))

    def reset(self) -> None:
        """Do nothing: no sample is remembered."""

    def messages(
        self, samples: np.ndarray, shafts: np.ndarray, first: int, stamp: Stamp
    ) -> Numbered:
        """Iterate over the messages that a block completes."""
        for index in range(-first % self._every, len(samples), self._every):
            number = first + index
            yield number, self._message(samples[index], shafts[index], stamp(number))

    def _message(self, sample: np.void, shafts: np.void, stamp_ns: int) -> JointState:
        message = JointState(name=list(JOINTS))
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, SECOND)
        message.position = [float(sample['pinion_angle']), float(sample['gear_angle'])]
        message.velocity = [float(sample['speed']), float(shafts['gear_speed'])]
        message.effort = [float(shafts['drive_torque']), -float(sample['load_torque'])]
        return message


class MonitorTopics:
    """All monitor topics of the sim, spread evenly over the time of a block.

    Parameters
    ----------
    node : rclpy.node.Node
    sample_rate, monitor_rate : float
        The second divides the first [Hz].
    sample_ns : float
        Wall-clock time of a sample [ns]; 0 publishes all messages of a block at once.
    """

    def __init__(
        self, node: Node, sample_rate: float, monitor_rate: float, sample_ns: float
    ) -> None:
        every = round(sample_rate / monitor_rate)
        self._topics: list[VectorTopic | JointStates] = [
            *(VectorTopic(node, topic, every) for topic in VECTORS),
            JointStates(node, sample_rate),
        ]
        self._sample_ns = sample_ns
        self._spread = PublishSchedule(node)

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
        due = []
        for topic in self._topics:
            if not topic.publisher.get_subscription_count():
                topic.reset()
                continue
            due += [
                Due((number - first + topic.delay) * self._sample_ns, topic.publisher, message)
                for number, message in topic.messages(samples, shafts, first, stamp)
            ]
        self._spread.put(due)

    def reset(self) -> None:
        """Begin anew after a jump of the samples."""
        self._spread.flush()
        for topic in self._topics:
            topic.reset()
