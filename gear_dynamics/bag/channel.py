"""What is read from a log: channels, messages, and the damage that was found."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import NamedTuple


class LogError(ValueError):
    """A log cannot be read at all; the message says why."""


@dataclasses.dataclass(frozen=True)
class Damage:
    """A place in a log that could not be read.

    Attributes
    ----------
    path : Path
        The file.
    offset : int
        Byte at which it begins.
    reason : str
        What is wrong, and what was skipped.
    loss : bool
        Whether messages may have been lost.
    """

    path: Path
    offset: int
    reason: str
    loss: bool = True

    def __str__(self) -> str:
        return f'{self.path.name}, byte {self.offset}: {self.reason}'


@dataclasses.dataclass(frozen=True)
class LogChannel:
    """A topic as a log has it.

    Attributes
    ----------
    topic, type_name : str
        As they stand in the file; the type is empty where there is no schema.
    encoding : str
        Of the messages; 'cdr' in logs of ROS 2.
    schema_encoding : str
        'ros2msg', for one.
    schema : bytes
        Definition of the type.
    metadata : tuple of (str, str)
        Further metadata of the channel.
    """

    topic: str
    type_name: str
    encoding: str = 'cdr'
    schema_encoding: str = ''
    schema: bytes = b''
    metadata: tuple[tuple[str, str], ...] = ()

    @property
    def type_hash(self) -> str:
        """Type hash of REP 2011; empty where it is not known."""
        return dict(self.metadata).get('topic_type_hash', '')

    @property
    def qos(self) -> str:
        """Offered QoS profiles as YAML; empty where they are not known."""
        return dict(self.metadata).get('offered_qos_profiles', '')


class ReadMessage(NamedTuple):
    """A message as it stands in a file; `data` is a view of the records at `offset`."""

    channel: LogChannel
    sequence: int
    log_time: int
    publish_time: int
    data: memoryview
    offset: int


@dataclasses.dataclass
class ChannelCount:
    """Messages of a channel in a file, and log times of the first and the last [ns]."""

    messages: int = 0
    start: int = 0
    end: int = 0

    def add(self, log_time: int) -> None:
        """Count a message."""
        self.start = min(self.start, log_time) if self.messages else log_time
        self.end = max(self.end, log_time)
        self.messages += 1

    def merge(self, other: ChannelCount) -> None:
        """Add what was counted elsewhere."""
        if other.messages:
            self.start = min(self.start, other.start) if self.messages else other.start
            self.end = max(self.end, other.end)
            self.messages += other.messages
