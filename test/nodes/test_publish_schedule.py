"""Messages of a block go out evenly over its duration, in order, and none is kept too long."""

import pytest

pytest.importorskip('rclpy')

from gear_dynamics.nodes import publish_schedule


class Timer:
    running = True

    def cancel(self):
        self.running = False

    def reset(self):
        self.running = True


class Node:
    def create_timer(self, period, callback, clock):
        self.callback = callback
        self.timer = Timer()
        return self.timer


class Topic(list):
    publish = list.append


@pytest.fixture
def clock(monkeypatch):
    """A clock that the test sets [ns]."""
    now = [0]
    monkeypatch.setattr(publish_schedule.time, 'monotonic_ns', lambda: now[0])
    return now


def block(topic, name, count, duration_ns=10_000_000):
    return [publish_schedule.Due(i * duration_ns / count, topic, (name, i)) for i in range(count)]


def test_each_tick_publishes_its_share(clock):
    node, one, two = Node(), Topic(), Topic()
    messages = publish_schedule.PublishSchedule(node)
    assert not node.timer.running
    messages.put(block(one, 'a', 20) + block(two, 'b', 10))
    counts = []
    for tick in range(1, 6):
        clock[0] = round(tick * publish_schedule.TICK * 1e9)
        node.callback()
        counts.append((len(one), len(two)))
    before = [(0, 0), *counts]
    shares = [b[0] - a[0] for a, b in zip(before, counts, strict=False)]
    assert max(shares) <= 7
    assert one == [('a', i) for i in range(20)]
    assert two == [('b', i) for i in range(10)]
    assert not node.timer.running


def test_the_next_block_pushes_out_the_one_before(clock):
    node, topic = Node(), Topic()
    messages = publish_schedule.PublishSchedule(node)
    messages.put(block(topic, 'a', 5))
    messages.put(block(topic, 'b', 5))
    assert topic == [('a', i) for i in range(5)]
    assert node.timer.running
    messages.flush()
    assert topic[5:] == [('b', i) for i in range(5)]


def test_without_a_pace_all_goes_out_at_once(clock):
    node, topic = Node(), Topic()
    publish_schedule.PublishSchedule(node).put(block(topic, 'a', 5, duration_ns=0))
    assert len(topic) == 5
    assert not node.timer.running
