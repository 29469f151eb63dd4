"""How far the analysis is behind its stream."""

import time

import pytest

pytest.importorskip('rclpy', reason='rclpy is not installed')

import ros_support

from gear_dynamics.monitoring.health import Health
from gear_dynamics.monitoring.level import Level
from gear_dynamics.nodes.analyzer_health import AnalyzerHealth
from gear_dynamics.nodes.topics import Timed


def reported(waited, paced=True):
    health = AnalyzerHealth(Health(configured=True))
    health.paced = paced
    with health.block(waited):
        pass
    return health.stream()


def test_a_block_that_waited_long_is_a_warning():
    report = reported(3.0)
    assert report.level is Level.WARN
    assert report.message == 'the analysis is 3 s behind the stream'
    assert report.values['behind [s]'] == pytest.approx(3.0, abs=0.5)
    assert reported(0.0).level is Level.OK


def test_a_stream_that_waits_for_its_listeners_is_never_too_fast():
    report = reported(3.0, paced=False)
    assert report.level is Level.OK
    assert report.values['behind [s]'] >= 3.0


def test_the_difference_of_two_clocks_is_no_waiting(monkeypatch):
    found = []
    timed = Timed(lambda data, waited: found.append((data, waited)))
    # The clock of the sender is 5 s ahead; messages take 0.1 s and more, and the second waits 2 s.
    for now, sent, received in ((10.2, 15.0, 10.1), (13.3, 16.0, 11.3)):
        monkeypatch.setattr(time, 'time_ns', lambda now=now: round(now * 1e9))
        info = {'source_timestamp': round(sent * 1e9), 'received_timestamp': round(received * 1e9)}
        timed((b'1', info))  # as the events executor calls it
        timed(b'2', info)  # as the other executors do
    assert [data for data, _ in found] == [b'1', b'2'] * 2
    # 10.2 - 15 + 4.9, and 13.3 - 16 + 4.9
    assert [waited for _, waited in found] == pytest.approx([0.1, 0.1, 2.2, 2.2])


def test_the_plain_executor_tells_how_long_a_message_waited(client):
    """Each message takes 0.1 s: the last of four waits at least for the sleep of the others."""
    from std_msgs.msg import Float64

    found = []

    def slow(_, waited):
        found.append(waited)
        time.sleep(0.1)

    client.node.create_subscription(Float64, 'slow', Timed(slow), 100, raw=True)
    publisher = client.publisher(Float64, 'slow')
    for _ in range(4):
        publisher.publish(Float64())
    ros_support.wait_until(lambda: len(found) == 4)
    assert max(found) > 0.15
