"""Where a run starts: the static deflection, by hand calculation."""

import dataclasses
import math

import numpy as np
import pytest
from states import state_of_sample

from gear_dynamics.model.faults import MissingTooth
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Ports
from gear_dynamics.simulation.simulator import Simulator

QUIET = GearPair(transmission_error_amplitude=0.0, friction_coefficient=0.0)


def first_sample(pair, load_torque, **values):
    simulator = Simulator(pair, load_torque=load_torque, anti_alias=False, **values)
    return simulator.advance(1)[0], state_of_sample(simulator)


@pytest.mark.parametrize(('stiffness', 'pairs'), [('rectangular', 2), ('constant', 1)])
@pytest.mark.parametrize('load_torque', [150.0, -90.0, 1.0])
def test_two_pairs_share_the_load_at_mesh_phase_zero(stiffness, pairs, load_torque):
    pair = dataclasses.replace(QUIET, mesh_stiffness=stiffness)
    sample, state = first_sample(pair, load_torque)
    # rb2 = m z2 cos a / 2 = 55.4419 mm; 150 N m press the flanks with 2705.5 N.
    force = load_torque / (0.002 * 59 / 2 * math.cos(math.radians(20)))
    assert sample['mesh_force'] == pytest.approx(force, rel=1e-12)
    delta = math.copysign(150e-6, load_torque) + force / (pairs * 5.33e8)
    assert sample['delta'] == pytest.approx(delta, rel=1e-13)
    np.testing.assert_allclose(state[:4], [0, force / 5e8, 0, -force / 5e8], rtol=1e-12)
    for column in ('pinion_ax', 'pinion_ay', 'gear_ax', 'gear_ay', 'delta_dot'):
        assert sample[column] == pytest.approx(0, abs=1e-9)


def test_friction_at_mesh_phase_zero():
    # 34/59 teeth, 150 N m, mu 0.1. At phase 0 pair A is at s = 0 (approach, +), pair B at
    # s = pb > l1 (recess, -); each carries half, so friction cancels but its moments do not:
    # rb2 F - mu F/2 (l_A2 - l_B2) = T2 with l_A2 - l_B2 = pb.
    pair = dataclasses.replace(QUIET, friction_coefficient=0.1)
    sample, state = first_sample(pair, 150.0)
    pb = math.pi * 0.002 * math.cos(math.radians(20))
    rb2 = 0.059 * math.cos(math.radians(20))
    assert sample['mesh_force'] == pytest.approx(150.0 / (rb2 - 0.1 * pb / 2), rel=1e-12)
    assert sample['friction_force'] == pytest.approx(0, abs=1e-9)
    np.testing.assert_allclose(state[[0, 2]], 0, atol=1e-17)


@pytest.mark.parametrize('phase', [0.0, 1.0, -2.5])
@pytest.mark.parametrize('speed', [0.0, 104.72])
def test_run_starts_with_the_transmission_error_taken_up_by_rotation(phase, speed):
    pair = GearPair(transmission_error_phase=phase)
    sample, state = first_sample(pair, 150.0, speed=speed)
    rb1, rb2 = pair.derived.pinion_base_radius, pair.derived.gear_base_radius
    error = 15e-6 * math.sin(phase)
    error_dot = 15e-6 * math.cos(phase) * 34 * speed
    delta = state[3] - state[1] + rb1 * state[4] - rb2 * state[5] - error
    assert sample['delta'] == pytest.approx(delta, rel=1e-12)
    assert sample['delta_dot'] == pytest.approx(0, abs=1e-15)
    assert rb1 * state[10] - rb2 * state[11] == pytest.approx(error_dot, rel=1e-9, abs=1e-12)
    # q = 0: no rigid rotation.
    i1, i2 = pair.derived.pinion_inertia, pair.derived.gear_inertia
    assert i1 * state[4] + rb1 / rb2 * i2 * state[5] == pytest.approx(0, abs=1e-20)
    assert i1 * state[10] + rb1 / rb2 * i2 * state[11] == pytest.approx(0, abs=1e-15)


def test_bodies_start_in_balance_with_rest_points_and_forces():
    # 0.002 kg m at 104.72 rad/s push by 21.933 N at shaft angle 0, along x.
    pushed = Harmonic('pinion_force_x', 'pinion', 1.0, -0.002, math.pi / 2, derivative=2)
    moved = Harmonic('gear_rest_y', 'gear', 1.0, 30e-6, math.pi / 2)
    sample, state = first_sample(QUIET, 150.0, ports=Ports([pushed, moved]))
    force = sample['mesh_force']
    unbalance = 0.002 * 104.72**2
    expected = [unbalance / 5e8, force / 5e8, 0, 30e-6 - force / 5e8]
    np.testing.assert_allclose(state[:4], expected, rtol=1e-12, atol=1e-20)
    assert force == pytest.approx(150.0 / (0.059 * math.cos(math.radians(20))), rel=1e-12)


def test_teeth_that_are_all_missing_start_at_the_edge_of_the_backlash():
    # At phase 0 the teeth 0 and 33 of the pinion are in contact.
    gone = [MissingTooth('pinion', tooth=tooth, severity=1.0) for tooth in (0, 33)]
    simulator = Simulator(QUIET, faults=gone, anti_alias=False)
    samples = simulator.advance(200)
    assert samples['delta'][0] == pytest.approx(150e-6, rel=1e-12)
    assert samples['mesh_force'][0] == 0
    # Load and drive alone move the gears: delta'' = T2 / (rb2 me), until teeth meet.
    pair = QUIET.derived
    fall = 150.0 / pair.gear_base_radius / pair.equivalent_mass
    assert np.diff(samples['delta_dot'][:10]) * 51200 == pytest.approx(fall, rel=1e-3)
    assert samples['mesh_force'].max() > 0


TOLERANCES = {'rtol': 1e-10, 'atol': 1e-13}
STILL = 1e-8
"""Relative: at rest the steps grow until the rounding of the series reaches the tolerance."""


@pytest.mark.parametrize('anti_alias', [False, True])
def test_undisturbed_pair_stays_where_it_starts(anti_alias):
    pair = dataclasses.replace(QUIET, mesh_stiffness='constant')
    samples = Simulator(pair, anti_alias=anti_alias, **TOLERANCES).advance(5000)
    for name in ('mesh_force', 'delta'):
        np.testing.assert_allclose(samples[name], samples[name][0], rtol=STILL)
    force = samples['mesh_force'][0]
    np.testing.assert_allclose(samples['pinion_ay'], 0, atol=STILL * force / 1.0947)


@pytest.mark.parametrize('load_torque', [150.0, -150.0])
def test_standstill_is_an_equilibrium(load_torque):
    samples = Simulator(
        QUIET, speed=0.0, load_torque=load_torque, anti_alias=False, **TOLERANCES
    ).advance(5000)
    np.testing.assert_allclose(samples['delta'], samples['delta'][0], rtol=STILL)
    np.testing.assert_allclose(samples['pinion_angle'], samples['pinion_angle'][0], rtol=STILL)
    assert samples['speed'] == pytest.approx(0, abs=1e-6)


def test_unloaded_pair_rests_on_the_edge_of_the_flank():
    samples = Simulator(QUIET, load_torque=0.0, anti_alias=False, **TOLERANCES).advance(5000)
    np.testing.assert_allclose(samples['delta'], 150e-6, rtol=1e-6)
    np.testing.assert_allclose(samples['mesh_force'], 0, atol=1e-3)
