"""Commands, rate limits and live changes of a running pair."""

import copy
import dataclasses

import numpy as np
import pytest
from ros_support import ROOT

from gear_dynamics.integrator.layout import AHEAD
from gear_dynamics.machine.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports, ToothDeviation
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.simulation.simulator import Simulator

RATE = 51200.0
SMOOTH = GearPair(friction_coefficient=0.0, transmission_error_amplitude=0.0)


@pytest.mark.parametrize(('target', 'sign'), [(200.0, 1), (40.0, -1)])
def test_torque_follows_at_its_rate_limit_from_the_next_sample(target, sign):
    simulator = Simulator(GearPair(), torque_rate_limit=2000.0, anti_alias=False)
    simulator.advance(100)
    simulator.command(load_torque=target)
    torque = simulator.advance(5000)['load_torque']
    t = np.arange(5000) / RATE
    limited = 150.0 + sign * 2000.0 * t
    expected = np.minimum(limited, target) if sign > 0 else np.maximum(limited, target)
    np.testing.assert_allclose(torque, expected, rtol=1e-12)
    assert torque[-1] == target


def test_mean_speed_follows_at_its_rate_limit():
    simulator = Simulator(SMOOTH, speed=50.0, speed_rate_limit=300.0, anti_alias=False)
    simulator.advance(1000)
    simulator.command(speed=80.0)
    samples = simulator.advance(10240)
    expected = np.minimum(50.0 + 300.0 * np.arange(10240) / RATE, 80.0)
    # Torsional vibration rides on it; a window of 10 ms averages it.
    window = np.ones(512) / 512
    got = np.convolve(samples['speed'], window, 'valid')
    np.testing.assert_allclose(got, np.convolve(expected, window, 'valid'), atol=0.2)


def test_last_command_holds_and_commands_mid_ramp_turn_at_once():
    simulator = Simulator(GearPair(), torque_rate_limit=1000.0, anti_alias=False)
    simulator.command(load_torque=300.0)
    simulator.advance(512)
    simulator.command(load_torque=100.0)
    torque = simulator.advance(8000)['load_torque']
    peak = 150.0 + 1000.0 * 512 / RATE
    np.testing.assert_allclose(
        torque, np.maximum(peak - 1000.0 * np.arange(8000) / RATE, 100.0), rtol=1e-12
    )


def test_ramps_that_last_for_seconds_end_when_they_should():
    # Time is counted from an origin that moves on once a second, in the midst of the ramps.
    begin, duration, rate = 0.5, 2.0, 2000.0
    speeds, torques = (100.0, 160.0), (150.0, 90.0)
    accel, slope = (speeds[1] - speeds[0]) / duration, (torques[1] - torques[0]) / duration
    simulator = Simulator(
        SMOOTH,
        sample_rate=rate,
        speed=speeds[0],
        load_torque=torques[0],
        speed_rate_limit=abs(accel),
        torque_rate_limit=abs(slope),
        anti_alias=False,
    )
    before = simulator.advance(round(begin * rate))
    simulator.command(speed=speeds[1], load_torque=torques[1])
    after = simulator.advance(round(4.0 * rate))
    t = np.concatenate([before['t'], after['t']])
    ramped = np.clip(t - begin, 0, duration)
    torque = np.concatenate([before['load_torque'], after['load_torque']])
    np.testing.assert_allclose(torque, torques[0] + slope * ramped, rtol=1e-12)

    sections = simulator.take_events()
    sections = sections[sections['kind'] == EventKind.SECTION]
    ramped = np.clip(sections['t'] - begin, 0, duration)
    rested = np.maximum(sections['t'] - begin - duration, 0)
    turned = speeds[0] * (sections['t'] - rested) + accel * ramped**2 / 2 + speeds[1] * rested
    cycles = SMOOTH.pinion_teeth * turned / (2 * np.pi)
    # The rounding of thousands of cycles.
    np.testing.assert_allclose(cycles, np.arange(len(sections)) + 0.5, rtol=1e-12, atol=1e-9)
    assert sections['t'][-1] > 4.4


def test_rate_limits_change_while_running():
    simulator = Simulator(GearPair(), torque_rate_limit=1000.0, anti_alias=False)
    simulator.command(load_torque=300.0)
    simulator.advance(512)
    simulator.change(torque_rate_limit=4000.0, speed_rate_limit=50.0)
    torque = simulator.advance(1000)['load_torque']
    np.testing.assert_allclose(torque, 160.0 + 4000.0 * np.arange(1000) / RATE, rtol=1e-12)


