"""What `simulate` returns, and the names of the Python API."""

import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from ros_support import ROOT

import gear_dynamics as gd

VALUES = {'speed': 335.1, 'load_torque': 60.0}


@pytest.fixture(scope='module')
def run():
    return gd.simulate(gd.GearPair(), 0.05, 25600.0, **VALUES)


def test_a_run_is_its_array_of_samples(run):
    assert len(run) == 1280
    assert run['mesh_force'].dtype == np.float64
    assert np.asarray(run).tobytes() == run.samples.tobytes()
    assert np.array_equal(np.array(run)['delta'], run['delta'])
    assert np.array_equal(run[10:20], run.samples[10:20])
    assert [row['t'] for row in run[:2]] == [0.0, 1 / 25600.0]
    assert (run.settings.speed, run.settings.sample_rate) == (335.1, 25600.0)
    assert run.pair == gd.GearPair()
    assert '1280 samples at 25600 Hz' in repr(run)
    with pytest.raises(ValueError, match='no field of name force'):
        run['force']


@pytest.mark.parametrize('anti_alias', [False, True])
def test_samples_and_events_are_those_of_the_simulator(anti_alias):
    simulator = gd.Simulator(gd.GearPair(), anti_alias=anti_alias, **VALUES)
    samples = simulator.advance(2560)
    run = gd.simulate(gd.GearPair(), 0.05, anti_alias=anti_alias, **VALUES)
    assert run.samples.tobytes() == samples.tobytes()
    assert run.events.tobytes() == simulator.take_events().tobytes()
    assert np.count_nonzero(run.events['kind'] == gd.EventKind.SECTION) == 91  # 0.05 s x 1813 Hz


def test_samples_are_band_limited_unless_asked_otherwise(run):
    limited = gd.simulate(gd.GearPair(), 0.05, 25600.0, anti_alias=True, **VALUES)
    raw = gd.simulate(gd.GearPair(), 0.05, 25600.0, anti_alias=False, **VALUES)
    assert run.samples.tobytes() == limited.samples.tobytes()
    assert run.samples.tobytes() != raw.samples.tobytes()
    assert gd.Simulator(gd.GearPair()).settings.anti_alias
    batch = gd.simulate_batch([gd.GearPair()], 335.1, 60.0, 0.05, 25600.0)
    assert batch[0].tobytes() == run.samples.tobytes()


def test_a_run_is_drawn(run, tmp_path):
    figure = gd.plot(run, tmp_path / 'run.png', channel='mesh_force')
    assert (tmp_path / 'run.png').stat().st_size > 10_000
    wave, lines, portrait, section = figure.axes
    assert len(section.collections[0].get_offsets()) == 91
    shown = wave.lines[0].get_xdata()
    assert np.ptp(shown) == pytest.approx(10 * 2 * np.pi / (34 * 335.1), rel=0.02)
    assert 'multiples of the mesh frequency, 1813.3 Hz' in lines.get_title(loc='left')
    assert portrait.get_xlabel() == 'δ / b'
    with pytest.raises(gd.ParameterError, match="channel is 'force': it must be one of pinion_ax"):
        gd.plot(run, channel='force')


def test_a_run_at_rest_is_drawn():
    gd.plot(gd.simulate(gd.GearPair(), 0.01, speed=0.0))


def test_every_public_name_can_be_imported():
    for name in gd.__all__:
        assert getattr(gd, name) is not None
        assert name in dir(gd)
    assert callable(gd.plot)
    with pytest.raises(AttributeError, match="has no attribute 'simulation_'"):
        gd.simulation_  # noqa: B018


def test_the_version_is_that_of_the_manifest():
    assert gd.__version__ == ElementTree.parse(ROOT / 'package.xml').findtext('version')


def test_the_package_alone_loads_nothing_slow():
    program = (
        'import sys, gear_dynamics; gear_dynamics.__version__; '
        'print({"numpy", "scipy", "numba", "matplotlib", "rclpy"} & set(sys.modules))'
    )
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == 'set()', done.stderr


@pytest.mark.parametrize('anti_alias', [False, True])
@pytest.mark.parametrize('rate', [25600.0, 51200.0])
def test_two_runs_joined_equal_one_to_the_last_bit(anti_alias, rate):
    # 9500 rpm: chaotic, so that the least difference would show.
    values = {'sample_rate': rate, 'speed': 994.8, 'load_torque': 150.0, 'anti_alias': anti_alias}
    whole = gd.simulate(gd.GearPair(), 0.05, **values)
    parts = [gd.simulate(gd.GearPair(), 0.02, **values)]
    for _ in range(3):  # of which two go on from the same state
        before = parts[-1] if len(parts) < 3 else parts[1]
        state, kept = before.final_state, {'sample_rate': rate, 'anti_alias': anti_alias}
        parts.append(gd.simulate(gd.GearPair(), 0.015, initial_state=state, **kept))
    samples = np.concatenate([run.samples for run in parts[:3]])
    assert samples.tobytes() == whole.samples.tobytes()
    assert np.concatenate([run.events for run in parts[:3]]).tobytes() == whole.events.tobytes()
    assert parts[3].samples.tobytes() == parts[2].samples.tobytes()


def test_a_run_that_goes_on_takes_other_commands_and_refuses_other_samples():
    run = gd.simulate(gd.GearPair(), 0.01, speed=200.0, load_torque=60.0)
    kept = gd.simulate(gd.GearPair(), 0.01, initial_state=run.final_state)
    assert (kept.settings.speed, kept.settings.load_torque) == (200.0, 60.0)
    faster = gd.simulate(gd.GearPair(), 0.01, speed=201.0, initial_state=run.final_state)
    assert faster.settings.speed == 201.0
    assert faster['load_torque'][-1] == 60.0
    assert faster['pinion_angle'][-1] > kept['pinion_angle'][-1]
    with pytest.raises(
        gd.ParameterError, match=r'sample_rate is 100\.0: initial_state is of a run'
    ):
        gd.simulate(gd.GearPair(), 0.1, 100.0, initial_state=run.final_state)
    with pytest.raises(gd.ParameterError, match='anti_alias is False: initial_state is of a run'):
        gd.simulate(gd.GearPair(), anti_alias=False, initial_state=run.final_state)
    with pytest.raises(gd.ParameterError, match='pinion_teeth is 33: it cannot change'):
        gd.simulate(gd.GearPair(pinion_teeth=33), initial_state=run.final_state)


def test_a_run_that_goes_on_keeps_its_faults_and_takes_others():
    crack = gd.faults.RootCrack('pinion', tooth=0, severity=0.5)
    run = gd.simulate(gd.GearPair(), 0.01, faults=[crack])
    kept = gd.simulate(gd.GearPair(), 0.01, initial_state=run.final_state)
    again = gd.simulate(gd.GearPair(), 0.01, faults=[crack], initial_state=run.final_state)
    healed = gd.simulate(gd.GearPair(), 0.01, faults=[], initial_state=run.final_state)
    assert kept.samples.tobytes() == again.samples.tobytes()
    assert (kept.faults, healed.faults) == ((crack,), ())
    assert [label.fault for label in kept.labels] == ['root_crack']
