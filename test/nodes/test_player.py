"""Spacing, pause and step of the player, by the recorded times alone."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest

from gear_dynamics.bag.channel import LogChannel
from gear_dynamics.bag.reader import LogMessage
from gear_dynamics.nodes.player import Player
from gear_dynamics.nodes.playlist import Item

CHANNEL = LogChannel('/x', 'std_msgs/msg/Float64')


def log(count, spacing):
    """Return messages that are due `spacing` seconds apart."""
    times = [round(i * spacing * 1e9) for i in range(count)]
    return [
        Item(t, 1, LogMessage(CHANNEL, b'%d' % i, t, t, Path('x'), 0)) for i, t in enumerate(times)
    ]


class Sink(list):
    """Takes messages and notes when."""

    def __call__(self, message):
        self.append((time.monotonic(), message))
        return True

    @property
    def times(self):
        return np.array([each[0] for each in self])


@pytest.fixture
def play():
    players = []

    def _play(*arguments, rate=1.0, paused=False):
        players.append(Player(*arguments, rate, paused))
        return players[-1]

    yield _play
    for player in players:
        player.stop()


def wait(condition, timeout=20.0):
    end = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


@pytest.mark.parametrize('rate', [1.0, 4.0])
def test_lateness_does_not_add_up(play, rate):
    sink = Sink()
    player = play(log(101, 0.01), sink, rate=rate)
    wait(lambda: player.finished)
    assert len(sink) == 101
    assert sink[-1][0] - sink[0][0] == pytest.approx(1 / rate, abs=0.1)


def test_rate_zero_does_not_wait(play):
    sink = Sink()
    player = play(log(1000, 1000.0), sink, rate=0.0)
    wait(lambda: player.finished)
    assert [item.message.data for _, item in sink] == [b'%d' % i for i in range(1000)]


def test_sink_that_cannot_yet_is_asked_again(play):
    taken, asked = [], []

    def sink(message):
        asked.append(message)
        if len(asked) % 3:
            return False
        taken.append(message)
        return True

    player = play(log(10, 0.0), sink)
    wait(lambda: player.finished)
    assert [item.message.data for item in taken] == [b'%d' % i for i in range(10)]


def test_pause_holds_time_and_step_plays_one(play):
    sink = Sink()
    player = play(log(1000, 0.01), sink, paused=True)
    time.sleep(0.1)
    assert not sink
    player.step()
    wait(lambda: len(sink) == 1)
    player.step()
    wait(lambda: len(sink) == 2)
    time.sleep(0.1)
    assert len(sink) == 2
    resumed = time.monotonic()
    player.pause(False)
    wait(lambda: len(sink) == 12)
    # 0.1 s after the resume: what was missed in the pause is not caught up.
    assert sink.times[11] - resumed > 0.095
    player.pause(True)
    heard = len(sink)
    time.sleep(0.1)
    assert len(sink) <= heard + 1


def test_error_of_the_log_is_kept(play):
    def broken():
        yield from log(3, 0.0)
        raise OSError('the disk is gone')

    sink = Sink()
    player = play(broken(), sink)
    wait(lambda: player.error is not None)
    assert len(sink) == 3
    assert not player.finished
    assert 'the disk is gone' in str(player.error)


def test_stop_ends_both_threads_wherever_they_are(play):
    before = threading.active_count()
    endless = (message for _ in iter(int, 1) for message in log(1, 0.0))
    players = [
        play(log(10, 1000.0), Sink()),
        play(endless, Sink(), rate=0.0),
        play(log(10, 0.0), lambda message: False),
        play(log(1000, 0.01), Sink(), paused=True),
    ]
    time.sleep(0.1)
    for player in players:
        player.stop()
    assert threading.active_count() == before
