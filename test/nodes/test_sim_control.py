"""Pace, pause, reset, clock and monitor topics of a running sim."""

import dataclasses
import math
import signal
import time

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy')

import ros_support  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from geometry_msgs.msg import AccelStamped, WrenchStamped  # noqa: E402
from rclpy.qos import HistoryPolicy, QoSProfile  # noqa: E402
from rosgraph_msgs.msg import Clock  # noqa: E402
from sensor_msgs.msg import JointState, PointCloud2  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402

from gear_dynamics import GearPair  # noqa: E402
from gear_dynamics.wire.tables import decode_table  # noqa: E402

SIM = 'gear_dynamics.nodes.sim'


@dataclasses.dataclass
class Blocks:
    """What a client heard on gear_pair/samples."""

    messages: list

    def wait(self, count, timeout=120.0):
        """Wait for that many more blocks."""
        goal = len(self.messages) + count
        ros_support.wait_until(lambda: len(self.messages) >= goal, timeout, f'{count} blocks')

    @property
    def stamps(self):
        return np.array([decode_table(each).stamp_ns for each in self.messages])

    @property
    def last(self):
        return decode_table(self.messages[-1])


def nanoseconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def test_pause_and_reset_set_the_stamps_to_the_clock(domain, client):
    blocks = Blocks(client.collect(PointCloud2, 'gear_pair/samples', raw=True))
    with ros_support.Process(SIM, domain) as sim:
        blocks.wait(50)
        assert client.call(SetBool, 'gear_sim/pause', SetBool.Request(data=True)).success
        time.sleep(0.3)
        heard = len(blocks.messages)
        time.sleep(1.0)
        assert len(blocks.messages) == heard

        resumed = time.time_ns()
        assert client.call(SetBool, 'gear_sim/pause', SetBool.Request(data=False)).success
        blocks.wait(50)
        stamps = blocks.stamps
        # The first block begins one block before it is sent, at the resume or up to 10 s of a
        # slow machine later.
        assert 0 <= stamps[heard] - resumed < 10e9
        assert stamps[heard] - stamps[heard - 1] > 1e9
        assert np.unique(np.diff(stamps[heard:])).tolist() == [10_000_000]
        angles = [decode_table(blocks.messages[i]).rows['pinion_angle'] for i in (heard - 1, heard)]
        step = (angles[1][0] - angles[0][-1]) % (2 * math.pi)
        assert step == pytest.approx(104.72 / 51200, rel=0.1)

        heard = len(blocks.messages)
        assert client.call(Trigger, 'gear_sim/reset', Trigger.Request()).success
        blocks.wait(50)
        stamps = blocks.stamps
        assert (np.diff(stamps) > 0).all()
        # A run starts at pinion angle 0 and goes on from there.
        starts = [decode_table(each).rows['pinion_angle'][0] for each in blocks.messages[heard:]]
        assert np.abs(starts).min() < 0.01
        assert sim.stop(signal.SIGTERM) == 0


def test_monitor_topics_follow_the_samples(domain, client):
    blocks = Blocks(client.collect(PointCloud2, 'gear_pair/samples', raw=True))
    joints = client.collect(JointState, 'gear_pair/joint_states')
    accelerations = client.collect(AccelStamped, 'gear_pair/pinion/acceleration')
    forces = client.collect(WrenchStamped, 'gear_pair/mesh_force')
    with ros_support.Process(SIM, domain, {'monitor_rate': 256}) as sim:
        ros_support.wait_until(lambda: len(joints) > 50 and len(forces) > 300, 120)
        assert sim.stop() == 0
    table = {int(stamp): i for i, stamp in enumerate(blocks.stamps)}
    rows = np.concatenate([decode_table(each).rows for each in blocks.messages])

    stamps = [nanoseconds(each.header.stamp) for each in joints]
    assert np.unique(np.diff(stamps)).tolist() == [20_000_000]
    for joint, stamp in zip(joints, stamps, strict=True):
        if stamp in table:
            sample = rows[512 * table[stamp]]
            assert joint.name == ['pinion_joint', 'gear_joint']
            angles = [sample['pinion_angle'], sample['gear_angle']]
            assert joint.position == pytest.approx(angles, abs=1e-6)
            assert joint.velocity == pytest.approx([104.72, 104.72 * 34 / 59], rel=0.05)
            assert joint.effort[0] == pytest.approx(150 * 34 / 59, rel=0.02)
            assert joint.effort[1] == -150

    stamps = np.array([nanoseconds(each.header.stamp) for each in forces])
    assert np.unique(np.diff(stamps)).tolist() == [3906250]
    # Below the lowest mesh harmonic of 567 Hz only the mean is left.
    values = np.array([each.wrench.force.y for each in forces])
    assert values[50:].mean() == pytest.approx(rows['mesh_force'].mean(dtype=float), rel=1e-3)
    assert values[50:].std() < 0.02 * rows['mesh_force'].std(dtype=float)
    assert all(each.wrench.force.x == 0 for each in forces)
    assert len(accelerations) > 200
    # The first blocks hold how the rig swings in.
    assert np.std([each.accel.linear.y for each in accelerations[50:]]) < 10


