"""Out of contact: free flight, and bouncing between the flanks."""

import dataclasses
import math

import numpy as np
import pytest
from states import start_from, state_of_sample

from gear_dynamics.machine.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

# On stiff supports with heavy bodies only the gears' rotation moves: one degree of freedom.
RIGID = GearPair(
    mesh_stiffness='constant',
    tooth_pair_stiffness=1e7,
    mesh_damping_ratio=0.0,
    friction_coefficient=0.0,
    transmission_error_amplitude=0.0,
    pinion_mass=1e5,
    gear_mass=1e5,
    pinion_inertia=6.3276e-4,
    gear_inertia=5.7e-3,
    pinion_support_stiffness=1e15,
    gear_support_stiffness=1e15,
)


def in_the_gap(pair, delta, delta_dot, **values):
    """Return a simulator whose supports are at rest, q = 0, with the given delta and delta'."""
    simulator = Simulator(pair, anti_alias=False, **{'rtol': 1e-12, 'atol': 1e-15, **values})
    d, p = pair.derived, pair
    error = p.transmission_error_amplitude * math.sin(p.transmission_error_phase)
    rate = p.transmission_error_amplitude * math.cos(p.transmission_error_phase)
    rate *= p.pinion_teeth * simulator.settings.speed
    gear = -d.pinion_inertia * d.gear_base_radius / (d.gear_inertia * d.pinion_base_radius)
    pinion = 1 / (d.pinion_base_radius - gear * d.gear_base_radius)
    y = np.zeros(13)
    y[4], y[10] = (delta + error) * pinion, (delta_dot + rate) * pinion
    y[5], y[11] = y[4] * gear, y[10] * gear
    start_from(simulator, y)
    return simulator


@pytest.mark.parametrize('load_torque', [0.0, 20.0, -20.0])
@pytest.mark.parametrize('speed', [0.0, 150.0])
def test_free_flight_is_exact(load_torque, speed):
    pair = GearPair(friction_coefficient=0.2, transmission_error_phase=0.3)
    simulator = in_the_gap(pair, 20e-6, 0.05, speed=speed, load_torque=load_torque)
    samples = simulator.advance(30)
    t, d = samples['t'], pair.derived
    phase = 34 * speed * t + 0.3
    error, first = 15e-6 * np.sin(phase), 15e-6 * math.sin(0.3)
    error_dot, first_dot = 15e-6 * 34 * speed * np.cos(phase), 15e-6 * 34 * speed * math.cos(0.3)
    pull = load_torque / (d.gear_base_radius * d.equivalent_mass)
    delta = 20e-6 + first + (0.05 + first_dot) * t + pull * t**2 / 2 - error
    flying = np.cumprod(np.abs(delta) < 150e-6).astype(bool)
    assert np.count_nonzero(flying) > 15
    np.testing.assert_allclose(samples['delta'][flying], delta[flying], rtol=0, atol=1e-17)
    delta_dot = 0.05 + first_dot + pull * t - error_dot
    np.testing.assert_allclose(samples['delta_dot'][flying], delta_dot[flying], rtol=1e-11)
    for name in ('mesh_force', 'friction_force', 'pinion_ax', 'pinion_ay', 'gear_ax', 'gear_ay'):
        np.testing.assert_allclose(samples[name][flying], 0, atol=1e-12)


