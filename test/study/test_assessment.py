import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from dynamics.test_cycles import one_degree_of_freedom, speed_at

from gear_dynamics.dynamics.regimes import ENOUGH
from gear_dynamics.study import assessment
from gear_dynamics.study.assessment import assess
from gear_dynamics.study.initial import scattered_states, states_at
from gear_dynamics.study.operating_point import OperatingPoint, friction_chaos


def undamped(w):
    """The one-degree-of-freedom oscillator without damping, far from the gap."""
    pair = one_degree_of_freedom(mesh_damping_ratio=0.0, transmission_error_amplitude=1e-6)
    pair = dataclasses.replace(pair, support_damping_ratio=0.0)
    return OperatingPoint(pair, speed_at(pair, w), 500.0)


def test_free_and_forced_vibration_together_are_quasi_periodic():
    """Without damping both last: two frequencies, 1 and the golden mean, and an exponent of 0."""
    operation = undamped((np.sqrt(5) - 1) / 2)
    start = states_at(operation, np.array([1.1]), np.array([0.0]))
    assessed = assess([operation], start, 100, k=1)
    assert list(assessed['kind']) == ['quasi-periodic']
    assert abs(assessed['exponents'][0, 0]) < 1e-3
    # 100 cycles leave it open: the record was gone on with until the 0-1 test could be had.
    assert assessed['discarded'][0] >= 100
    assert assessed['zero_one'][0] < 0.2
    assert assessed['sections'].shape == (1, 100, 2)


def test_free_and_forced_vibration_in_a_ratio_of_whole_numbers_have_a_period():
    """w = 4/3: the free vibration returns after 4 cycles of the drive, which take 3 of its own."""
    operation = undamped(4 / 3)
    start = states_at(operation, np.array([1.1]), np.array([0.0]))
    assert list(assess([operation], start, 100, k=1)['kind']) == ['period-4']


def test_settled_motion_is_judged_from_its_first_record():
    operation = friction_chaos().with_value('w', 0.6)
    states = scattered_states(operation, 1)
    assessed = assess([operation], assess([operation], states, ENOUGH)['states'], 150)
    assert list(assessed['kind']) == ['period-1']
    assert assessed['discarded'][0] < 150
    assert assessed['settled'].all()
    assert assessed['convergence'].shape == (1, 10, 10)


def test_open_motions_go_on_from_their_ends_and_are_judged_from_there_alone(monkeypatch):
    """Of three motions with known rates and sections one is settled, one decays towards its rate
    for 100 cycles, and of one 100 cycles do not tell the kind."""
    first_record = 100
    operation = friction_chaos()
    scale = np.array([1, operation.pair.derived.wn]) * operation.pair.half_backlash
    golden = np.pi * (np.sqrt(5) - 1)

    rates = (
        lambda t: np.full(t.shape, -0.1),
        lambda t: np.where(t < 100, t / 100 - 1, -0.2),
        lambda t: np.zeros(t.shape),
    )

    def section(motion, t):
        angle = golden * t if motion == 2 else np.zeros(t.shape)
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def run(pairs, speeds, torques, cycles, states, vectors, section_phase):
        """States are the cycles done and the motion."""
        motions = [(int(motion), done + np.arange(cycles)) for done, motion in states]
        growth = np.array([rates[motion](t) for motion, t in motions])
        return SimpleNamespace(
            sections=np.array([section(motion, t) for motion, t in motions]) * scale,
            growth=growth[..., np.newaxis] * operation.cycle,
            states=states + np.array([cycles, 0]),
            vectors=vectors + cycles,
        )

    monkeypatch.setattr(assessment.dynamics, 'run_cycles', run)
    start = np.array([[0.0, 0.0], [0.0, 1.0], [0.0, 2.0]])
    assessed = assess([operation] * 3, start, first_record, k=1)
    assert list(assessed['kind']) == ['period-1', 'period-1', 'quasi-periodic']
    assert assessed['settled'].all()
    assert assessed['exponents'][:, 0] == pytest.approx([-0.1, -0.2, 0.0])
    assert list(assessed['discarded']) == [0, 100, 100]
    ends = first_record + np.array([0, ENOUGH, ENOUGH])
    assert list(assessed['states'][:, 0]) == list(ends)
    assert np.ptp(assessed['vectors'] - ends[:, np.newaxis, np.newaxis], axis=0) == pytest.approx(0)
    last = section(2, np.arange(ends[2] - first_record, ends[2]))
    assert assessed['sections'][2] == pytest.approx(last)
