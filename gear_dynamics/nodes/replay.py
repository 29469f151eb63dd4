"""The `replay` executable: plays a log back on its own topics, bytes unchanged."""

from __future__ import annotations

import dataclasses
import importlib
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock as ClockMessage
from std_srvs.srv import SetBool, Trigger
from tqdm import tqdm

from gear_dynamics.bag.log import Log
from gear_dynamics.bag.qos import first_profile
from gear_dynamics.bag.reader import LogMessage, read_messages
from gear_dynamics.bag.source import Damage, LogChannel, LogError
from gear_dynamics.nodes.diagnostics import Diagnostics, Level, Report
from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.player import Player
from gear_dynamics.nodes.publishing import clock_bytes, try_publish
from gear_dynamics.nodes.run import NodeError, run_node
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import ReplaySettings
from gear_dynamics.wire.messages import MessageError, deserialize, message_class

ABOUT = (
    'Plays a log back on its own topics: replay --ros-args -p log:=PATH. '
    'Topics are remapped with -r /FROM:=/TO.'
)

SECOND = 1_000_000_000

ACKNOWLEDGED = 3.0
"""Time that listeners have to receive the last messages [s]."""


class Replay:
    """Publishes the messages of a log with the recorded spacing."""

    def __init__(self, node: Node, parameters: NodeParameters) -> None:
        self._node = node
        self._settings = settings = parameters.get(ReplaySettings)
        self._paths = _paths(settings.log)
        self._played = self._skipped = 0
        try:
            with Log(self._paths, self._on_damage) as log:
                channels = _channels(log, settings.topics)
                self._begin, self._end = _span(log)
        except LogError as error:
            raise ParameterError(f'log: {error}') from error
        length = (self._end - self._begin) / SECOND
        if settings.start > length:
            raise ParameterError(f'start is {settings.start:g}: the log lasts {length:.6g} s')
        self._begin += round(settings.start * SECOND)
        if settings.duration:
            self._end = self._begin + round(settings.duration * SECOND)
        self._position = self._begin
        self._publishers = self._make_publishers(channels)
        self._latched = [
            name
            for name, c in channels.items()
            if _qos(c).durability == _LATCHED and self._plays(c)
        ]
        self._clock = (
            node.create_publisher(ClockMessage, '/clock', 10) if settings.publish_clock else None
        )
        node.create_service(SetBool, '~/pause', self._pause)
        node.create_service(Trigger, '~/step', self._step)
        self._diagnostics = Diagnostics(node, {'replay': self._report})
        total = (self._end - self._begin) / SECOND
        self._progress = tqdm(total=total, unit='s', disable=None, desc='replay')
        node.create_timer(0.1, self._watch, clock=Clock(clock_type=ClockType.STEADY_TIME))
        node.get_logger().info(
            f'playing {total:.6g} s of {len(self._publishers)} topics at rate {settings.rate:g}'
            + (', paused' if settings.paused else '')
        )
        self._player = Player(self._messages(), self._publish, settings.rate, settings.paused)

    def done(self) -> bool:
        """Tell whether all is played; raises `NodeError` if it cannot be."""
        if self._player.error is not None:
            raise NodeError(str(self._player.error)) from self._player.error
        return self._player.finished

    def close(self) -> None:
        """Stop, and let listeners have what was published last."""
        self._player.stop()
        end = time.monotonic() + ACKNOWLEDGED
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=max(end - time.monotonic(), 0.0)))
        self._diagnostics.close()
        self._progress.close()
        self._node.get_logger().info(f'played {self._played} messages, skipped {self._skipped}')

    def _plays(self, channel: LogChannel) -> bool:
        return channel.topic in self._publishers

    def _make_publishers(self, channels: dict[str, LogChannel]) -> dict[str, Publisher]:
        publishers = {}
        for topic, channel in channels.items():
            try:
                message_class(channel.type_name)  # without it a message cannot be checked
                type_ = _ros_type(channel.type_name)
            except (MessageError, ImportError, AttributeError) as error:
                self._node.get_logger().warning(f'{topic} is left out: {error}')
                continue
            qos = _qos(channel)
            if self._settings.rate == 0:
                qos.history = HistoryPolicy.KEEP_ALL
            publishers[topic] = self._node.create_publisher(type_, topic, qos)
        if not publishers:
            raise ParameterError('log: it has no topic that can be played')
        return publishers

    def _messages(self) -> Iterator[LogMessage]:
        """Iterate over what is to be published; runs in the thread that reads ahead."""
        while True:
            empty = True
            for message in self._one_pass():
                empty = False
                yield message
            if empty or not self._settings.loop:
                return

    def _one_pass(self) -> Iterator[LogMessage]:
        # Latched topics tell what holds: the rig's configuration counts wherever one begins.
        latest: dict[str, LogMessage] = {}
        if self._settings.start and self._latched:
            for message in read_messages(
                self._paths, self._latched, end=self._begin, on_damage=self._on_damage
            ):
                latest[message.channel.topic] = message
        for message in latest.values():
            yield dataclasses.replace(message, log_time=self._begin)
        for message in read_messages(
            self._paths, list(self._publishers), self._begin, self._end + 1, self._on_damage
        ):
            try:
                deserialize(message.data, message.channel.type_name)
            except MessageError as error:
                self._skip(f'{message.place}: {error}')
            else:
                yield message

    def _publish(self, message: LogMessage) -> bool:
        publisher = self._publishers[message.channel.topic]
        if not try_publish(publisher, message.data):
            return False
        if self._settings.rate == 0 and message.channel.topic in self._latched:
            # What comes after it means nothing without it, and must not overtake it.
            publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGED))
        self._played += 1
        self._position = message.log_time
        if self._clock is not None:
            self._clock.publish(clock_bytes(message.log_time))
        return True

    def _on_damage(self, damage: Damage) -> None:
        self._skip(str(damage))

    def _skip(self, what: str) -> None:
        self._skipped += 1
        self._node.get_logger().warning(f'skipped: {what}')

    def _watch(self) -> None:
        self._progress.n = round((self._position - self._begin) / SECOND, 1)
        self._progress.refresh()

    def _pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._player.pause(request.data)
        response.success = True
        response.message = 'paused' if request.data else 'playing'
        return response

    def _step(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = self._player.paused
        if response.success:
            self._player.step()
        response.message = 'one message' if response.success else 'it is not paused'
        return response

    def _report(self) -> Report:
        level = Level.WARN if self._skipped else Level.OK
        values = {
            'position [s]': (self._position - self._begin) / SECOND,
            'played': self._played,
            'skipped': self._skipped,
            'topics without a listener': sum(
                each.get_subscription_count() == 0 for each in self._publishers.values()
            ),
        }
        return Report(level, 'paused' if self._player.paused else 'playing', values)


_LATCHED = DurabilityPolicy.TRANSIENT_LOCAL
_DEEPEST = 10_000


def _paths(text: str) -> list[str]:
    """Return the logs that are named: one, though its name has a colon, or several."""
    return [text] if Path(text).exists() else text.split(':')


def _channels(log: Log, topics: Sequence[str]) -> dict[str, LogChannel]:
    """Return the channels to play by topic."""
    log.topics()  # learns the channels of a file without an index
    channels = {c.topic: c for source in log.sources for c in source.channels.values()}
    if not topics:
        return channels
    return {name: channels[name] for name in map(log.resolve, topics)}


def _span(log: Log) -> tuple[int, int]:
    """Return log times of the first and the last message [ns]."""
    filled = [count for count in log.contents().values() if count.messages]
    if not filled:
        raise LogError('there is no message that can be read')
    return min(count.start for count in filled), max(count.end for count in filled)


def _qos(channel: LogChannel) -> QoSProfile:
    """Return the QoS that a topic was published with, as far as it matters to a listener."""
    offered = first_profile(channel.qos)
    qos = QoSProfile(depth=max(1, min(offered.depth, _DEEPEST)))
    if offered.reliability == 'best_effort':
        qos.reliability = ReliabilityPolicy.BEST_EFFORT
    if offered.durability == 'transient_local':
        qos.durability = _LATCHED
    return qos


def _ros_type(name: str) -> type:
    package, kind, message = name.split('/')
    return getattr(importlib.import_module(f'{package}.{kind}'), message)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the node until the log is played; return the exit code."""
    return run_node('gear_replay', ABOUT, (ReplaySettings,), Replay, argv)


if __name__ == '__main__':
    sys.exit(main())