@pytest.mark.parametrize('zeta', [0.0, 0.02])
def test_bouncing_between_both_flanks_keeps_time_and_speed(zeta):
    # A half wave of the contact oscillator on each flank, then 2 b of flight; damping takes
    # exp(-zeta pi / sqrt(1 - zeta^2)) of the speed at each half wave that ends at delta = b, where
    # the elastic force is zero.
    pair = dataclasses.replace(RIGID, mesh_damping_ratio=zeta)
    speed0, b = 0.8, pair.half_backlash
    simulator = in_the_gap(pair, 0.0, speed0, speed=0.0, load_torque=0.0)
    simulator.advance(3000)
    events = simulator.take_events()
    events = events[events['kind'] != EventKind.SECTION]
    # Every tooth pair has its own events: two at a standing mesh phase 0.
    times, first = np.unique(events['t'], return_index=True)
    kinds = events['kind'][first]
    cycle = [EventKind.DRIVE_REGAINED, EventKind.DRIVE_LOST]
    cycle += [EventKind.BACK_REGAINED, EventKind.BACK_LOST]
    assert len(times) > 40
    np.testing.assert_array_equal(kinds, np.resize(cycle, len(kinds)))
    half_wave = math.pi / (pair.derived.wn * math.sqrt(1 - zeta**2))
    restitution = math.exp(-zeta * math.pi / math.sqrt(1 - zeta**2))
    t, v, expected = b / speed0, speed0, []
    while len(expected) < len(times):
        expected += [t, t + half_wave]
        v *= restitution
        t += half_wave + 2 * b / v
    np.testing.assert_allclose(times, expected[: len(times)], rtol=1e-7)
    speeds = np.abs(events['delta_dot'][first])
    bounces = (np.arange(len(speeds)) + 1) // 2
    np.testing.assert_allclose(speeds, speed0 * restitution**bounces, rtol=1e-7)
    assert simulator.counters['back_flank_impacts'] == np.count_nonzero(
        kinds == EventKind.BACK_REGAINED
    )
    assert simulator.counters['contact_losses'] == len(times) // 2


def test_bouncing_keeps_momentum_and_energy():
    pair = GearPair(
        friction_coefficient=0.0, mesh_damping_ratio=0.0, support_damping_ratio=0.0,
        transmission_error_amplitude=0.0, mesh_stiffness='constant',
    )  # fmt: skip
    simulator = in_the_gap(pair, 30e-6, 0.5, speed=0.0, load_torque=0.0)
    d, energies = pair.derived, []
    for _ in range(100):
        sample = simulator.advance(20)[-1]
        y = state_of_sample(simulator)
        masses = [d.pinion_mass] * 2 + [d.gear_mass] * 2 + [d.pinion_inertia, d.gear_inertia]
        kinetic = 0.5 * np.dot(masses, y[6:12] ** 2)
        supports = 0.5 * np.dot([5e8] * 4, y[:4] ** 2)
        pressed = max(abs(sample['delta']) - pair.half_backlash, 0.0)
        energies.append(kinetic + supports + 0.5 * 5.33e8 * pressed**2)
        # The forces on the line of action are opposite, and their moments balance:
        # I1 th1'/rb1 + I2 th2'/rb2 is kept.
        moment = d.pinion_inertia * y[10] / d.pinion_base_radius
        other = d.gear_inertia * y[11] / d.gear_base_radius
        assert abs(moment + other) < 1e-12 * (abs(moment) + abs(other)) + 1e-16
    assert simulator.counters['back_flank_impacts'] > 10
    np.testing.assert_allclose(energies, energies[0], rtol=1e-9)


def swing(flank, depth):
    """Return the contact events of one swing on a flank that ends `depth` past its edge.

    Undamped about the deflection F / k: from twice that and `depth` it swings to b - depth.
    """
    force = 5.0
    load_torque = flank * force * RIGID.derived.gear_base_radius
    start = RIGID.half_backlash + 2 * force / RIGID.tooth_pair_stiffness + depth
    simulator = in_the_gap(RIGID, flank * start, 0.0, speed=0.0, load_torque=load_torque)
    simulator.advance(int(1.5 * math.pi / RIGID.derived.wn * 51200))
    events = simulator.take_events()
    events = events[events['kind'] != EventKind.SECTION]
    return list(events['kind'][np.unique(events['t'], return_index=True)[1]])


@pytest.mark.parametrize(
    ('flank', 'lost', 'regained'),
    [
        (1, EventKind.DRIVE_LOST, EventKind.DRIVE_REGAINED),
        (-1, EventKind.BACK_LOST, EventKind.BACK_REGAINED),
    ],
)
@pytest.mark.parametrize('depth', [1e-8, 1e-10, 1e-12, 1e-13])
def test_contact_lost_by_next_to_nothing_is_neither_missed_nor_imagined(
    flank, lost, regained, depth
):
    # Stiff supports of 1e15 N/m give way by 2e-8 of the swing, which is 1e-6 m.
    assert swing(flank, depth) == [lost, regained]
    assert swing(flank, -depth) == []
