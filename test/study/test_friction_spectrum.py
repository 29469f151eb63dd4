import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.model.columns import SAMPLES
from gear_dynamics.study.friction_spectrum import RECORD, relative_rows


def test_relative_rows_of_a_known_signal():
    """The pinion swings by 1 mrad in the second mesh harmonic: psi by rb1 of that, its acceleration
    by omega^2 times as much; delta_dot by 3 m/s in the third, delta'' by omega times as much."""
    pair, cycle_time, count = study.default_operation().pair, 1e-3, 64 * RECORD
    turn = 2 * np.pi * np.arange(count) / 64
    samples = np.zeros(count, SAMPLES)
    samples['pinion_angle'] = (turn / 34 + 1e-3 * np.sin(2 * turn)) % (2 * np.pi)
    samples['gear_angle'] = turn / 59 % (2 * np.pi)
    samples['delta_dot'] = 7 + 3 * np.sin(3 * turn)
    rows = relative_rows(samples, pair, cycle_time)
    psi = 1e-3 * pair.derived.pinion_base_radius
    shape = np.array([1 / np.sqrt(2), 0, 1, 0, 0, 0])
    assert rows['psi'] == pytest.approx(psi * shape, abs=1e-9 * psi)
    acceleration = psi * (2 * np.pi * 2000) ** 2
    assert rows['psi_acceleration'] == pytest.approx(acceleration * shape, rel=1e-6, abs=1e-3)
    expected = 3 * 2 * np.pi * 3000 * np.array([1 / np.sqrt(2), 0, 0, 1, 0, 0])
    assert rows['delta_acceleration'] == pytest.approx(expected, abs=1e-6)


def test_a_spectrum_without_friction_is_led_by_nothing():
    text = study.spectrum(study.default_operation(), (0.03, 0.0), phases=0).text
    assert 'led by' not in text
