"""A log plays back as it was recorded: bytes, spacing, and nothing lost."""

import contextlib
import shutil
import signal
import time
from pathlib import Path

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy')

import ros_support  # noqa: E402
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from sensor_msgs.msg import PointCloud2  # noqa: E402
from std_msgs.msg import String  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402

from gear_dynamics.bag.metadata import OfferedQos  # noqa: E402
from gear_dynamics.bag.writer import LogWriter  # noqa: E402
from gear_dynamics.wire.messages import message_class, serialize  # noqa: E402
from gear_dynamics.wire.tables import SAMPLES_FLOAT32, encode_table  # noqa: E402

REPLAY = 'gear_dynamics.nodes.replay'
TABLE = 'sensor_msgs/msg/PointCloud2'
TEXT = 'std_msgs/msg/String'
BEGIN = 1_700_000_000 * 10**9
BLOCKS = 200
DAMAGED = 120


def block(number):
    rows = np.zeros(512, SAMPLES_FLOAT32)
    rows['mesh_force'] = np.random.default_rng(number).normal(size=512)
    return encode_table(rows, BEGIN + number * 10_000_000, 'line_of_action')


@pytest.fixture(scope='module')
def log(tmp_path_factory):
    """Two seconds of blocks, one of them cut, and a latched text at the very beginning."""
    writer = LogWriter(tmp_path_factory.mktemp('logs'), {}, free_floor=1.0)
    latched = OfferedQos(depth=1, durability='transient_local')
    text = serialize(message_class(TEXT)('the rig'))
    writer.write('/gear_pair/configuration', TEXT, text, BEGIN, BEGIN, latched)
    for number in range(BLOCKS):
        data = block(number)[:-7] if number == DAMAGED else block(number)
        at = BEGIN + number * 10_000_000
        writer.write('/gear_pair/samples', TABLE, data, at, at, OfferedQos(depth=100))
    return writer.close().path


def sound():
    return [block(number) for number in range(BLOCKS) if number != DAMAGED]


def bytes_of(message):
    """Return what was sent: the middleware pads it with zeros to a multiple of 4 bytes."""
    size = len(block(0))
    assert bytes(message[size:]) == bytes(-size % 4)
    return bytes(message[:size])


def resume(client):
    client.call(SetBool, 'gear_replay/pause', SetBool.Request(data=False))


def matched(client, topic):
    """Wait until the replay's publisher and our subscription know each other."""
    ros_support.wait_until(lambda: client.node.count_publishers(topic), 60, topic)
    time.sleep(0.5)


def test_bytes_and_spacing_are_those_recorded(domain, client, log):
    arrived = []
    texts = client.collect(
        String, '/gear_pair/configuration', QoSProfile(depth=1, durability=LATCHED)
    )
    client.node.create_subscription(
        PointCloud2,
        '/gear_pair/samples',
        lambda data: arrived.append((time.monotonic(), data)),
        1000,
        raw=True,
    )
    with ros_support.Process(REPLAY, domain, {'log': log, 'paused': True}) as replay:
        matched(client, '/gear_pair/samples')
        resume(client)
        assert replay.wait(60) == 0
        assert 'skipped: ' in replay.output
        for word in ('FATAL', 'Error occurred', 'Traceback', 'Exception'):
            assert word not in replay.output
        assert 'topic /gear_pair/samples' in replay.output
        assert str(BEGIN + DAMAGED * 10_000_000) in replay.output
    ros_support.wait_until(lambda: len(arrived) == BLOCKS - 1, 10, 'every block')
    assert [bytes_of(data) for _, data in arrived] == sound()
    assert [each.data for each in texts] == ['the rig']
    # 199 spacings of 10 ms; a benchmark tells how even they are.
    assert arrived[-1][0] - arrived[0][0] == pytest.approx(1.99, abs=0.3)


def test_rate_zero_loses_nothing_though_the_listener_is_slow(domain, client, log):
    arrived = []

    def hear(data):
        time.sleep(0.01)
        arrived.append(bytes_of(data))

    keep_all = QoSProfile(history=HistoryPolicy.KEEP_ALL)
    client.node.create_subscription(PointCloud2, '/rig/samples', hear, keep_all, raw=True)
    parameters = {'log': log, 'paused': True, 'rate': 0, 'topics': '[gear_pair/samples]'}
    arguments = ['-r', '/gear_pair/samples:=/rig/samples']
    with ros_support.Process(REPLAY, domain, parameters, arguments) as replay:
        matched(client, '/rig/samples')
        assert not client.node.count_publishers('/gear_pair/configuration')
        resume(client)
        assert replay.wait(60) == 0
    ros_support.wait_until(lambda: len(arrived) == BLOCKS - 1, 20, 'every block')
    assert arrived == sound()


