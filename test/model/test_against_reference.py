"""The model against SciPy's DOP853 on equations written anew: regular motions, all columns.

Global error means nothing in chaos, so each case is periodic; it starts on its orbit. Samples that
coincide with an event are skipped: there a rounding decides on which side of the jump they fall.
"""

import dataclasses

import numpy as np
import pytest
from comparison import ACCURACY, RATE, columns, relative_errors, simulator
from reference_equations import COLUMNS
from reference_run import Reference
from states import settled_state, start_from

from gear_dynamics.model.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair

DEFAULT = GearPair()
RPM = np.pi / 30
TOLERANCES = (1e-6, 1e-8, 1e-10, 1e-12)
ERROR_PER_RTOL = 1000.0
"""Error over tolerance: the tolerance is relative to delta, some hundred times the vibration."""

MOTIONS = {
    # name: pair, speed, load torque, cycles to settle, contact losses a cycle
    'no loss': (DEFAULT, 1000 * RPM, 150.0, 100, 0),
    'one loss a cycle': (DEFAULT, 8000 * RPM, 150.0, 3000, 1),
    'two losses a cycle': (
        dataclasses.replace(DEFAULT, damping_in_gap=True), 3000 * RPM, 30.0, 1000, 2
    ),
}  # fmt: skip


@pytest.fixture(scope='module', params=list(MOTIONS))
def motion(request):
    """One of the motions: its definition, start, reference and reference samples."""
    pair, speed, torque, cycles, losses = MOTIONS[request.param]
    start = settled_state(pair, speed, torque, cycles)
    times = np.arange(256) / RATE
    reference = Reference(pair, speed, torque)
    rows, away = reference.run(times, start)
    return pair, speed, torque, losses, start, reference, rows, away


def test_error_falls_with_the_tolerance_on_regular_motions(motion):
    pair, speed, torque, _, start, _, rows, away = motion
    for rtol in TOLERANCES:
        model = simulator(pair, speed, torque, rtol)
        start_from(model, start)
        got = columns(model.advance(len(rows)))
        worst = relative_errors(got[away], rows[away]).max()
        assert worst < max(ERROR_PER_RTOL * rtol, ACCURACY)


def test_motions_are_periodic_and_lose_contact_as_often_as_known(motion):
    pair, speed, torque, losses, start, _, _, _ = motion
    model = simulator(pair, speed, torque, 1e-10)
    start_from(model, start)
    cycles = 20
    model.advance(int(RATE * cycles * 2 * np.pi / (speed * pair.pinion_teeth)))
    events = model.take_events()
    sections = events[events['kind'] == EventKind.SECTION]
    np.testing.assert_allclose(sections['delta'][1:], sections['delta'][0], rtol=1e-6)
    first, last = sections['t'][0], sections['t'][-1]
    within = (events['t'] >= first) & (events['t'] < last)
    lost = {p['t'] for p in events[within & (events['kind'] == EventKind.DRIVE_LOST)]}
    assert len(lost) == losses * (len(sections) - 1)


def test_contact_events_come_in_order_and_when_the_reference_has_them(motion):
    pair, speed, torque, _, start, reference, rows, _ = motion
    model = simulator(pair, speed, torque, 1e-12)
    start_from(model, start)
    model.advance(len(rows))
    events = model.take_events()
    assert np.all(np.diff(events['t']) >= 0)
    contacts = events[events['kind'] != EventKind.SECTION]
    hunting = np.lcm(pair.pinion_teeth, pair.gear_teeth)
    kinds = {(1, 0): 1, (0, 1): 2, (-1, 0): 3, (0, -1): 4}
    expected = [
        (t, kinds[before, after], number % hunting, delta, delta_dot)
        for t, before, after, number, delta, delta_dot in reference.events
        if t < (len(rows) - 1) / RATE
    ]
    got = [e for e in contacts if e['t'] < (len(rows) - 1) / RATE]
    assert len(got) == len(expected)
    if not expected:
        return
    times, known, numbers, deltas, rates = zip(*expected, strict=True)
    assert [e['kind'] for e in got] == list(known)
    assert [e['tooth_pair'] for e in got] == list(numbers)
    np.testing.assert_allclose([e['t'] for e in got], times, rtol=0, atol=1e-12)
    np.testing.assert_allclose([e['delta'] for e in got], deltas, rtol=1e-10)
    np.testing.assert_allclose([e['delta_dot'] for e in got], rates, rtol=1e-7)


def test_section_states_are_those_of_the_reference(motion):
    pair, speed, torque, _, start, _, rows, _ = motion
    model = simulator(pair, speed, torque, 1e-12, section_phase=0.25)
    start_from(model, start)
    model.advance(len(rows))
    sections = model.take_events()
    sections = sections[sections['kind'] == EventKind.SECTION]
    np.testing.assert_array_equal(sections['cycle'], np.arange(len(sections)) + 0.25)
    times = sections['cycle'] * 2 * np.pi / (pair.pinion_teeth * speed)
    np.testing.assert_allclose(sections['t'], times, rtol=1e-13)
    expected, _ = Reference(pair, speed, torque).run(times, start)
    np.testing.assert_allclose(
        sections['delta'], expected[:, COLUMNS.index('delta')], rtol=ACCURACY
    )
    rates = expected[:, COLUMNS.index('delta_dot')]
    scale = np.sqrt(np.mean(rows[:, COLUMNS.index('delta_dot')] ** 2))
    np.testing.assert_allclose(sections['delta_dot'], rates, rtol=0, atol=ACCURACY * scale)
