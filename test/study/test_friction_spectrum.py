import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.model.columns import SAMPLES
from gear_dynamics.study.friction_spectrum import (
    QUANTITIES,
    RECORD,
    holds,
    quantity_rows,
    relative_rows,
)


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


def test_rows_of_a_known_signal():
    """Amplitude 3 in the second mesh harmonic on a mean of 5: displacement 3 / omega^2."""
    cycle_time = 1e-3
    turn = 2 * np.pi * np.arange(64 * RECORD) / 64
    samples = np.zeros(64 * RECORD, SAMPLES)
    samples['gear_ay'] = 5 + 3 * np.sin(2 * turn)
    rows = quantity_rows(samples, cycle_time)
    assert rows['gear_ay'] == pytest.approx([3 / np.sqrt(2), 0, 3, 0, 0, 0], abs=1e-12)
    expected = 3 / (2 * np.pi * 2000) ** 2
    assert rows['gear_y'] == pytest.approx([expected / np.sqrt(2), 0, expected, 0, 0, 0], abs=1e-15)


def test_friction_moves_the_first_harmonic_as_an_independent_code_saw():
    """At 1000 rpm the first harmonic of the mesh force falls by a tenth at phi0 = 0 and rises by
    8 % at 180 deg; the y accelerations fall by 2 to 3 %: an independent event-exact code."""
    for phase, change in ((0.0, -0.10), (np.pi, 0.08)):
        operation = study.default_operation().with_value('transmission_error_phase', phase)
        arrays = study.spectrum(operation, phases=0).arrays
        force, ay = arrays['mesh_force'], arrays['pinion_ay']
        assert force[1, 1] / force[0, 1] - 1 == pytest.approx(change, abs=0.01)
        assert 0.97 < ay[1, 0] / ay[0, 0] < 0.98
        # x moves by friction alone, and most near its support mode at 3401 Hz, 6 x 566.7 Hz.
        assert np.all(arrays['ax_lines'][0] == 0)
        assert arrays['order'][1, arrays['ax_lines'][1].argmax()] == 6


def rows_with(**rises):
    """Rows of a map of one place: zeros without friction, RMS and five harmonics with it."""
    rows = np.zeros((2, len(QUANTITIES), 6))
    for name, values in rises.items():
        rows[1, QUANTITIES.index(name)] = values
    return rows


def test_claims_of_the_source_are_told_apart():
    """Each of the three can hold without the others."""
    all_three = {
        'pinion_ax': [3, 2, 1, 0, 0, 0],
        'gear_ax': [3, 2, 1, 0, 0, 0],
        'pinion_ay': [2, 0, 0, 0, 0, 0],
        'gear_ay': [2, 0, 0, 0, 0, 0],
        'mesh_force': [5, 4, 3, 2, 1, 0],
    }
    names = ('all_directions', 'most_in_x', 'into_first', 'all_claims')

    def verdict(**changes):
        found = holds(rows_with(**(all_three | changes)))
        return [bool(found[name]) for name in names]

    assert verdict() == [True, True, True, True]
    assert verdict(gear_ay=[-1, 0, 0, 0, 0, 0]) == [False, True, True, False]
    assert verdict(pinion_ay=[4, 0, 0, 0, 0, 0]) == [True, False, True, False]
    assert verdict(mesh_force=[5, 2, 3, 2, 1, 0]) == [True, True, False, False]
    assert verdict(mesh_force=[5, -2, -3, -2, -3, -3]) == [True, True, False, False]
    assert verdict(gear_ax=[3, 1, 2, 0, 0, 0]) == [True, True, False, False]


def test_map_has_claims_and_periods():
    outcome = study.spectrum(
        study.default_operation(), phases=2, speeds=2, slowest=60.0, fastest=104.72, transient=100
    )
    # At 1000 rpm and below the motion follows the mesh without loss of contact.
    assert np.all(outcome.arrays['map_period'] == 1)
    assert outcome.arrays['map_most_in_x'].shape == (2, 2)
    assert len(outcome.further['_map']['speed [rad/s]']) == 4
    assert 'most in x' in outcome.text
