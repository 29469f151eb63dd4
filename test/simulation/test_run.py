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