@pytest.mark.parametrize(
    'values', [{'speed': -1.0}, {'speed': np.nan}, {'load_torque': 5001.0}, {'load_torque': np.inf}]
)
def test_bad_commands_are_refused_and_change_nothing(values):
    simulator = Simulator(GearPair(), anti_alias=False)
    simulator.advance(100)
    with pytest.raises(ParameterError, match=next(iter(values))):
        simulator.command(**values)
    undisturbed = Simulator(GearPair(), anti_alias=False)
    undisturbed.advance(100)
    assert simulator.advance(500).tobytes() == undisturbed.advance(500).tobytes()


@pytest.mark.parametrize('change', ['command', 'pair'])
def test_state_and_phase_go_on_through_a_change(change):
    simulator = Simulator(GearPair(), sample_rate=1e6, anti_alias=False)
    undisturbed = Simulator(GearPair(), sample_rate=1e6, anti_alias=False)
    simulator.advance(20000)
    undisturbed.advance(20000)
    if change == 'command':
        simulator.command(speed=300.0, load_torque=20.0)
    else:
        simulator.change(pair=dataclasses.replace(GearPair(), friction_coefficient=0.1))
    changed, same = simulator.advance(3), undisturbed.advance(3)
    # The sample of the change itself has the old state.
    for name in ('delta', 'pinion_angle', 'gear_angle'):
        assert changed[name][0] == pytest.approx(same[name][0], rel=1e-13)
    assert changed['delta_dot'][0] == pytest.approx(same['delta_dot'][0], rel=1e-9)


def test_live_change_is_a_run_with_the_new_parameters():
    new = dataclasses.replace(
        GearPair(), friction_coefficient=0.1, mesh_damping_ratio=0.05, half_backlash=100e-6
    )
    changed = Simulator(GearPair(), anti_alias=False)
    changed.advance(1000)
    changed.change(pair=new)
    assert changed.pair == new
    # Transients die out with the slowest mode, 1793 Hz at a few per cent; periodic at 1000 rpm.
    changed.advance(30 * 1024)
    fresh = Simulator(new, anti_alias=False)
    fresh.advance(30 * 1024 + 1000)
    one, two = changed.advance(1000), fresh.advance(1000)
    for name in ('mesh_force', 'pinion_ay', 'pinion_ax'):
        scale = np.sqrt(np.mean(two[name] ** 2))
        difference = np.abs(one[name] - two[name])
        assert np.quantile(difference, 0.99) < 1e-4 * scale, name


def test_friction_switched_off_and_on():
    simulator = Simulator(GearPair(), anti_alias=False)
    simulator.advance(100)
    simulator.change(pair=dataclasses.replace(GearPair(), friction_coefficient=0.0))
    assert np.all(simulator.advance(500)['friction_force'] == 0)
    simulator.change(pair=GearPair())
    assert np.any(simulator.advance(500)['friction_force'] != 0)


OTHER = {
    'stiffness_ratio': 1.7,
    'tip_relief_shape': 'parabolic',
    'friction_model': 'xu_kahraman',
    'support_model': 'rigid',
}
OTHER |= dict.fromkeys(
    ('stiffness_harmonics', 'stiffness_table', 'transmission_error_harmonics'), '1 1e-6 0'
)


@pytest.mark.parametrize(
    'name', [p.name for p in GearPair.parameters() if not p.live and p.name != 'mesh_stiffness']
)
def test_what_is_fixed_cannot_change(name):
    simulator = Simulator(GearPair(), anti_alias=False)
    value = getattr(GearPair(), name)
    other = value + 1 if isinstance(value, int) else OTHER.get(name) or value * 1.01 or 1.0
    # Not by `replace`, which refuses values that need others.
    new = copy.copy(GearPair())
    object.__setattr__(new, name, other)
    with pytest.raises(ValueError, match=f'{name} is .*: it cannot change while running'):
        simulator.change(pair=new)
    assert simulator.pair == GearPair()


def test_standstill_and_back():
    simulator = Simulator(SMOOTH, speed=20.0, speed_rate_limit=1000.0, anti_alias=False)
    simulator.command(speed=0.0)
    simulator.advance(20480)
    still = simulator.advance(2048)
    assert np.ptp(still['pinion_angle']) < 1e-5
    assert np.abs(still['speed']).max() < 0.05
    simulator.command(speed=20.0)
    simulator.advance(20480)
    assert simulator.advance(2048)['speed'].mean() == pytest.approx(20.0, rel=0.01)


