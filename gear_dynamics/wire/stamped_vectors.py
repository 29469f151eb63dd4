"""Bytes of many stamped messages of six numbers at once: twice as fast as message objects."""

from __future__ import annotations

import numpy as np

from gear_dynamics.wire.messages import message_class, serialize

_STAMP = slice(4, 12)  # after the encapsulation header: seconds and nanoseconds, 4 bytes each
_VECTORS = slice(-48, None)  # linear and angular, or force and torque: x, y, z each as float64


class StampedVectors:
    """Encodes AccelStamped or WrenchStamped out of a template.

    Parameters
    ----------
    type_name : str
        'geometry_msgs/msg/AccelStamped' or 'geometry_msgs/msg/WrenchStamped'.
    frame_id : str
        Frame of the header.
    """

    def __init__(self, type_name: str, frame_id: str) -> None:
        vector = message_class('geometry_msgs/msg/Vector3')
        time = message_class('builtin_interfaces/msg/Time')(0, 0)
        header = message_class('std_msgs/msg/Header')(time, frame_id)
        pair = message_class(type_name.replace('Stamped', ''))(vector(0, 0, 0), vector(0, 0, 0))
        encoded = serialize(message_class(type_name)(header, pair))
        self._template = np.frombuffer(encoded, np.uint8)

    def encode(self, stamps_ns: np.ndarray, xy: np.ndarray) -> list[bytes]:
        """Return one message for each row.

        Parameters
        ----------
        stamps_ns : ndarray of int64, shape (n,)
        xy : ndarray, shape (n, 2)
            x and y of the first vector; all else is 0.
        """
        messages = np.tile(self._template, (len(xy), 1))
        stamps = np.column_stack(np.divmod(stamps_ns, 1_000_000_000)).astype('<u4')
        vectors = np.zeros((len(xy), 6), '<f8')
        vectors[:, :2] = xy
        messages[:, _STAMP] = stamps.view(np.uint8)
        messages[:, _VECTORS] = vectors.view(np.uint8)
        return [message.tobytes() for message in messages]
