"""The `replay` executable: plays a log back on its own topics, bytes unchanged."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import HistoryPolicy
from std_srvs.srv import SetBool, Trigger
from tqdm import tqdm

from gear_dynamics.bag.channel import Damage, LogChannel, LogError
from gear_dynamics.bag.log import Log
from gear_dynamics.monitoring.level import Level
from gear_dynamics.nodes.diagnostics import Diagnostics, Report
from gear_dynamics.nodes.listeners import Listeners
from gear_dynamics.nodes.parameters import NodeParameters
from gear_dynamics.nodes.player import Player
from gear_dynamics.nodes.playlist import Item, Playlist
from gear_dynamics.nodes.replay_topics import recorded_qos, replayed_names
from gear_dynamics.nodes.run import NodeError, run_node
from gear_dynamics.nodes.stream import clock_bytes, try_publish
from gear_dynamics.nodes.topics import profile, publisher, ros_type
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import ReplaySettings
from gear_dynamics.wire.messages import MessageError, message_class
from gear_dynamics.wire.topics import CLOCK

ABOUT = (
    'Plays a log back on its own topics: replay --ros-args -p log:=PATH. '
    'Topics are remapped with -r /FROM:=/TO, a whole rig with -r __ns:=/NAMESPACE.'
)

SECOND = 1_000_000_000

ACKNOWLEDGED = 3.0
"""Time that listeners have to receive the last messages [s]."""

ACKNOWLEDGED_AT_RATE_0 = 60.0
"""The same at rate 0 [s]: thousands of messages may be on their way then."""

WATCH = 0.1
"""Time between two looks at progress and listeners [s]."""


class Replay:
    """Publishes the messages of a log with the recorded spacing."""

    def __init__(self, node: Node, parameters: NodeParameters) -> None:
        self._node = node
        self._settings = settings = parameters.get(ReplaySettings)
        self._played = self._skipped = 0
        self._pass = 1
        self._end_of_patience: float | None = None
        paths = _paths(settings.log)
        try:
            with Log(paths, self._on_damage) as log:
                channels = _channels(log, settings.topics)
                self._begin, self._end = _part(log, settings)
        except LogError as error:
            raise ParameterError(f'log: {error}') from error
        self._position = self._begin
        self._publishers = self._make_publishers(channels)
        self._latched = {
            topic
            for topic in self._publishers
            if recorded_qos(channels[topic]).durability == 'transient_local'
        }
        self._clock = publisher(node, CLOCK) if settings.publish_clock else None
        node.create_service(SetBool, '~/pause', self._pause)
        node.create_service(Trigger, '~/step', self._step)
        self._diagnostics = Diagnostics(node, {'replay': self._report})
        playlist = Playlist(
            paths,
            list(self._publishers),
            self._latched,
            self._begin,
            self._end,
            settings.loop,
            self._on_damage,
            self._skip,
        )
        self._player = Player(playlist, self._publish, settings.rate, paused=True)
        self._waiting = self._wait_for_listeners()
        self._tell()

    def done(self) -> bool:
        """Tell whether all is played and was received; raises `NodeError` if it cannot be."""
        if self._player.error is not None:
            raise NodeError(str(self._player.error)) from self._player.error
        if not self._player.finished:
            return False
        now = time.monotonic()
        if self._end_of_patience is None:
            patience = ACKNOWLEDGED_AT_RATE_0 if self._settings.rate == 0 else ACKNOWLEDGED
            self._end_of_patience = now + patience
        return now >= self._end_of_patience or self._acknowledged(0.0)

    def close(self) -> None:
        """Stop, and let listeners have what was published last."""
        self._player.stop()
        if not self._player.finished:
            self._acknowledged(ACKNOWLEDGED)
        self._diagnostics.close()
        self._progress.close()
        self._node.get_logger().info(f'played {self._played} messages, skipped {self._skipped}')

    def _make_publishers(self, channels: dict[str, LogChannel]) -> dict[str, Publisher]:
        publishers = {}
        names = replayed_names(channels, self._node.get_namespace())
        for topic, channel in channels.items():
            try:
                message_class(channel.type_name)  # without it a message cannot be checked
                type_ = ros_type(channel.type_name)
            except (MessageError, ImportError, AttributeError) as error:
                self._node.get_logger().warning(f'{topic} is left out: {error}')
                continue
            qos = profile(recorded_qos(channel))
            if self._settings.rate == 0:
                qos.history = HistoryPolicy.KEEP_ALL
            publishers[topic] = self._node.create_publisher(type_, names[topic], qos)
        if not publishers:
            raise ParameterError('log: it has no topic that can be played')
        return publishers

    def _wait_for_listeners(self) -> Listeners | None:
        """Return what is waited for before playing; None if it begins paused."""
        self._node.create_timer(WATCH, self._watch, clock=Clock(clock_type=ClockType.STEADY_TIME))
        if self._settings.paused:
            return None
        publishers = list(self._publishers.values())
        patience = self._settings.listener_wait
        return Listeners(self._node, publishers, patience, time.monotonic())

    def _tell(self) -> None:
        total = (self._end - self._begin) / SECOND
        self._progress = tqdm(total=total, unit='s', disable=None, desc='replay')
        self._node.get_logger().info(
            f'playing {total:.6g} s of {len(self._publishers)} topics '
            f'at rate {self._settings.rate:g}' + (', paused' if self._settings.paused else '')
        )

    def _watch(self) -> None:
        self._progress.n = round((self._position - self._begin) / SECOND, 1)
        self._progress.refresh()
        waiting = self._waiting
        if waiting is not None and waiting.complete(time.monotonic()):
            if not waiting.connected:
                self._node.get_logger().warning(
                    f'nobody listens after {self._settings.listener_wait:g} s: playing all the '
                    'same; listener_wait is how long to wait'
                )
            self._waiting = None
            self._player.pause(False)

    def _publish(self, item: Item) -> bool:
        message = item.message
        topic = message.channel.topic
        if item.pass_number != self._pass:
            self._acknowledged(ACKNOWLEDGED)
            self._pass = item.pass_number
        if not try_publish(self._publishers[topic], message.data):
            return False
        if topic in self._latched and (self._settings.rate == 0 or self._pass > 1):
            # What comes after it means nothing without it, and must not overtake it.
            self._publishers[topic].wait_for_all_acked(Duration(seconds=ACKNOWLEDGED))
        self._played += 1
        self._position = message.log_time
        if self._clock is not None:
            self._clock.publish(clock_bytes(message.log_time))
        return True

    def _acknowledged(self, patience: float) -> bool:
        """Tell whether listeners have received all that was published, or do so in time [s]."""
        end = time.monotonic() + patience
        return all(
            each.wait_for_all_acked(Duration(seconds=max(end - time.monotonic(), 0.0)))
            for each in self._publishers.values()
        )

    def _on_damage(self, damage: Damage) -> None:
        self._skip(str(damage))

    def _skip(self, what: str) -> None:
        self._skipped += 1
        self._node.get_logger().warning(f'skipped: {what}')

    def _pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._waiting = None
        self._player.pause(request.data)
        response.success = True
        response.message = 'paused' if request.data else 'playing'
        return response

    def _step(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._waiting = None
        response.success = self._player.paused
        if response.success:
            self._player.step()
        response.message = 'one message' if response.success else 'it is not paused'
        return response

    def _report(self) -> Report:
        level = Level.WARN if self._skipped else Level.OK
        state = 'paused' if self._player.paused else 'playing'
        values = {
            'position [s]': (self._position - self._begin) / SECOND,
            'pass': self._pass,
            'played': self._played,
            'skipped': self._skipped,
            'topics without a listener': sum(
                each.get_subscription_count() == 0 for each in self._publishers.values()
            ),
        }
        return Report(level, 'waiting for listeners' if self._waiting else state, values)


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


def _part(log: Log, settings: ReplaySettings) -> tuple[int, int]:
    """Return the log times between which to play [ns].

    Raises
    ------
    ParameterError
        If `start` is behind the end of the log.
    """
    begin, end = _span(log)
    length = (end - begin) / SECOND
    if settings.start > length:
        raise ParameterError(f'start is {settings.start:g}: the log lasts {length:.6g} s')
    begin += round(settings.start * SECOND)
    if settings.duration:
        end = begin + round(settings.duration * SECOND)
    return begin, end


def _span(log: Log) -> tuple[int, int]:
    """Return log times of the first and the last message [ns]."""
    filled = [count for count in log.contents().values() if count.messages]
    if not filled:
        raise LogError('there is no message that can be read')
    return min(count.start for count in filled), max(count.end for count in filled)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the node until the log is played; return the exit code."""
    return run_node('gear_replay', ABOUT, (ReplaySettings,), Replay, argv)


if __name__ == '__main__':
    sys.exit(main())