def test_clock_namespace_and_pace_of_two(domain, client):
    clocks = client.collect(Clock, '/clock')
    blocks = Blocks(client.collect(PointCloud2, 'rig1/gear_pair/samples', raw=True))
    health = client.collect(DiagnosticArray, '/diagnostics')
    parameters = {'publish_clock': True, 'real_time_factor': 2, 'block_size': 100}
    arguments = ['-r', '__ns:=/rig1']
    with ros_support.Process(SIM, domain, parameters, arguments) as sim:
        ros_support.wait_until(lambda: len(health) >= 4, 120, 'diagnostics')
        assert sim.stop() == 0
    ends = {int(stamp) + round(100 / 51200 * 1e9) for stamp in blocks.stamps}
    heard = [nanoseconds(each.clock) for each in clocks]
    assert len(heard) > 1000
    near = [min(abs(each - end) for end in list(ends)) for each in heard[500:510]]
    assert max(near) <= 1
    names = {status.name for each in health for status in each.status}
    assert 'rig1/gear_sim: pace' in names
    values = {v.key: v.value for v in health[2].status[0].values}
    assert {'real_time_factor', 'lag [s]', 'overruns'} <= values.keys()
    counters = {v.key for s in health[2].status if s.name.endswith('integrator') for v in s.values}
    assert {'steps', 'rejected_steps', 'contact_losses', 'smallest_step [s]'} <= counters


def test_as_fast_as_listeners_allow_loses_nothing(domain, client):
    stamps, until = [], time.monotonic() + 60

    def hear(data):
        stamps.append(decode_table(data).stamp_ns)
        if time.monotonic() < until:
            time.sleep(0.005)

    keep_all = QoSProfile(history=HistoryPolicy.KEEP_ALL)
    client.node.create_subscription(PointCloud2, 'gear_pair/samples', hear, keep_all, raw=True)
    # Small blocks fill the queues of the middleware, 5000 messages each, within seconds.
    parameters = {'real_time_factor': 0, 'block_size': 16, 'anti_alias': False}
    with ros_support.Process(SIM, domain, parameters) as sim:
        ros_support.wait_until(lambda: len(stamps) > 1000, 120, 'blocks')
        assert sim.stop() == 0
    until = 0
    assert np.unique(np.diff(stamps)).tolist() == [312500]


def test_a_sim_that_cannot_keep_up_says_so(domain, client):
    health = client.collect(DiagnosticArray, '/diagnostics')
    with ros_support.Process(SIM, domain, {'real_time_factor': 1000}) as sim:
        ros_support.wait_until(lambda: len(health) >= 3, 120, 'diagnostics')
        assert sim.stop() == 0
    pace = health[2].status[0]
    values = {each.key: float(each.value) for each in pace.values}
    assert pace.level == b'\x01'
    assert 'cannot keep up' in pace.message
    assert values['real_time_factor'] < 1000
    assert values['overruns'] > 0
    assert values['lag [s]'] > 0


def test_configuration_tells_the_default_rig(domain, client):
    from rclpy.qos import DurabilityPolicy
    from std_msgs.msg import String

    from gear_dynamics.machine.configuration import Rig

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    with ros_support.Process(SIM, domain) as sim:
        sim.wait_for('streaming', 120)
        texts = client.collect(String, 'gear_pair/configuration', latched)
        ros_support.wait_until(lambda: texts, 10, 'the configuration of a sim that runs already')
        assert Rig.from_text(texts[0].data).wn == GearPair().derived.wn
        assert sim.stop() == 0


def test_a_storm_of_commands_costs_no_block_and_the_last_one_holds(domain, client):
    from rcl_interfaces.srv import GetParameters
    from std_msgs.msg import Float64

    blocks = Blocks(client.collect(PointCloud2, 'gear_pair/samples', raw=True))
    with ros_support.Process(SIM, domain) as sim:
        sim.wait_for('streaming', 120)
        topics = [
            client.publisher(Float64, f'gear_pair/cmd/{name}') for name in ('speed', 'torque')
        ]
        values = [120.0, 130.0, math.nan, -6000.0, 125.0]
        begin = time.monotonic()
        for number in range(10_000):  # 5 kHz
            topics[number % 2].publish(Float64(data=values[number % 5]))
            time.sleep(max(0.0, begin + number / 5000 - time.monotonic()))
        topics[0].publish(Float64(data=110.0))
        topics[1].publish(Float64(data=140.0))

        def mirrored():
            request = GetParameters.Request(names=['speed', 'load_torque'])
            found = client.call(GetParameters, 'gear_sim/get_parameters', request).values
            return [each.double_value for each in found] == [110.0, 140.0]

        ros_support.wait_until(mirrored, 10, 'the last commands as parameters')
        ros_support.wait_until(lambda: blocks.last.rows['load_torque'][-1] == 140, 10, 'its end')
        assert sim.stop() == 0
    assert np.unique(np.diff(blocks.stamps)).tolist() == [10_000_000]
