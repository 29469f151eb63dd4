"""Faults, labels and other gear pairs of a running sim."""

from pathlib import Path

import pytest

rclpy = pytest.importorskip('rclpy')

import numpy as np  # noqa: E402
import ros_support  # noqa: E402
import yaml  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: E402
from sensor_msgs.msg import PointCloud2  # noqa: E402
from std_msgs.msg import String  # noqa: E402

from gear_dynamics.model.gear_pair import GearPair  # noqa: E402
from gear_dynamics.nodes.faults import refuse_unfit  # noqa: E402
from gear_dynamics.parameters.parameter import ParameterError  # noqa: E402
from gear_dynamics.parameters.settings import SimSettings  # noqa: E402
from gear_dynamics.simulation.faults import FaultSettings  # noqa: E402
from gear_dynamics.wire.tables import decode_table  # noqa: E402

SIM = 'gear_dynamics.nodes.sim'
CONFIG = Path(__file__).resolve().parents[2] / 'config'
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def values(status):
    return {each.key: each.value for each in status.values}


def set_parameter(client, name, value):
    """Set one parameter; return whether it was taken, and the reason if not."""
    (result,) = client.set_parameters('gear_sim', **{name: value})
    return result.successful, result.reason


def test_faults_are_switched_live_and_told(domain, client, tmp_path):
    labels = client.collect(DiagnosticArray, 'gear_pair/label', LATCHED)
    blocks = client.collect(PointCloud2, 'gear_pair/samples', raw=True)
    with ros_support.Process(SIM, domain) as sim:
        ros_support.wait_until(lambda: labels and blocks, 120)
        assert list(labels[0].status) == []

        assert set_parameter(client, 'fault.root_crack.tooth', 5)[0]
        assert set_parameter(client, 'fault.root_crack.severity', 0.4)[0]
        ros_support.wait_until(lambda: labels[-1].status, 30)
        (status,) = labels[-1].status
        assert status.name == 'gear_pair: root_crack'
        assert values(status) == {
            'fault': 'root_crack',
            'wheel': 'pinion',
            'tooth': '5',
            'severity': '0.4',
            'orders': '1',
        }
        # Again once a second of model time.
        count = len(labels)
        ros_support.wait_until(lambda: len(labels) > count + 1, 30)

        taken, reason = set_parameter(client, 'fault.root_crack.tooth', 34)
        assert (taken, reason) == (
            False,
            'root_crack tooth is 34: it must be from 0 to 33 on this pinion',
        )
        taken, reason = set_parameter(client, 'fault.root_crack.severity', 1.5)
        assert not taken
        assert 'out of range' in reason

        file = tmp_path / 'faults.yaml'
        file.write_text('- {fault: spall, wheel: gear, tooth: 12, severity: 0.5}\n')
        assert set_parameter(client, 'faults', str(file))[0]
        ros_support.wait_until(lambda: len(labels[-1].status) == 2, 30)
        assert not set_parameter(client, 'faults', '/nowhere.yaml')[0]
        assert sim.stop() == 0


def test_change_of_the_pair_that_a_fault_does_not_bear_is_refused():
    narrow = GearPair(half_backlash=20e-6)
    single = FaultSettings({'fault.eccentricity.severity': 1.0})
    sets = {GearPair: narrow, SimSettings: SimSettings(), FaultSettings: single}
    with pytest.raises(ParameterError, match=r'eccentricity offset is 0\.0001: it must be below'):
        refuse_unfit(sets, frozenset({'half_backlash'}), '/gear_sim')
    refuse_unfit(sets, frozenset({'speed'}), '/gear_sim')


def test_another_pair_is_chosen_while_it_runs(domain, client, tmp_path):
    told = client.collect(String, 'gear_pair/configuration', LATCHED)
    blocks = client.collect(PointCloud2, 'gear_pair/samples', raw=True)

    def parameters():
        return yaml.safe_load(told[-1].data)['parameters'] if told else {}

    with ros_support.Process(SIM, domain, {'fault.wear.severity': 0.1}) as sim:
        ros_support.wait_until(lambda: blocks and told, 120)
        chaotic = CONFIG / 'friction_chaos.yaml'
        assert set_parameter(client, 'pair_file', str(chaotic)) == (True, '')
        ros_support.wait_until(lambda: parameters()['pair_file'] == str(chaotic), 30)
        assert parameters()['pinion_mass'] == pytest.approx(0.3942558)
        assert parameters()['speed'] == pytest.approx(2287.74553)

        wrong = tmp_path / 'wrong.yaml'
        wrong.write_text('/**: {ros__parameters: {pinion_teeth: 3}}')
        taken, reason = set_parameter(client, 'pair_file', str(wrong))
        assert not taken
        assert reason.startswith(f'{wrong}: pinion_teeth is 3')
        assert '\n' not in reason
        assert not set_parameter(client, 'pair_file', '/nowhere.yaml')[0]
        heard = len(blocks)
        ros_support.wait_until(lambda: len(blocks) > heard + 20, 30)

        assert set_parameter(client, 'pair_file', str(CONFIG / 'default.yaml'))[0]
        ros_support.wait_until(lambda: parameters()['pinion_mass'] == 0, 30)
        assert parameters()['speed'] == pytest.approx(104.72)
        assert set_parameter(client, 'pinion_teeth', 30)[0] is False
        assert sim.stop() == 0


def test_sensor_adds_noise_and_a_tacho(domain, client):
    quiet = client.collect(PointCloud2, 'gear_pair/samples', raw=True)
    given = {'noise_density': 'gear_ax 5', 'tacho': True, 'friction_coefficient': 0.0}
    with ros_support.Process(SIM, domain, given) as sim:
        ros_support.wait_until(lambda: len(quiet) > 40, 120)
        assert sim.stop() == 0
    rows = np.concatenate([decode_table(each).rows for each in quiet])
    # Without friction nothing else acts across the line of action.
    assert rows['gear_ax'].std() == pytest.approx(5 * np.sqrt(25600), rel=0.05)
    assert set(rows['tacho']) == {0.0, 1.0}
    assert ((rows['pinion_angle'] < 0.2 * np.pi) == (rows['tacho'] == 1)).mean() > 0.999


def test_unknown_fault_is_refused_at_the_start(domain):
    with ros_support.Process(SIM, domain, {'fault.root_crak.severity': 0.1}) as sim:
        assert sim.wait() == 2
        assert 'fault.root_crak.severity is not a parameter' in sim.output
