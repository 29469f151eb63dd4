import dataclasses

import numpy as np
from study.test_cycles import one_degree_of_freedom, speed_at

from gear_dynamics.analysis.regime import ENOUGH
from gear_dynamics.study.initial import scattered_states, states_at
from gear_dynamics.study.judgement import judge
from gear_dynamics.study.operation import Operation, friction_chaos


def undamped(w):
    """The one-degree-of-freedom oscillator without damping, far from the gap."""
    pair = one_degree_of_freedom(mesh_damping_ratio=0.0, transmission_error_amplitude=1e-6)
    pair = dataclasses.replace(pair, support_damping_ratio=0.0)
    return Operation(pair, speed_at(pair, w), 500.0)


def test_free_and_forced_vibration_together_are_quasi_periodic():
    """Without damping both last: two frequencies, 1 and the golden mean, and an exponent of 0."""
    operation = undamped((np.sqrt(5) - 1) / 2)
    start = states_at(operation, np.array([1.1]), np.array([0.0]))
    judged = judge([operation], start, 100, k=1)
    assert list(judged['kind']) == ['quasi-periodic']
    assert abs(judged['exponents'][0, 0]) < 1e-3
    # 100 cycles leave it open: the record was gone on with until the 0-1 test could be had.
    assert judged['discarded'][0] >= 100
    assert judged['zero_one'][0] < 0.2
    assert judged['sections'].shape == (1, 100, 2)


def test_free_and_forced_vibration_in_a_ratio_of_whole_numbers_have_a_period():
    """w = 4/3: the free vibration returns after 4 cycles of the drive, which take 3 of its own."""
    operation = undamped(4 / 3)
    start = states_at(operation, np.array([1.1]), np.array([0.0]))
    assert list(judge([operation], start, 100, k=1)['kind']) == ['period-4']


def test_settled_motion_is_judged_from_its_first_record():
    operation = friction_chaos().with_value('w', 0.6)
    states = scattered_states(operation, 1)
    judged = judge([operation], judge([operation], states, ENOUGH)['states'], 150)
    assert list(judged['kind']) == ['period-1']
    assert judged['discarded'][0] < 150
    assert judged['settled'].all()
    assert judged['convergence'].shape == (1, 10, 10)
