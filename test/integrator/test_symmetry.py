"""Exact symmetries of the equations."""

import dataclasses

import numpy as np
import pytest
from reference_equations import COLUMNS
from states import start_from, state_of_sample

from gear_dynamics.machine.columns import SAMPLE_COLUMNS, EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

RPM = np.pi / 30
MECHANICAL = tuple(
    name for name in SAMPLE_COLUMNS if name not in ('t', 'pinion_angle', 'gear_angle', 'speed')
)


def doubled(pair):
    return dataclasses.replace(
        pair,
        half_backlash=2 * pair.half_backlash,
        transmission_error_amplitude=2 * pair.transmission_error_amplitude,
    )


@pytest.mark.parametrize('anti_alias', [False, True])
@pytest.mark.parametrize('rpm', [1000, 3200, 9500])
def test_lengths_and_torque_doubled_double_the_motion_bit_for_bit(rpm, anti_alias):
    # A factor of two changes no mantissa, so not even chaos (9500 rpm) tells the two runs apart.
    options = {'speed': rpm * RPM, 'anti_alias': anti_alias}
    one = Simulator(GearPair(), load_torque=150.0, **options)
    two = Simulator(doubled(GearPair()), load_torque=300.0, **options)
    single, double = one.advance(10240), two.advance(10240)
    for name in MECHANICAL:
        np.testing.assert_array_equal(double[name], 2 * single[name], err_msg=name)
    events, twice = one.take_events(), two.take_events()
    for name in ('t', 'kind', 'tooth_pair', 'cycle'):
        np.testing.assert_array_equal(twice[name], events[name])
    for name in ('delta', 'delta_dot'):
        np.testing.assert_array_equal(twice[name], 2 * events[name])
    if rpm == 9500:
        sections = events['delta'][events['kind'] == EventKind.SECTION][-200:]
        assert len(np.unique(sections.round(9))) > 100


def test_doubling_holds_through_a_torque_ramp():
    one = Simulator(GearPair(), load_torque=150.0, torque_rate_limit=1000.0, anti_alias=False)
    two = Simulator(
        doubled(GearPair()), load_torque=300.0, torque_rate_limit=2000.0, anti_alias=False
    )
    one.command(load_torque=90.0)
    two.command(load_torque=180.0)
    single, double = one.advance(5120), two.advance(5120)
    for name in MECHANICAL:
        np.testing.assert_array_equal(double[name], 2 * single[name], err_msg=name)


def test_zone_of_two_pairs_is_invariant_in_time():
    # While the pairs slide to both sides of the pitch point and share the load, their friction
    # cancels and its moment is mu F pb / 2, wherever they are: without transmission error the
    # vibration is the same however fast the zone is passed, and standing still too.
    pair = GearPair(transmission_error_amplitude=0.0, friction_coefficient=0.2)
    runs = []
    for speed in (0.0, 20.0, 104.72):
        tolerances = {'rtol': 1e-12, 'atol': 1e-15}
        still = Simulator(pair, speed=speed, anti_alias=False, **tolerances)
        still.advance(1)
        start = state_of_sample(still)
        start[1] += 2e-6
        start[6] += 0.01
        moving = Simulator(pair, speed=speed, anti_alias=False, **tolerances)
        start_from(moving, start)
        # The zone lasts 1.29 ms at 104.72 rad/s.
        samples = moving.advance(60)
        assert np.all(samples['friction_force'] == 0)
        runs.append(np.stack([samples[name] for name in COLUMNS[:8]], axis=1))
    assert np.ptp(runs[0][:, COLUMNS.index('mesh_force')]) > 100
    for run in runs[1:]:
        difference = np.max(np.abs(run - runs[0]), axis=0)
        assert np.all(difference <= 1e-9 * np.max(np.abs(runs[0]), axis=0))


def test_mirrored_load_mirrors_the_motion_where_nothing_else_has_a_side():
    # delta -> -delta turns drive flank into back flank; friction and transmission error do not
    # mirror, so they are left out.
    pair = GearPair(friction_coefficient=0.0, transmission_error_amplitude=0.0)
    one = Simulator(pair, load_torque=150.0, speed=3200 * RPM, anti_alias=False).advance(5120)
    two = Simulator(pair, load_torque=-150.0, speed=3200 * RPM, anti_alias=False).advance(5120)
    for name in MECHANICAL:
        np.testing.assert_array_equal(two[name], -one[name], err_msg=name)
