"""Steps with constant stiffness and damping, whose offset varies or follows one that varied."""

import numpy as np

from gear_dynamics.integrator import recurrence
from gear_dynamics.integrator.layout import (
    DELTA,
    ROWS,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SEGMENT,
    STATES,
    WIDTH,
)
from gear_dynamics.integrator.records import empty_records
from gear_dynamics.integrator.series import expand
from gear_dynamics.integrator.variation import damping_at_end


def test_varying_offset_gives_the_series_of_the_convolution():
    """Both forms of the recurrence, given the same constant stiffness and the same offset."""
    rng = np.random.default_rng(5)
    record = empty_records(1)[0]
    step, constants = record['step'], record['constants']
    answers = rng.standard_normal((recurrence.ANSWERS, 8))
    answers[:, DELTA] = 0.0
    constants['answers'] = answers
    # travel = pitch z1 speed / 2 pi
    constants['pitch'], constants['z1'] = 0.3, 2 * np.pi
    record['commands']['speed'] = record['commands']['accel'] = 1.0
    record['commands']['torque'], record['commands']['torque_rate'] = 0.7, -0.4
    degree = 9
    record['segment'][:, 0] = rng.standard_normal(SEGMENT)
    falls = 0.5 ** np.arange(1, degree + 1)
    for row in (SEG_FORCE, SEG_FRICTION, SEG_MOMENT):
        record['segment'][row + 2, 1 : degree + 1] = rng.standard_normal(degree) * falls
    record['state'] = rng.standard_normal(STATES)
    record['error'][0] = rng.standard_normal(ROWS) * 0.5 ** np.arange(ROWS)
    step['degree'] = degree

    expand(record)
    found = record['series'].copy()
    # An order of stiffness that is counted, and zero, asks for the convolution.
    step['stiffness_degree'] = 1
    expand(record)

    np.testing.assert_allclose(found, record['series'], rtol=1e-10, atol=1e-12)
    assert np.abs(found[WIDTH]).max() > 0.0


def test_damping_at_the_end_takes_no_coefficients_of_earlier_steps():
    record = empty_records(1)[0]
    record['segment'][:, 0] = np.arange(SEGMENT)
    record['segment'][:, 1:5] = 7.0
    record['step']['length'] = 0.5
    damping = np.zeros(3)

    damping_at_end(record, damping)

    np.testing.assert_array_equal(damping, [SEG_FORCE + 1, SEG_FRICTION + 1, SEG_MOMENT + 1])
