"""Spans and sums of the stream, against the same computed at once."""

import math

import numpy as np
import pytest
from streams import RIG, START_NS, blocks, rotation, samples

from gear_dynamics.monitoring.contact_state import SampledContact, contact_state
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult, TableResult
from gear_dynamics.monitoring.spread import Spread
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.synchronous import other_wheel_leakage

SPEED = 104.72
TURN = 2 * np.pi / SPEED


def analysed(seconds, **settings):
    made = Monitor(AnalyzerSettings(**settings), Thresholds({}))
    made.configure(RIG)
    stream = blocks(samples(rotation(seconds)))
    return [result for stamp, rows in stream for result in made.add_block(stamp, rows)]


@pytest.mark.parametrize('sizes', [[1] * 50, [7, 93, 1, 899], [500, 500]])
def test_contact_from_blocks_is_that_of_the_whole(sizes):
    delta = np.cumsum(np.random.default_rng(1).normal(size=sum(sizes)))
    counter = SampledContact(2.0)
    for block in np.split(delta, np.cumsum(sizes)[:-1]):
        counter.add(block)
    found, expected = counter.take(), contact_state(delta, 2.0)
    assert found.losses == expected.losses
    assert found.back_impacts == expected.back_impacts
    assert found.out_of_contact == pytest.approx(expected.out_of_contact, rel=1e-12)
    # The step into the next block belongs to the next span.
    counter.add(delta[:1] + 1e9)
    assert counter.take().losses == 0


def test_spread_is_the_standard_deviation_of_the_batches_in_question():
    rng = np.random.default_rng(2)
    spread = Spread(10.0)
    delta = 5 + rng.normal(size=100)
    delta_dot = rng.normal(size=100)
    for first in range(0, 100, 10):
        spread.add(delta[first : first + 10], delta_dot[first : first + 10])
    # Batches end at 1, 2, ... 10 s: those from 2.5 to 6.0 s are 20 to 60.
    found = spread.over(2.5, 6.0)
    assert found[0] == pytest.approx(delta[20:60].std(), rel=1e-9)
    assert found[1] == pytest.approx(np.sqrt(np.mean(delta_dot[20:60] ** 2)), rel=1e-9)
    spread.forget(2.5)
    assert spread.over(2.5, 6.0) == pytest.approx(found, rel=1e-12)
    assert spread.over(11.0, 12.0) == (0.0, 0.0)


def test_an_average_that_would_last_too_long_is_cut_to_complete_revolutions():
    # Half a second holds 8 pinion revolutions of 0.06 s.
    results = analysed(2.0, average_longest=0.5, average_duration=0.1)
    found = [
        (result.span, row)
        for result in results
        if isinstance(result, ConditionResult)
        for row in result.rows
        if row.subject == 'mesh_force' and 'pinion_fm0' in row.values
    ]
    span, row = found[0]
    assert row.notes['revolutions'] == '8 of the pinion'
    assert span.duration == pytest.approx(8 * TURN, rel=1e-3)
    left = 20 * math.log10(other_wheel_leakage(8, 34, 59))
    assert f'up to {left:.0f} dB' in row.notes['other_wheel']
    starts = np.array([span.start_ns for span, _ in found])
    # The zero of the pinion's angle, once in 8 revolutions.
    turns = (starts - START_NS) / 1e9 / TURN
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-2)
    np.testing.assert_allclose(np.diff(turns), 8, atol=1e-2)


def test_order_spectra_follow_each_other_by_revolutions():
    tables = [
        result
        for result in analysed(6.5)
        if isinstance(result, TableResult) and result.name == 'order_spectrum'
    ]
    # 8 segments of 8 revolutions, each half over the one before.
    assert len(tables) >= 3
    for table in tables:
        assert table.span.duration == pytest.approx(36 * TURN, rel=1e-4)
    starts = [table.span.start_ns / 1e9 for table in tables]
    np.testing.assert_allclose(np.diff(starts), 32 * TURN, rtol=1e-4)