@pytest.mark.parametrize(('anti_alias', 'shows_after'), [(True, AHEAD), (False, 1)])
def test_commands_begin_where_the_stream_is_integrated_to(anti_alias, shows_after):
    simulator = Simulator(GearPair(), torque_rate_limit=1e6, anti_alias=anti_alias)
    simulator.advance(100)
    simulator.command(load_torque=300.0)
    torque = simulator.advance(200)['load_torque']
    assert int(np.argmax(torque > 150.0)) == shows_after
    stated = (ROOT / 'docs' / 'interfaces.md').read_text()
    assert f'{AHEAD} samples ahead of what it hands out, {1e3 * AHEAD / RATE:.2f} ms' in stated


def test_change_to_the_same_pair_changes_nothing_even_with_a_tooth_out_of_contact():
    # A flank 60 um low on one pinion tooth: it does not touch while its neighbours carry.
    flank = Ports([ToothDeviation('pinion', 3, [0.001, 0.0095], error=[[60e-6]])])
    options = {'ports': flank, 'anti_alias': False, 'rtol': 1e-11, 'atol': 1e-14}
    undisturbed, changed = Simulator(GearPair(), **options), Simulator(GearPair(), **options)
    expected = undisturbed.advance(600)
    got = []
    for _ in range(60):
        got.append(changed.advance(10))
        changed.change(pair=GearPair())
    got = np.concatenate(got)
    for name in ('mesh_force', 'pinion_ay', 'delta'):
        scale = np.sqrt(np.mean(expected[name] ** 2))
        difference = np.abs(got[name] - expected[name])
        assert np.quantile(difference, 0.99) < 1e-8 * scale, name
    one, two = undisturbed.take_events(), changed.take_events()
    np.testing.assert_array_equal(two['kind'], one['kind'])
    assert EventKind.DRIVE_LOST in one['kind']


def test_contact_that_a_new_backlash_ends_is_an_event():
    simulator = Simulator(GearPair(), anti_alias=False)
    simulator.advance(1000)
    simulator.take_events()
    simulator.change(pair=dataclasses.replace(GearPair(), half_backlash=200e-6))
    simulator.advance(1000)
    contacts = simulator.take_events()
    contacts = contacts[contacts['kind'] != EventKind.SECTION]
    assert contacts['kind'][0] == EventKind.DRIVE_LOST
    assert contacts['t'][0] == pytest.approx(1000 / RATE, rel=1e-12)
    assert EventKind.DRIVE_REGAINED in contacts['kind']


def test_changes_where_a_cycle_begins_leave_the_motion_as_it_is():
    # At 1000 rpm every 1536th sample is the beginning of a cycle, but for rounding.
    speed = 1000 * np.pi / 30
    steady = Simulator(GearPair(), speed=speed, anti_alias=False)
    changed = Simulator(GearPair(), speed=speed, anti_alias=False)
    for _ in range(40):
        expected = steady.advance(1536)
        changed.change(pair=changed.pair)
        got = changed.advance(1536)
        # A sample at an event takes the value to either side of it.
        far = np.abs(got['mesh_force'] - expected['mesh_force']) > 1e-3
        assert far.sum() <= 4 * 17


def test_a_refused_change_changes_nothing():
    simulator = Simulator(GearPair(), anti_alias=False)
    rougher = dataclasses.replace(simulator.pair, friction_coefficient=0.5)
    with pytest.raises(ParameterError, match='speed_rate_limit is -1'):
        simulator.change(pair=rougher, speed_rate_limit=-1.0)
    assert simulator.pair.friction_coefficient == GearPair().friction_coefficient
    samples = simulator.advance(512)
    np.testing.assert_array_equal(samples, Simulator(GearPair(), anti_alias=False).advance(512))


def test_pair_that_stops_just_where_a_cycle_begins_starts_again():
    begin, teeth = 20.0, GearPair().pinion_teeth
    # From 20 rad/s to rest within one turn of a tooth.
    limit = begin**2 / (2 * 2 * np.pi / teeth)
    simulator = Simulator(SMOOTH, speed=begin, speed_rate_limit=limit, anti_alias=False)
    simulator.command(speed=0.0)
    simulator.advance(round(2 * RATE * begin / limit))
    simulator.take_events()
    started = simulator.samples_done / RATE
    simulator.change(speed_rate_limit=200.0)
    simulator.command(speed=100.0)
    simulator.advance(round(0.5 * RATE))
    sections = simulator.take_events()
    passed = sections['t'][sections['kind'] == EventKind.SECTION] - started
    phases = 0.5 + np.arange(len(passed))
    np.testing.assert_allclose(passed, np.sqrt(2 * phases * 2 * np.pi / teeth / 200), atol=1e-6)
    assert len(passed) > 100
