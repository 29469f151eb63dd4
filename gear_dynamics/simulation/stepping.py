"""The stepper as a simulator calls it, and what it says when it cannot go on."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from gear_dynamics.integrator import stepper
from gear_dynamics.integrator.kernel import borrowed, kernel
from gear_dynamics.integrator.layout import DRIVE_TORQUE, GEAR_SPEED, HIGH_RATE_COLUMNS
from gear_dynamics.parameters.parameter import ParameterError

_NO_ROWS = np.zeros((0, HIGH_RATE_COLUMNS))


class IntegrationError(RuntimeError):
    """The integrator cannot go on; the message says when and why."""


def why_stopped(record: np.void, status: int, rtol: float) -> str:
    """Return when and why the integrator stopped with this status, and what may help.

    record : a record of MOTION
    """
    sampling = record['sampling']
    time = sampling['origin'] / sampling['sample_rate'] + record['step']['begin']
    what = f'the integrator stopped at t = {time:.9g} s'
    if status == stepper.STUCK:
        return (
            f'{what}: the step size fell through its floor; check the parameters, or try another '
            f'rtol than {rtol:g}'
        )
    return f'{what}: the motion is no longer finite; check the parameters'


@kernel(nogil=True)
def fill(records, zones, ports, jumps, whole_every, out):
    """Fill rows of `out` with the next samples; see `stepper.fill_samples`."""
    return stepper.fill_samples(
        records[0], borrowed(zones), borrowed(ports), borrowed(jumps), whole_every, borrowed(out)
    )


@kernel
def hand_out(rows, samples, shafts):
    """Split the integrator's rows into samples and what the shafts do besides."""
    for i in range(rows.shape[0]):
        for j in range(GEAR_SPEED):
            samples[i, j] = rows[i, j]
        shafts[i, 0], shafts[i, 1] = rows[i, GEAR_SPEED], rows[i, DRIVE_TORQUE]


def reach_sample(records, zones, ports, jumps):
    """Step up to the instant of the next sample; return a status."""
    return fill(records, zones, ports, jumps, 1, _NO_ROWS)[1]


@kernel
def interrupt(records):
    """End the present step at the instant of the next sample."""
    stepper.interrupt(records[0])


def checked_count(n: Any) -> int:
    """Return what must be a number of samples.

    Raises
    ------
    ParameterError
        If it is no whole number, or negative.
    """
    try:
        count = operator.index(n)
    except TypeError:
        count = -1
    if count < 0:
        raise ParameterError(f'n is {n!r}: it must be a whole number of samples, 0 or more')
    return count
