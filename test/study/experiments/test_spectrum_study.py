import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.study.harmonics import QUANTITIES
from gear_dynamics.study.published import holds
from gear_dynamics.study.spectrum_tasks import (
    DRIVE_SETTLES,
    RECORD,
    TABLE_SAMPLES,
    recurrence,
)


def test_a_spectrum_without_friction_is_led_by_nothing():
    """x moves by friction alone."""
    leads = "leads the pinion's x acceleration"
    assert leads not in study.spectrum(study.default_operating_point(), (0.03, 0.0), phases=0).text
    assert leads in study.spectrum(study.default_operating_point(), (0.0, 0.03), phases=0).text


def test_accelerations_of_a_periodic_motion_are_displacements_times_the_square_of_the_frequency():
    arrays = study.spectrum(study.default_operating_point(), phases=0).arrays
    assert list(arrays['period']) == [1, 1]
    turn = 104.72 * 34 * np.arange(1, 6)
    pairs = [('pinion_ay', 'pinion_y'), ('gear_ax', 'gear_x'), ('psi_acceleration', 'psi')]
    for rate, place in [*pairs, ('delta_acceleration', 'delta')]:
        expected = arrays[place][:, 1:] * turn**2
        assert arrays[rate][:, 1:] == pytest.approx(expected, rel=1e-4), rate


def test_accelerations_without_a_period_are_those_of_differences():
    """At 1000 rad/s the motion is chaotic: lines over or times the square of their frequency would
    be off by orders. psi is that of the angles that samples have."""
    operation = study.default_operating_point().with_value('speed', 1000.0)
    assert operation.pair.friction_coefficient == 0.03
    outcome = study.spectrum(operation, (0.03, 0.05), phases=0)
    assert list(outcome.arrays['period']) == [0, 0]
    run = ([operation.pair], operation.speed, operation.load_torque)
    before = run_cycles(*run, DRIVE_SETTLES, drive=True)
    after = run_cycles(
        *run, RECORD, states=before.states, drive=True, samples_per_cycle=TABLE_SAMPLES
    )
    samples, step = after.samples[0], after.period[0] / TABLE_SAMPLES
    derived = operation.pair.derived
    psi = derived.pinion_base_radius * np.unwrap(samples['pinion_angle'])
    psi -= derived.gear_base_radius * np.unwrap(samples['gear_angle'])
    for name, values in (('psi', psi), ('delta', samples['delta'])):
        assert outcome.arrays[name][0, 0] == pytest.approx(values.std(), rel=1e-9)
        differences = np.diff(values, 2) / step**2
        found = outcome.arrays[f'{name}_acceleration'][0, 0]
        assert found == pytest.approx(differences.std(), rel=1e-3)
    for mu in ('0.03', '0.05'):
        assert f'mu = {mu}: no period: these figures show chance as well; they are of 32 mesh' in (
            outcome.text
        )


def test_record_holds_whole_periods():
    """Of 32 cycles: 30 of period-3 and all of period-4; without a period all."""
    operation = study.default_operating_point()
    random = np.random.default_rng(0).uniform(0, 1e-4, (128, 2))
    assert recurrence(operation, random) == (0, 32)
    for period, cycles in ((3, 30), (4, 32), (20, 20)):
        assert recurrence(operation, random[np.arange(128) % period]) == (period, cycles)


def test_friction_moves_the_first_harmonic_as_an_independent_code_saw():
    """At 1000 rpm the first harmonic of the mesh force falls by a tenth at phi0 = 0 and rises by
    8 % at 180 deg; the y accelerations fall by 2 to 3 %: an independent event-exact code."""
    for phase, change in ((0.0, -0.10), (np.pi, 0.08)):
        operation = study.default_operating_point().with_value('transmission_error_phase', phase)
        arrays = study.spectrum(operation, phases=0).arrays
        force, ay = arrays['mesh_force'], arrays['pinion_ay']
        assert force[1, 1] / force[0, 1] - 1 == pytest.approx(change, abs=0.01)
        assert 0.97 < ay[1, 0] / ay[0, 0] < 0.98
        # x moves by friction alone, and most near its support mode at 3401 Hz, 6 x 566.7 Hz.
        assert np.all(arrays['ax_lines'][0] == 0)
        assert arrays['order'][arrays['ax_lines'][1].argmax()] == 6


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
    assert verdict(gear_ay=[4, 0, 0, 0, 0, 0]) == [True, False, True, False]
    assert verdict(mesh_force=[5, 2, 3, 2, 1, 0]) == [True, True, False, False]
    assert verdict(mesh_force=[5, -2, -3, -2, -3, -3]) == [True, True, False, False]
    assert verdict(gear_ax=[3, 1, 2, 0, 0, 0]) == [True, True, False, False]


def test_map_has_claims_and_periods():
    outcome = study.spectrum(
        study.default_operating_point(),
        phases=2,
        speeds=2,
        slowest=60.0,
        fastest=104.72,
        transient=100,
    )
    # At 1000 rpm and below the motion follows the mesh without loss of contact.
    assert np.all(outcome.arrays['map_period'] == 1)
    assert outcome.arrays['map_most_in_x'].shape == (2, 2)
    assert len(outcome.further['_map']['speed [rad/s]']) == 4
    assert 'most in x' in outcome.text
