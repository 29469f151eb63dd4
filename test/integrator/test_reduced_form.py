"""The reduced form against the full one, and the drive that the full one has."""

import dataclasses
import math

import numpy as np
import pytest
from states import state_of_sample

from gear_dynamics.machine.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

RPM = np.pi / 30
SMOOTH = GearPair(friction_coefficient=0.0)


def rigid_rotation(pair, state):
    """Return q, the rotation that the drive holds, and q'."""
    d = pair.derived
    ratio = d.pinion_base_radius / d.gear_base_radius
    total = d.pinion_inertia + d.gear_inertia * ratio**2
    return tuple(
        (d.pinion_inertia * state[j] + ratio * d.gear_inertia * state[j + 1]) / total
        for j in (4, 10)
    )


@pytest.mark.parametrize(
    ('rpm', 'to_rpm'), [(1000, 1000), (3200, 3200), (9500, 9500), (1000, 9500), (9500, 1000)]
)
def test_both_forms_agree_without_friction_even_in_chaos(rpm, to_rpm):
    options = {'speed': rpm * RPM, 'speed_rate_limit': 3000.0, 'anti_alias': False}
    full, reduced = Simulator(SMOOTH, **options), Simulator(SMOOTH, drive=False, **options)
    runs = []
    for form in (full, reduced):
        form.advance(2048)
        form.command(speed=to_rpm * RPM)
        runs.append(form.advance(20480))
    one, two = runs
    for name in one.dtype.names:
        np.testing.assert_array_equal(one[name], two[name], err_msg=name)
    np.testing.assert_array_equal(full.shafts, reduced.shafts)
    assert full.counters == reduced.counters
    assert one['speed'][-1] == pytest.approx(to_rpm * RPM, rel=0.05)
    assert rigid_rotation(SMOOTH, state_of_sample(full))[0] == pytest.approx(0, abs=1e-18)


@pytest.mark.parametrize('drive', [True, False])
def test_drive_torque_carries_the_load_and_on_a_ramp_the_inertias(drive):
    accel, d = 500.0, SMOOTH.derived
    run = Simulator(SMOOTH, drive=drive, speed_rate_limit=accel, anti_alias=False)
    run.advance(100)
    ratio = SMOOTH.pinion_teeth / SMOOTH.gear_teeth
    np.testing.assert_allclose(run.shafts['drive_torque'], 150.0 * ratio, rtol=1e-13)
    run.command(speed=400.0)
    run.advance(100)
    carried = (150.0 + d.gear_inertia * accel * ratio) * ratio + d.pinion_inertia * accel
    np.testing.assert_allclose(run.shafts['drive_torque'], carried, rtol=1e-13)


def test_with_friction_the_forms_differ_by_the_loss_torque_alone():
    # The full form's mean gear balance is rb2 F = T2 + Tf2 with the drive making up the loss; in
    # the reduced form T1 = T2 z1 / z2 is all there is, so psi'' = 0 on average gives a lesser F:
    # (T2/rb2 - F)/me + rb1 Tf1 / I1 + rb2 Tf2 / I2 = 0.
    pair = GearPair(friction_coefficient=0.03)
    speed = 1000 * RPM
    per_cycle, cycles = 512, 40
    rate = per_cycle * 34 * speed / (2 * np.pi)
    means = []
    for drive in (True, False):
        run = Simulator(pair, speed=speed, sample_rate=rate, anti_alias=False, drive=drive)
        run.advance(300 * per_cycle)
        means.append(run.advance(cycles * per_cycle)['mesh_force'].mean())
    full, reduced = means
    load = 150.0 / pair.derived.gear_base_radius
    assert full > load
    assert 0 < (full - reduced) / full < pair.friction_coefficient


def test_ramp_keeps_the_phase_exact_and_the_rigid_rotation_small():
    # 500 to 15 000 rpm at 2000 rad/s2: Theta = w0 t + a t^2 / 2, then at constant speed.
    first, last, limit = 500 * RPM, 15000 * RPM, 2000.0
    run = Simulator(
        GearPair(), speed=first, speed_rate_limit=limit, sample_rate=2000.0, anti_alias=False
    )
    run.command(speed=last)
    ramp = (last - first) / limit
    rigid = []
    for _ in range(40):
        run.advance(50)
        rigid.append(rigid_rotation(run.pair, state_of_sample(run)))
    events = run.take_events()
    sections = events[events['kind'] == EventKind.SECTION]
    np.testing.assert_array_equal(sections['cycle'], np.arange(len(sections)) + 0.5)
    turned = 2 * math.pi * sections['cycle'] / 34
    at_end = first * ramp + limit * ramp**2 / 2
    during = (np.sqrt(first**2 + 2 * limit * turned) - first) / limit
    expected = np.where(turned < at_end, during, ramp + (turned - at_end) / last)
    assert 0.2 < np.mean(turned < at_end) < 0.99
    np.testing.assert_allclose(sections['t'], expected, rtol=1e-13, atol=1e-13)
    # Only the friction's mean loss, a few tenths of a newton metre, moves q; the drive's
    # stiffness is kd = (2 pi 5 Hz)^2 It = 2.5 N m/rad.
    q, q_dot = np.array(rigid).T
    assert np.max(np.abs(q)) < 0.3
    assert np.max(np.abs(q_dot)) < 0.005 * last


def test_ramp_without_friction_leaves_the_rigid_rotation_at_zero():
    run = Simulator(SMOOTH, speed=500 * RPM, speed_rate_limit=5000.0, anti_alias=False)
    run.command(speed=3000 * RPM, load_torque=80.0)
    run.advance(20480)
    assert rigid_rotation(SMOOTH, state_of_sample(run))[0] == pytest.approx(0, abs=1e-17)


def test_drive_makes_up_the_loss_of_friction():
    # After the integrator of the drive has settled, q returns to zero: its mean over whole
    # cycles, from which the angles are read.
    run = Simulator(
        dataclasses.replace(GearPair(), drive_frequency=50.0), anti_alias=False, sample_rate=5000.0
    )
    run.advance(5000)
    late = []
    for _ in range(400):
        run.advance(1)
        late.append(rigid_rotation(run.pair, state_of_sample(run))[0])
    early = Simulator(
        dataclasses.replace(GearPair(), drive_frequency=50.0), anti_alias=False, sample_rate=5000.0
    )
    early.advance(20)
    assert abs(np.mean(late)) < 0.01 * abs(rigid_rotation(run.pair, state_of_sample(early))[0])
