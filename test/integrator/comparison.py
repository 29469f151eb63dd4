"""Comparing samples of the model with those of the reference equations."""

import numpy as np
from reference_equations import COLUMNS

from gear_dynamics.simulation.simulator import Simulator

RATE = 51200.0
ACCURACY = 1e-9
"""Largest error of a column over its root mean square that the tolerance must be able to buy."""


def columns(samples):
    return np.stack([samples[name] for name in COLUMNS], axis=1)


def relative_errors(got, expected):
    """Return the largest error of each column over the column's root mean square."""
    difference = got - expected
    for name in ('pinion_angle', 'gear_angle'):
        j = COLUMNS.index(name)
        difference[:, j] = (difference[:, j] + np.pi) % (2 * np.pi) - np.pi
    rms = np.sqrt(np.mean(expected**2, axis=0))
    return np.max(np.abs(difference), axis=0) / np.where(rms > 0, rms, 1.0)


def simulator(pair, speed, load_torque, rtol, **options):
    return Simulator(
        pair,
        sample_rate=RATE,
        speed=speed,
        load_torque=load_torque,
        anti_alias=False,
        rtol=rtol,
        atol=max(rtol * 1e-3, 1e-15),
        **options,
    )
