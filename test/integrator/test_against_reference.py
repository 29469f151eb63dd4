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

from gear_dynamics.machine.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair

DEFAULT = GearPair()
RPM = np.pi / 30
TOLERANCES = tuple(10.0**-k for k in range(2, 13))
STEPS_REMEMBERED = 10.0
"""Steps of which the errors add up: those within 1 / (zeta wn) = 1 ms, at most eight in 'no loss'.
Contact losses only make the steps shorter, and their errors less."""

TIMES_RTOL = 5.0
"""Room over what is seen: the worst column's error is 1.1 rtol at 1e-6 and at 1e-8."""

SECTION_PHASE = 0.25

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
    """One of the motions: its definition, start, reference, reference samples and sections."""
    pair, speed, torque, cycles, losses = MOTIONS[request.param]
    start = settled_state(pair, speed, torque, cycles)
    times = np.arange(256) / RATE
    cycle = 2 * np.pi / (speed * pair.pinion_teeth)
    every = np.append(times, np.arange(SECTION_PHASE, times[-1] / cycle) * cycle)
    reference = Reference(pair, speed, torque)
    order = np.argsort(every)
    rows, away = (each[np.argsort(order)] for each in reference.run(every[order], start))
    n = len(times)
    return pair, speed, torque, losses, start, reference, rows[:n], away[:n], rows[n:]


def tolerances_of_columns(model, rows):
    """Return what a step may be wrong by, of the columns that vibrate (docs/model.md).

    A tenth of atol b + rtol |delta|; of a velocity wn times, of an acceleration wn^2 times, of a
    force k times that.
    """
    largest = np.abs(rows[:, COLUMNS.index('delta')]).max()
    settings, pair = model.settings, model.pair
    length = 0.1 * (settings.atol * pair.half_backlash + settings.rtol * largest)
    wn, k = pair.derived.wn, pair.tooth_pair_stiffness
    scales = {'delta': 1.0, 'delta_dot': wn, 'mesh_force': k}
    scales['friction_force'] = k * pair.friction_coefficient
    scales |= dict.fromkeys(('pinion_ax', 'pinion_ay', 'gear_ax', 'gear_ay'), wn**2)
    return np.array([length * scales.get(name, np.inf) for name in COLUMNS])


def test_error_falls_with_the_tolerance_on_regular_motions(motion):
    pair, speed, torque, _, start, _, rows, away, _ = motion
    rms = np.sqrt(np.mean(rows**2, axis=0))
    worst = []
    for rtol in TOLERANCES:
        model = simulator(pair, speed, torque, rtol)
        start_from(model, start)
        got = columns(model.advance(len(rows)))
        errors = relative_errors(got[away], rows[away])
        promised = STEPS_REMEMBERED * tolerances_of_columns(model, rows) / rms
        assert np.all(errors <= promised + ACCURACY), rtol
        worst.append(errors.max())
    # Where events set the steps, a looser tolerance changes no more than rounding.
    assert np.diff(worst).max() <= ACCURACY, worst
    assert worst[TOLERANCES.index(1e-10)] <= ACCURACY


@pytest.mark.parametrize('motion', ['no loss'], indirect=True)
@pytest.mark.parametrize('rtol', [1e-6, 1e-8])
def test_rms_error_is_about_rtol_where_the_tolerance_sets_the_steps(motion, rtol):
    pair, speed, torque, _, start, _, rows, away, _ = motion
    model = simulator(pair, speed, torque, rtol)
    start_from(model, start)
    errors = (columns(model.advance(len(rows))) - rows)[away]
    rms = np.sqrt(np.mean(rows[away] ** 2, axis=0))
    assert np.all(np.sqrt(np.mean(errors**2, axis=0)) < TIMES_RTOL * rtol * rms)


def test_motions_are_periodic_and_lose_contact_as_often_as_known(motion):
    pair, speed, torque, losses, start, *_ = motion
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
    pair, speed, torque, _, start, reference, rows, *_ = motion
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
    pair, speed, torque, _, start, _, rows, _, expected = motion
    model = simulator(pair, speed, torque, 1e-12, section_phase=SECTION_PHASE)
    start_from(model, start)
    model.advance(len(rows))
    sections = model.take_events()
    sections = sections[sections['kind'] == EventKind.SECTION]
    np.testing.assert_array_equal(sections['cycle'], np.arange(len(expected)) + SECTION_PHASE)
    times = sections['cycle'] * 2 * np.pi / (pair.pinion_teeth * speed)
    np.testing.assert_allclose(sections['t'], times, rtol=1e-13)
    np.testing.assert_allclose(
        sections['delta'], expected[:, COLUMNS.index('delta')], rtol=ACCURACY
    )
    rates = expected[:, COLUMNS.index('delta_dot')]
    scale = np.sqrt(np.mean(rows[:, COLUMNS.index('delta_dot')] ** 2))
    np.testing.assert_allclose(sections['delta_dot'], rates, rtol=0, atol=ACCURACY * scale)
