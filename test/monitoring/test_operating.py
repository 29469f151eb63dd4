import math

import numpy as np
import pytest

from gear_dynamics.monitoring.operating import (
    LOAD,
    NO_ROTATION,
    SETTLING,
    SPEED,
    BatchState,
    History,
    OperatingState,
    centre,
)
from gear_dynamics.parameters.settings import AnalyzerSettings

STEP = 0.02


def states(values, **settings):
    """The states of (speed, load) pairs, one a batch of 20 ms."""
    operating = OperatingState(AnalyzerSettings(**settings))
    return [operating.push(speed, load, STEP) for speed, load in values]


def test_a_constant_state_is_steady_after_the_settling_time():
    reasons = [state.reason for state in states([(100.0, 150.0)] * 100)]
    # The first of the batches has age 0; 25 of 20 ms make half a second.
    assert reasons == [SETTLING] * 25 + [''] * 75


@pytest.mark.parametrize(
    ('before', 'after', 'reason'),
    [
        ((100.0, 150.0), (100.6, 150.0), SPEED),
        ((100.0, 150.0), (100.0, 154.0), LOAD),
        ((100.0, 150.0), (0.0, 150.0), NO_ROTATION),
        ((100.0, 150.0), (-50.0, 150.0), NO_ROTATION),
    ],
)
def test_a_step_is_not_steady(before, after, reason):
    found = states([before] * 100 + [after] * 20)
    assert found[99].reason == ''
    assert {state.reason for state in found[100:]} == {reason}


def test_changes_within_the_limits_are_steady():
    wander = [(100.0 + 0.4 * math.sin(k / 10), 150.0 + 1.0 * math.cos(k / 7)) for k in range(200)]
    assert all(state.reason == '' for state in states(wander)[100:])
    ramp = [(100.0 + 0.05 * k, 150.0) for k in range(200)]
    assert all(state.reason == SPEED for state in states(ramp)[30:])
    assert all(state.reason == '' for state in states(ramp, steady_speed=0.2)[30:])


def test_a_load_near_zero_is_compared_with_the_largest():
    noise = [(100.0, 100.0)] * 10 + [(100.0, 0.1 * (-1) ** k) for k in range(100)]
    assert states(noise)[-1].reason == ''


def test_speed_and_load_that_are_not_recorded_never_change():
    assert states([(math.nan, math.nan)] * 100)[-1].reason == ''


def test_bins_are_relative_and_sticky():
    def bin_of(speed, load):
        return states([(speed, load)])[0].bin

    assert bin_of(100.0, 150.0) == bin_of(101.0, 152.0)
    assert bin_of(100.0, 150.0) != bin_of(110.0, 150.0)
    assert bin_of(100.0, 150.0)[1] == -bin_of(100.0, -150.0)[1]
    assert bin_of(0.0, math.nan) == (0, 0)
    # At the edge of two bins, noise does not switch between them.
    _, edge = centre(bin_of(100.0, 150.0))
    edge *= math.sqrt(1.1)
    noisy = states([(100.0, edge * (1 + 0.005 * (-1) ** k)) for k in range(50)])
    assert len({state.bin for state in noisy}) == 1


@pytest.mark.parametrize('speed', [1e-2, 1.0, 104.72, 5000.0])
def test_the_centre_of_a_bin_lies_within_half_a_step(speed):
    found, _ = centre(states([(speed, 0.0)])[0].bin)
    assert abs(np.log(found / speed)) <= np.log(1.05) / 2 + 1e-9


def test_a_span_is_judged_only_if_all_of_it_was_steady():
    history = History()
    history.add(0, 100, BatchState(SPEED, (1, 1), 1.0, 1.0))
    for first in range(100, 300, 50):
        history.add(first, first + 50, BatchState('', (2, 2), 1.0, 1.0))
    history.add(300, 400, BatchState(LOAD, (3, 3), 1.0, 1.0))
    assert history.judge(100, 200) == ('', (2, 2))
    assert history.judge(99, 200).reason == SPEED
    assert history.judge(100, 201) == (LOAD, (2, 2))
    assert history.judge(0, 400).reason == SPEED
