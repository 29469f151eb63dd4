"""Noise and tacho pulses of a minimal sensor."""

import numpy as np
import pytest
import scipy.signal

import gear_dynamics as gd
from gear_dynamics.machine.columns import SAMPLES
from gear_dynamics.simulation.sensor import Sensor, noise_densities, tacho_pulses


def test_noise_has_its_density_and_its_seed():
    silence = np.zeros(1 << 16, SAMPLES)
    sensor = Sensor('pinion_ay 0.02, mesh_force 0.5', 3, 51200.0)
    noisy = np.concatenate([sensor.measured(part) for part in np.split(silence, 4)])
    for name, density in (('pinion_ay', 0.02), ('mesh_force', 0.5), ('gear_ay', 0.0)):
        _, found = scipy.signal.welch(noisy[name], 51200.0, nperseg=4096)
        assert np.sqrt(found[5:-5].mean()) == pytest.approx(density, rel=0.03)
    again = Sensor('pinion_ay 0.02, mesh_force 0.5', 3, 51200.0).measured(silence[: 1 << 14])
    assert (again == noisy[: 1 << 14]).all()
    assert not silence['pinion_ay'].any()


def test_no_noise_leaves_the_samples_alone():
    samples = np.zeros(8, SAMPLES)
    assert Sensor('', 1, 51200.0).measured(samples) is samples


def test_there_is_a_pulse_a_revolution():
    run = gd.simulate(gd.GearPair(friction_coefficient=0.0), 0.6)
    pulses = tacho_pulses(run.samples)
    rising = np.flatnonzero(np.diff(pulses) > 0)
    assert np.diff(rising) == pytest.approx(51200 * 2 * np.pi / 104.72, abs=2)
    assert pulses[: rising[0]].max() == 1.0


@pytest.mark.parametrize(
    'text', ['pinion 0.1', 'pinion_ay', 'pinion_ay x', 'pinion_ay -1', 'load_torque 1']
)
def test_malformed_densities_are_refused(text):
    with pytest.raises(gd.ParameterError, match='noise_density has'):
        noise_densities(text)
