"""A log is on the time scale of its stream, and holds the diagnostics of its own rig."""

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy')

import ros_support  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from sensor_msgs.msg import PointCloud2  # noqa: E402
from std_msgs.msg import Float64  # noqa: E402

from gear_dynamics import read_log  # noqa: E402
from gear_dynamics.bag.reader import read_messages  # noqa: E402
from gear_dynamics.wire.messages import deserialize  # noqa: E402

FACTOR = 3
ARGUMENTS = ['-r', '__ns:=/a']


def names_in(log):
    return {
        status.name
        for message in read_messages(log, ['/diagnostics'])
        for status in deserialize(message.data, 'diagnostic_msgs/msg/DiagnosticArray').status
    }


def analysed(health):
    """Return the number of blocks that the analyzer says it has analysed."""
    counts = [
        int(value.value)
        for each in health
        for status in each.status
        for value in status.values
        if status.name == 'a/gear_analyzer: stream' and value.key == 'blocks'
    ]
    return max(counts, default=0)


def test_commands_stand_where_their_ramp_begins_whatever_the_pace(domain, client, tmp_path):
    blocks = client.collect(PointCloud2, '/a/gear_pair/samples', raw=True)
    health = client.collect(DiagnosticArray, '/diagnostics')
    parameters = {'log_directory': tmp_path, 'log_free_floor': 0.0}
    pace = {'real_time_factor': FACTOR}
    with (
        ros_support.Process('gear_dynamics.nodes.analyzer', domain, parameters, ARGUMENTS) as node,
        ros_support.Process('gear_dynamics.nodes.sim', domain, pace, ARGUMENTS),
    ):
        node.wait_for('logging to', 120)
        other = client.publisher(DiagnosticArray, '/diagnostics')
        status = DiagnosticStatus(name='b/gear_sim: pace', level=DiagnosticStatus.OK)
        torque = client.publisher(Float64, '/a/gear_pair/cmd/torque')
        ros_support.wait_until(lambda: len(blocks) > 2000, 120, '20 s of the stream')
        torque.publish(Float64(data=100.0))
        other.publish(DiagnosticArray(status=[status]))
        goal = len(blocks) + 300
        ros_support.wait_until(lambda: analysed(health) > goal, 120, 'the analyzer to come so far')
        assert node.stop() == 0
    (log,) = tmp_path.glob('gear_log_a_*')
    load = read_log(log, 'gear_pair/samples', columns=['t', 'load_torque'])
    begin = load['t'][np.argmax(load['load_torque'] < 149.9)]
    (command,) = read_log(log, 'gear_pair/cmd/torque')
    # On the wall clock it would stand some 13 s before; a busy machine may be late by a second.
    assert abs(command['t'] - begin) < 1.0 * FACTOR
    for topic in ('gear_pair/condition', 'gear_pair/events', '/diagnostics'):
        t = read_log(log, topic)['t']
        assert load['t'][-1] - FACTOR * 2.5 < t.max() < load['t'][-1] + 1, topic
    assert {name.partition('/')[0] for name in names_in(log)} == {'a'}


def test_diagnostics_bear_the_time_of_the_clock_while_there_is_no_other(domain, client):
    health = client.collect(DiagnosticArray, '/diagnostics')
    parameters = {'use_sim_time': True, 'log': False}
    with ros_support.Process('gear_dynamics.nodes.analyzer', domain, parameters) as node:
        ros_support.wait_until(lambda: health, 120, 'diagnostics')
        assert node.stop() == 0
    assert health[0].header.stamp.sec > 1.7e9
    assert all(status.message for each in health for status in each.status)
