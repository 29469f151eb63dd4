"""The analyzer finds in a replayed log what it found live."""

import pytest

rclpy = pytest.importorskip('rclpy')

import ros_support  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from sensor_msgs.msg import PointCloud2  # noqa: E402

from gear_dynamics.wire.messages import deserialize  # noqa: E402
from gear_dynamics.wire.tables import decode_table  # noqa: E402

ANALYZER = 'gear_dynamics.nodes.analyzer'
TABLES = ('spectrum', 'envelope_spectrum', 'order_spectrum', 'poincare')
RESULTS = (*TABLES, 'condition')
RIG = ('gear_pair/samples', 'gear_pair/events', 'gear_pair/configuration')


def listen(client, prefix):
    kinds = dict.fromkeys(TABLES, PointCloud2) | {'condition': DiagnosticArray}
    return {
        name: client.collect(kind, f'{prefix}/gear_pair/{name}', raw=True)
        for name, kind in kinds.items()
    }


def tables_by_stamp(messages):
    tables = [decode_table(each) for each in messages]
    return {table.stamp_ns: table.rows.tobytes() for table in tables}


def conditions(messages):
    """What each status says, without the name of its rig, by stamp, subject and keys."""
    found = {}
    for data in messages:
        message = deserialize(data, 'diagnostic_msgs/msg/DiagnosticArray')
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        for status in message.status:
            subject = status.name.split(': ')[1]
            keys = tuple(each.key for each in status.values)
            values = [each.value for each in status.values]
            found[stamp, subject, keys] = status.level, status.message, values
    return found


def test_replayed_log_gives_the_results_of_the_live_run(domain, client, tmp_path):
    live = listen(client, '/live')
    parameters = {'log_directory': tmp_path, 'log_free_floor': 0.0}
    with ros_support.Process(ANALYZER, domain, parameters, ['-r', '__ns:=/live']) as analyzer:
        ros_support.wait_until(
            lambda: client.node.count_subscribers('/live/gear_pair/samples'), 120, 'the analyzer'
        )
        with ros_support.Process('gear_dynamics.nodes.sim', domain, {}, ['-r', '__ns:=/live']):
            ros_support.wait_until(
                lambda: all(len(messages) >= 4 for messages in live.values()), 120, 'results'
            )
        assert analyzer.stop() == 0
    (log,) = tmp_path.glob('gear_log_*')

    replayed = listen(client, '/again')
    again = ['-r', '__ns:=/again']
    topics = '[' + ', '.join(f'/live/{name}' for name in RIG) + ']'
    to = [part for name in RIG for part in ('-r', f'/live/{name}:=/again/{name}')]
    with (
        ros_support.Process(ANALYZER, domain, {'log': False}, again) as analyzer,
        ros_support.Process(
            'gear_dynamics.nodes.replay',
            domain,
            {'log': log, 'topics': topics, 'rate': 0, 'listener_wait': 120},
            to,
        ) as replay,
    ):
        assert replay.wait(150) == 0
        ros_support.wait_until(
            lambda: all(len(replayed[name]) >= len(live[name]) for name in RESULTS),
            30,
            'as many results as live',
        )
        assert analyzer.stop() == 0
    for name in RESULTS:
        by_stamp = tables_by_stamp if name in TABLES else conditions
        before, after = by_stamp(live[name]), by_stamp(replayed[name])
        # Whatever the log has, the analyzer gets; live, it may have lost its last results.
        assert not before.keys() - after.keys(), name
        for stamp in before.keys() & after.keys():
            assert before[stamp] == after[stamp], (name, stamp)
    subjects = {subject for _, subject, _ in before}
    assert {'motion', 'contact', 'mesh_force'} <= subjects
