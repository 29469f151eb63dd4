"""Message bytes of any stock Jazzy type, without ROS: definitions, type hashes, CDR."""

from __future__ import annotations

import dataclasses
import difflib
import functools
import struct
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore


class MessageError(ValueError):
    """A message type is unknown, or bytes are no message of the type."""


@dataclasses.dataclass(frozen=True)
class MessageType:
    """Definition of a message type, as logs hold it.

    Attributes
    ----------
    name : str
        As 'sensor_msgs/msg/PointCloud2'.
    definition : str
        The full definition, those of nested types appended (encoding ros2msg).
    hash : str
        Type hash of REP 2011, 'RIHS01_' and 64 hexadecimal digits.
    """

    name: str
    definition: str
    hash: str


@functools.cache
def typestore() -> Typestore:
    """Return the store of all stock Jazzy types."""
    return get_typestore(Stores.ROS2_JAZZY)


@functools.cache
def message_type(type_name: str) -> MessageType:
    """Return definition and hash of a type.

    Raises
    ------
    MessageError
        If Jazzy has no such type.
    """
    message_class(type_name)
    store = typestore()
    definition, _ = store.generate_msgdef(type_name, ros_version=2)
    return MessageType(type_name, definition, store.hash_rihs01(type_name))


def message_class(type_name: str) -> Any:
    """Return the dataclass that holds a message of the type; its fields are the message's.

    Raises
    ------
    MessageError
        If Jazzy has no such type.
    """
    types = typestore().types
    if type_name not in types:
        near = difflib.get_close_matches(type_name[:100], types, n=1)
        hint = f'; did you mean {near[0]!r}?' if near else ''
        raise MessageError(f'{type_name[:100]!r} is not a message type of ROS 2 Jazzy{hint}')
    return types[type_name]


def serialize(message: Any) -> bytes:
    """Return the CDR bytes of a message made by `message_class`, the same every time.

    Raises
    ------
    MessageError
        If a field does not hold a value of its type.
    """
    try:
        return bytes(typestore().serialize_cdr(message, message.__msgtype__, little_endian=True))
    except (SerdeError, AttributeError, TypeError, ValueError, struct.error) as error:
        raise MessageError(f'cannot serialize a {type(message).__name__}: {error}') from error


def deserialize(data: bytes | memoryview, type_name: str) -> Any:
    """Return the message that CDR bytes hold; arrays are views of `data`.

    Raises
    ------
    MessageError
        If the type is not known, or the bytes are cut or are no such message.
    """
    message_class(type_name)
    try:
        return typestore().deserialize_cdr(data, type_name)
    except (SerdeError, IndexError, MemoryError, OverflowError) as error:
        raise MessageError(f'{len(data)} bytes are no {type_name}: {error}') from error


def header_stamp(data: bytes | memoryview, type_name: str) -> int | None:
    """Return the header stamp [ns] of a serialized message, None where the type has no header.

    Reads the first bytes alone: a header comes first, and its stamp first in it.

    Raises
    ------
    MessageError
        If the type is not known or the bytes are too few.
    """
    if not _starts_with_header(type_name):
        return None
    if len(data) < 12:
        raise MessageError(f'{len(data)} bytes are no {type_name}: the stamp is cut')
    order = 'little' if data[1] & 1 else 'big'
    seconds = int.from_bytes(data[4:8], order, signed=True)  # type: ignore[arg-type]
    nanoseconds = int.from_bytes(data[8:12], order)  # type: ignore[arg-type]
    return seconds * 1_000_000_000 + nanoseconds


@functools.cache
def _starts_with_header(type_name: str) -> bool:
    message_class(type_name)
    fields = typestore().fielddefs[type_name][1]
    return bool(fields) and fields[0][1] == (Nodetype.NAME, 'std_msgs/msg/Header')
