"""What the stepper takes of a segment whose degree falls from one step to the next."""

import numpy as np

from gear_dynamics.integrator.layout import SEG_FORCE, SEG_FRICTION, SEG_MOMENT, SEGMENT
from gear_dynamics.integrator.records import empty_records
from gear_dynamics.integrator.variation import damping_at_end


def test_damping_at_the_end_takes_no_coefficients_of_earlier_steps():
    record = empty_records(1)[0]
    record['segment'][:, 0] = np.arange(SEGMENT)
    record['segment'][:, 1:5] = 7.0
    record['step']['length'] = 0.5
    damping = np.zeros(3)

    damping_at_end(record, damping)

    np.testing.assert_array_equal(damping, [SEG_FORCE + 1, SEG_FRICTION + 1, SEG_MOMENT + 1])