def test_steps_clock_start_duration_and_loop(domain, client, log):
    blocks = client.collect(PointCloud2, '/gear_pair/samples', raw=True)
    clocks = client.collect(Clock, '/clock')
    latched = QoSProfile(depth=1, durability=LATCHED)
    texts = client.collect(String, '/gear_pair/configuration', latched)
    parameters = {
        'log': log,
        'paused': True,
        'start': 0.5,
        'duration': 0.2,
        'loop': True,
        'publish_clock': True,
    }
    with ros_support.Process(REPLAY, domain, parameters) as replay:
        matched(client, '/gear_pair/samples')
        for _ in range(2):
            assert client.call(Trigger, 'gear_replay/step', Trigger.Request()).success
        ros_support.wait_until(lambda: blocks, 10, 'the block stepped to')
        # The latched text of before the start comes first.
        assert [each.data for each in texts] == ['the rig']
        assert [bytes_of(each) for each in blocks] == [block(50)]
        resume(client)
        assert not client.call(Trigger, 'gear_replay/step', Trigger.Request()).success
        ros_support.wait_until(lambda: len(blocks) > 50, 20, 'the log once more')
        assert replay.stop() == 0
    once = [block(number) for number in range(50, 71)]
    assert [bytes_of(each) for each in blocks[:42]] == 2 * once
    stamps = [each.clock.sec * 10**9 + each.clock.nanosec for each in clocks]
    assert BEGIN + 510_000_000 in stamps
    assert set(stamps) <= {BEGIN + number * 10_000_000 for number in range(50, 71)}


def test_a_path_with_a_colon_is_one_log_and_others_are_several(domain, log, tmp_path):
    (file,) = Path(log).glob('*.mcap')
    copy = shutil.copy(file, tmp_path / 'run 12:30.mcap')
    for path, messages in ((str(copy), BLOCKS), (f'{log}:{file}', 2 * BLOCKS)):
        with ros_support.Process(REPLAY, domain, {'log': path, 'rate': 0}) as replay:
            assert replay.wait(60) == 0
            assert f'played {messages} messages' in replay.output


def test_listeners_that_hang_do_not_hold_up_the_end(domain, client, tmp_path):
    """Each of many topics has one; all of them have one deadline."""
    writer = LogWriter(tmp_path, {}, free_floor=1.0)
    for number in range(5):
        writer.write(f'/rig{number}/gear_pair/samples', TABLE, block(number), BEGIN, BEGIN)
    parameters = {'log': writer.close().path, 'paused': True}
    listener = str(Path(__file__).with_name('listener.py'))
    with contextlib.ExitStack() as stack:
        listeners = [
            stack.enter_context(
                ros_support.Process(listener, domain, arguments=['-r', f'__ns:=/rig{number}'])
            )
            for number in range(5)
        ]
        replay = stack.enter_context(ros_support.Process(REPLAY, domain, parameters))
        for number in range(5):
            topic = f'/rig{number}/gear_pair/samples'
            ros_support.wait_until(lambda t=topic: client.node.count_subscribers(t), 60, topic)
            matched(client, topic)
        for each in listeners:
            each.send(signal.SIGSTOP)
        resume(client)
        # SIGKILL would follow 5 s after SIGINT, so that this is a promise and no timing.
        assert replay.wait(9) == 0


@pytest.mark.parametrize(
    ('parameters', 'words'),
    [
        ({}, ['log', '-p log:=PATH']),
        ({'log': '/no/such/log'}, ['/no/such/log']),
        ({'topics': '[gear_pair/sample]'}, ['gear_pair/sample', '/gear_pair/samples']),
        ({'rate': -1.0}, ['rate', '-1']),
        ({'start': 1000.0}, ['start is 1000: the log lasts 1.99 s']),
    ],
)
def test_wrong_input_at_the_start_gives_a_line_and_exit_code_2(domain, log, parameters, words):
    given = {'log': log, **parameters} if parameters else {}
    with ros_support.Process(REPLAY, domain, given) as replay:
        assert replay.wait(60) == 2
        (line,) = replay.output.splitlines()
        assert line.startswith('gear_replay: ')
        assert all(word in line for word in words), line


LATCHED = DurabilityPolicy.TRANSIENT_LOCAL
