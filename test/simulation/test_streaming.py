"""How the samples are taken leaves them as they are: blocks, repetition, sample rate."""

import dataclasses

import numpy as np
import pytest
from reference_equations import COLUMNS

from gear_dynamics.integrator.records import EVENT_ROOM
from gear_dynamics.machine.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulate import simulate
from gear_dynamics.simulation.simulator import Simulator

RPM = np.pi / 30
COUNT = 3000
# Chaotic, so that the least difference would show.
CHAOS = {'speed': 9500 * RPM, 'load_torque': 150.0}


def run(cuts, anti_alias, **values):
    """Return samples and events of a run in blocks that end at `cuts`, with two commands."""
    simulator = Simulator(GearPair(), anti_alias=anti_alias, **{**CHAOS, **values})
    samples, events, done = [], [], 0
    for cut in sorted({*cuts, 700, 1500, COUNT}):
        samples.append(simulator.advance(cut - done))
        events.append(simulator.take_events())
        done = cut
        if done == 700:
            simulator.command(speed=9000 * RPM)
        if done == 1500:
            simulator.command(load_torque=120.0)
    return np.concatenate(samples), np.concatenate(events)


@pytest.mark.parametrize('anti_alias', [False, True])
def test_blocks_do_not_change_a_bit(anti_alias):
    samples, events = run([], anti_alias)
    rng = np.random.default_rng(1)
    for cuts in (range(1, COUNT, 7), range(64, COUNT, 64), rng.integers(1, COUNT, 40), range(1, 9)):
        again, events_again = run([int(cut) for cut in cuts], anti_alias)
        assert again.tobytes() == samples.tobytes()
        assert events_again.tobytes() == events.tobytes()


@pytest.mark.parametrize('anti_alias', [False, True])
def test_runs_repeat_to_the_last_bit_also_after_reset(anti_alias):
    simulator = Simulator(GearPair(), anti_alias=anti_alias, **CHAOS)
    first, events = simulator.advance(COUNT), simulator.take_events()
    simulator.reset()
    assert simulator.samples_done == 0
    assert simulator.advance(COUNT).tobytes() == first.tobytes()
    assert simulator.take_events().tobytes() == events.tobytes()


def test_reset_starts_at_the_present_commands():
    simulator = Simulator(GearPair(), anti_alias=False)
    simulator.advance(100)
    simulator.command(speed=150.0, load_torque=80.0)
    simulator.advance(10)
    simulator.reset()
    fresh = Simulator(GearPair(), anti_alias=False, speed=150.0, load_torque=80.0)
    assert simulator.advance(500).tobytes() == fresh.advance(500).tobytes()


def test_simulate_is_a_simulator_run_from_rest():
    samples = simulate(GearPair(), 0.02, 20000.0, 150.0, 80.0, anti_alias=False).samples
    fresh = Simulator(
        GearPair(), sample_rate=20000.0, speed=150.0, load_torque=80.0, anti_alias=False
    )
    assert samples.tobytes() == fresh.advance(400).tobytes()
    np.testing.assert_array_equal(samples['t'], np.arange(400) / 20000.0)


@pytest.mark.parametrize('rpm', [1000, 8000])
def test_sample_rate_does_not_matter(rpm):
    # 51 200 and 3 x 51 200 samples/s share every third instant. A sample within rounding of an
    # event may fall on either side of it, so the worst hundredth is left out.
    options = {'speed': rpm * RPM, 'anti_alias': False, 'rtol': 1e-11, 'atol': 1e-14}
    slow = Simulator(GearPair(), sample_rate=51200.0, **options).advance(1000)
    fast = Simulator(GearPair(), sample_rate=153600.0, **options).advance(3000)[::3]
    for name in COLUMNS:
        scale = np.sqrt(np.mean(slow[name] ** 2))
        difference = np.abs(fast[name] - slow[name])
        assert np.quantile(difference, 0.99) <= 1e-8 * scale, name


def test_time_is_counted_in_whole_samples_over_the_seconds():
    simulator = Simulator(GearPair(), sample_rate=1000.0, anti_alias=False)
    samples = simulator.advance(4000)
    np.testing.assert_array_equal(samples['t'], np.arange(4000) / 1000.0)
    # The phase after four seconds is still that of the closed form.
    events = simulator.take_events()
    sections = events[events['kind'] == EventKind.SECTION]
    exact = sections['cycle'] * 2 * np.pi / (34 * 104.72)
    np.testing.assert_allclose(sections['t'], exact, rtol=0, atol=1e-12)


def test_events_are_handed_out_once_and_with_their_samples():
    whole = Simulator(GearPair(), speed=3200 * RPM, anti_alias=False)
    whole.advance(2048)
    expected = whole.take_events()
    assert len(whole.take_events()) == 0
    parts = Simulator(GearPair(), speed=3200 * RPM, anti_alias=False)
    got = []
    for block in range(32):
        parts.advance(64)
        events = parts.take_events()
        assert np.all(events['t'] >= block * 64 / 51200)
        assert np.all(events['t'] < (block + 1) * 64 / 51200)
        got.append(events)
    assert np.concatenate(got).tobytes() == expected.tobytes()


def test_more_events_than_the_buffer_holds_are_all_kept():
    # 1 s at 15 000 rpm: 8500 sections besides the contacts.
    simulator = Simulator(GearPair(), speed=15000 * RPM, sample_rate=1000.0, anti_alias=False)
    simulator.advance(1000)
    events = simulator.take_events()
    sections = events[events['kind'] == EventKind.SECTION]
    np.testing.assert_array_equal(sections['cycle'], np.arange(len(sections)) + 0.5)
    assert len(sections) == 8500 > EVENT_ROOM
    assert np.all(np.diff(events['t']) >= 0)


@pytest.mark.parametrize('section_phase', [0.0, 0.3, 0.7313, 0.999])
def test_section_phase_is_where_the_section_is(section_phase):
    simulator = Simulator(GearPair(), section_phase=section_phase, anti_alias=False)
    samples = simulator.advance(10240)
    events = simulator.take_events()
    sections = events[events['kind'] == EventKind.SECTION]
    np.testing.assert_array_equal(sections['cycle'], np.arange(len(sections)) + section_phase)
    # Pair A's number counts the engagements, modulo the hunting period of 34 x 59.
    np.testing.assert_array_equal(
        sections['tooth_pair'], np.floor(sections['cycle']).astype(int) % (34 * 59)
    )
    between = np.interp(sections['t'], samples['t'], samples['delta'])
    np.testing.assert_allclose(sections['delta'], between, rtol=1e-2)


def test_counters_count_what_the_events_say():
    pair = dataclasses.replace(GearPair(), half_backlash=10e-6)
    simulator = Simulator(pair, speed=9500 * RPM, load_torque=20.0, anti_alias=False)
    simulator.advance(20480)
    events, counters = simulator.take_events(), simulator.counters
    # Pairs of a healthy gear pair change together: one instant is one loss or impact.
    for name, kind in (('back_flank_impacts', EventKind.BACK_REGAINED),):
        assert counters[name] == len(np.unique(events['t'][events['kind'] == kind]))
        assert counters[name] > 10
    lost = np.isin(events['kind'], (EventKind.DRIVE_LOST, EventKind.BACK_LOST))
    assert counters['contact_losses'] == len(np.unique(events['t'][lost]))
    assert counters['steps'] > counters['contact_losses']
    assert 0 < counters['smallest_step'] < 1e-3
    simulator.reset()
    assert simulator.counters['steps'] == 0
    assert simulator.counters['smallest_step'] == 0.0
