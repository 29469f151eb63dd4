"""Publishing of bytes with backpressure, and the bytes of /clock."""

from __future__ import annotations

from rclpy.publisher import Publisher
from rclpy.qos import HistoryPolicy

from gear_dynamics.wire.messages import message_class, serialize


def try_publish(publisher: Publisher, data: bytes) -> bool:
    """Publish serialized bytes; return whether the middleware took them.

    With a keep-all history, a listener that is too far behind makes the middleware refuse a
    message after a while (100 ms); it may be published again then. Any other failure is raised.
    """
    try:
        publisher.publish(data)
    except Exception as error:  # RCLError is a private class of the extension
        keep_all = publisher.qos_profile.history == HistoryPolicy.KEEP_ALL
        if keep_all and 'cannot publish data' in str(error):
            return False
        raise
    return True


def clock_bytes(stamp_ns: int) -> bytes:
    """Return the bytes of a rosgraph_msgs/Clock."""
    time = message_class('builtin_interfaces/msg/Time')(*divmod(stamp_ns, 1_000_000_000))
    return serialize(message_class('rosgraph_msgs/msg/Clock')(time))
