"""What a replay plays and when: the messages of a log, pass after pass; no ROS."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import NamedTuple

from gear_dynamics.bag.channel import Damage, LogChannel
from gear_dynamics.bag.reader import LogMessage, read_messages
from gear_dynamics.wire.messages import MessageError, deserialize, message_class, serialize
from gear_dynamics.wire.topics import CONFIGURATION

SHORTEST_PASS = 10_000_000
"""Least time from one pass to the next [ns]: a loop of one message must not use a whole CPU."""


class Item(NamedTuple):
    """A message to play."""

    due_ns: int
    """On a scale that begins with 0 and never goes back [ns]."""
    pass_number: int
    """How often the log is being played; the first pass is 1."""
    message: LogMessage


@dataclasses.dataclass(frozen=True)
class Playlist:
    """The messages of a part of a log in the order in which they are played.

    Every pass begins with what latched topics held before the part, and with the configuration of
    the rig in any case: what comes before it means nothing to a listener. From the second pass on
    each configuration announces the pass, since the stamps of a pass begin anew: see
    docs/interfaces.md.

    Attributes
    ----------
    paths : sequence of str
        The log.
    topics, latched : collection of str
        What to play; which of these topics are latched.
    begin, end : int
        Log times of the first and the last message that may be played [ns].
    loop : bool
        Whether to begin again at the end, for ever.
    on_damage, on_message_error : callable
        Told of places and messages that cannot be read.
    """

    paths: Sequence[str]
    topics: Collection[str]
    latched: Collection[str]
    begin: int
    end: int
    loop: bool
    on_damage: Callable[[Damage], None]
    on_message_error: Callable[[str], None]

    def __iter__(self) -> Iterator[Item]:
        period = max(self.end - self.begin, SHORTEST_PASS)
        held = self._held_at_the_begin()
        number = 1
        while True:
            empty = True
            for message in self._one_pass(held):
                empty = False
                due = message.log_time - self.begin + (number - 1) * period
                if number > 1 and _is_configuration(message.channel):
                    message = _announced(message, number)
                yield Item(due, number, message)
            if empty or not self.loop:
                return
            number += 1

    def _held_at_the_begin(self) -> list[LogMessage]:
        """Return the latched messages that every pass begins with."""
        held: dict[str, LogMessage] = {}
        if self.latched:
            for message in read_messages(
                self.paths, self.latched, end=self.begin, on_damage=self.on_damage
            ):
                held[message.channel.topic] = message
        for topic in self.latched:
            if topic not in held and topic.endswith(f'/{CONFIGURATION.name}'):
                part = read_messages(self.paths, [topic], self.begin, self.end + 1, self.on_damage)
                held.update({each.channel.topic: each for each in itertools.islice(part, 1)})
        return list(held.values())

    def _one_pass(self, held: Sequence[LogMessage]) -> Iterator[LogMessage]:
        part = read_messages(
            self.paths, list(self.topics), self.begin, self.end + 1, self.on_damage
        )
        first = (dataclasses.replace(message, log_time=self.begin) for message in held)
        for message in itertools.chain(first, _without(part, held)):
            try:
                deserialize(message.data, message.channel.type_name)
            except MessageError as error:
                self.on_message_error(f'{message.place}: {error}')
            else:
                yield message


def _without(part: Iterator[LogMessage], held: Sequence[LogMessage]) -> Iterator[LogMessage]:
    """Leave out what was played already, once each: logs that are joined may repeat a message."""
    places = {(message.channel.topic, message.log_time) for message in held}
    for message in part:
        place = message.channel.topic, message.log_time
        if place in places:
            places.remove(place)
        else:
            yield message


def _is_configuration(channel: LogChannel) -> bool:
    return channel.type_name == CONFIGURATION.type_name and channel.topic.endswith(
        f'/{CONFIGURATION.name}'
    )


def _announced(message: LogMessage, number: int) -> LogMessage:
    """Return a configuration that tells the number of the pass."""
    text = deserialize(message.data, CONFIGURATION.type_name).data
    text = f'{text.rstrip()}\nreplay: {{pass: {number}}}\n'
    return dataclasses.replace(
        message, data=serialize(message_class(CONFIGURATION.type_name)(text))
    )
