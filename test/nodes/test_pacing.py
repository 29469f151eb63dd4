from fractions import Fraction

import pytest

from gear_dynamics.nodes.pacing import CATCH_UP, SECOND, Schedule, StampCounter


@pytest.mark.parametrize('rate', [51200.0, 44100.0, 33333.3])
def test_stamps_are_counted_not_added_up(rate):
    stamps = StampCounter(rate)
    stamps.set(0, 1_700_000_000_123_456_789)
    for sample in (1, 512, 10**6, 10**11):
        exact = 1_700_000_000_123_456_789 + sample * SECOND / Fraction(rate)
        assert abs(stamps.stamp(sample) - exact) <= Fraction(1, 2)


def test_stamps_follow_the_clock_forward_only():
    stamps = StampCounter(1000.0)
    stamps.set(0, 10 * SECOND)
    assert stamps.stamp(5000) == 15 * SECOND
    stamps.set(0, 12 * SECOND)
    assert stamps.stamp(0) == 15 * SECOND
    stamps.set(0, 20 * SECOND)
    assert stamps.stamp(1000) == 21 * SECOND


def test_blocks_are_due_at_the_interval():
    schedule = Schedule(10e6)
    schedule.start(0)
    sent = []
    for now in range(0, 1_000_000_000, 10_000_000):
        if schedule.due(now):
            schedule.done(now)
            sent.append(now)
    assert sent == list(range(10_000_000, 1_000_000_000, 10_000_000))
    assert schedule.overruns == 0
    assert schedule.lag(990_000_000) == 0


def test_short_stall_is_caught_up():
    schedule = Schedule(10e6)
    schedule.start(0)
    now, count = 200_000_000, 0
    while schedule.due(now):
        schedule.done(now)
        count += 1
    assert count == 20
    # Those due at 10 to 180 ms were late by more than one interval of 10 ms.
    assert schedule.overruns == 18
    assert schedule.lag(now) == 0


def test_long_stall_slows_simulated_time_and_the_lag_stays():
    schedule = Schedule(10e6)
    schedule.start(0)
    now, count = 5 * SECOND, 0
    while schedule.due(now):
        schedule.done(now)
        count += 1
    assert count == CATCH_UP // 10_000_000 + 1
    assert schedule.lag(now) == pytest.approx(5 - count * 0.01, abs=0.011)
    before = schedule.lag(now)
    schedule.done(now + 10_000_000)
    assert schedule.lag(now + 10_000_000) == pytest.approx(before, abs=0.011)


def test_start_forgets_the_lag():
    schedule = Schedule(10e6)
    schedule.start(0)
    schedule.done(5 * SECOND)
    schedule.start(6 * SECOND)
    assert schedule.lag(6 * SECOND) == 0
    assert not schedule.due(6 * SECOND)


def test_interval_zero_is_always_due_and_never_late():
    schedule = Schedule(0.0)
    schedule.start(0)
    for now in (0, 5, SECOND):
        assert schedule.due(now)
        schedule.done(now)
    assert schedule.overruns == 0
    assert schedule.lag(100 * SECOND) == 0
