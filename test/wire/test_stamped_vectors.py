import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy')

from geometry_msgs.msg import AccelStamped, WrenchStamped  # noqa: E402
from rclpy.serialization import deserialize_message  # noqa: E402

from gear_dynamics.wire.stamped_vectors import StampedVectors  # noqa: E402
from gear_dynamics.wire.topics import ACCEL_TYPE, WRENCH_TYPE  # noqa: E402

STAMPS = np.array([1_700_000_000_999_999_999, 5, 2**31 * 10**9 - 1])
XY = np.array([[1.5, -2.0], [3.0, 4.0], [-1e300, 1e-300]])


@pytest.mark.parametrize('frame', ['line_of_action', 'a', 'ab', 'abc', 'abcd', ''])
def test_accelerations_are_what_rclpy_reads(frame):
    for data, stamp, xy in zip(
        StampedVectors(ACCEL_TYPE, frame).encode(STAMPS, XY), STAMPS, XY, strict=True
    ):
        message = deserialize_message(data, AccelStamped)
        assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == stamp
        assert message.header.frame_id == frame
        linear, angular = message.accel.linear, message.accel.angular
        assert [linear.x, linear.y] == list(xy)
        assert [linear.z, angular.x, angular.y, angular.z] == [0, 0, 0, 0]


def test_forces_are_what_rclpy_reads():
    (data,) = StampedVectors(WRENCH_TYPE, 'line_of_action').encode(STAMPS[:1], XY[:1])
    message = deserialize_message(data, WrenchStamped)
    assert [message.wrench.force.x, message.wrench.force.y] == [1.5, -2.0]
    assert message.wrench.force.z == 0
    assert message.wrench.torque.x == message.wrench.torque.y == message.wrench.torque.z == 0


def test_nothing_gives_nothing():
    assert StampedVectors(ACCEL_TYPE, 'f').encode(STAMPS[:0], XY[:0]) == []
