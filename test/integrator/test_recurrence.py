"""The recurrence of the Taylor series against the matrices of model.system, order by order."""

import numpy as np
import pytest

import gear_dynamics as gd
from gear_dynamics.integrator.constants import pack
from gear_dynamics.integrator.layout import (
    COORDINATES,
    DELTA,
    ROWS,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    STATES,
    SUPPORT_C,
    SUPPORT_K,
    SUPPORTS_CHANGE,
    Q,
)
from gear_dynamics.integrator.records import empty_records
from gear_dynamics.integrator.recurrence import Loads, fill_orders
from gear_dynamics.integrator.series import expand
from gear_dynamics.model.system import system

PAIR = gd.GearPair()
REACH = 1e-5
"""A step [s]: order k of a series is compared times the k-th power of it."""
LOADS = Loads(travel=2.0, travel_rate=300.0, torque=150.0, torque_rate=-4e3)


@pytest.fixture
def rng():
    return np.random.default_rng(5)


def falling(rng, rows, degree, size):
    """Return coefficients, in columns 0 to `degree`, of polynomials of a size within REACH."""
    out = np.zeros((rows, ROWS))
    orders = np.arange(degree + 1)
    out[:, : degree + 1] = size * rng.standard_normal((rows, degree + 1)) * (0.5 / REACH) ** orders
    return out


def motion(rng, degree=0, varying=0, pushed=False, supports=0):
    """Return a record with a random state, mesh, push and changes of the supports."""
    record = empty_records(1)[0]
    record['constants'] = pack(PAIR, 1e-8, 1e-8)[0]
    scale = np.array([1e-6] * 4 + [1e-5, 1e-4])
    rate = scale * PAIR.derived.wn
    record['state'][:STATES] = rng.standard_normal(STATES) * [*scale, *rate, 1e-6]
    record['error'][0] = falling(rng, 1, ROWS - 1, 1e-6)
    segment = record['segment']
    width = segment.shape[1]
    for row, arm in ((SEG_FORCE, 1.0), (SEG_FRICTION, 0.05), (SEG_MOMENT, 1e-3)):
        sizes = (4e8 * arm, 2e3 * arm)
        for j, size in enumerate(sizes):
            segment[row + j] = falling(rng, 1, varying, size)[0, :width]
        segment[row + 2] = falling(rng, 1, degree, 1e3 * arm)[0, :width]
    record['step']['degree'], record['step']['stiffness_degree'] = degree, varying
    if pushed or supports:
        record['step']['pushed'], record['step']['push_degree'] = 1, ROWS - 1
        record['push'][:, :COORDINATES] = falling(rng, COORDINATES, ROWS - 1, 100.0).T
    if supports:
        record['step']['pushed'] = SUPPORTS_CHANGE
        record['supports'][:2] = falling(rng, 2, supports - 1, 1e8)
        record['supports'][2:] = falling(rng, 2, supports - 1, 300.0)
        record['degrees'][SUPPORT_K : SUPPORT_C + 2] = supports - 1
        # What another step left there, beyond the degree, does not count.
        record['degrees'][SUPPORT_C] = -1
    return record


def by_matrices(record, loads):
    """Return the series of the coordinates, and delta's, by the matrices of the equations."""
    machine, d = system(PAIR), PAIR.derived
    masses = np.repeat([d.pinion_mass, d.gear_mass], 2)
    z, delta = np.zeros((ROWS, COORDINATES)), np.zeros(ROWS)
    z[0], z[1] = record['state'][:6], record['state'][6:12]
    q_sum = np.zeros(ROWS)
    q_sum[0], q_sum[1] = record['state'][12], z[0, Q]
    delta[:2] = z[:2] @ machine.apart - record['error'][0, :2]
    segment, friction = record['segment'], np.zeros(ROWS)
    powers, supports = np.arange(1, ROWS + 1), record['supports']
    torque = np.zeros(ROWS)
    torque[:2] = loads.torque, loads.torque_rate
    for k in range(ROWS - 2):
        rates = powers[: k + 1] * delta[1 : k + 2]

        def force(row, k=k, rates=rates):
            stiffness, damping = segment[row, : k + 1], segment[row + 1, : k + 1]
            return stiffness @ delta[k::-1] + damping @ rates[::-1] + segment[row + 2, k]

        friction[k] = force(SEG_FRICTION)
        grown = 0.0
        for growth, back in ((loads.travel, 1), (loads.travel_rate, 2)):
            grown += growth * friction[k - back] if k >= back else 0.0
        given = [force(SEG_FORCE), friction[k], force(SEG_MOMENT) + grown, torque[k]]
        second = machine.loads @ given - machine.stiffness @ z[k]
        second -= machine.damping @ ((k + 1) * z[k + 1]) + machine.integral * q_sum[k]
        second += record['push'][k, :COORDINATES]
        slopes = powers[: k + 1, np.newaxis] * z[1 : k + 2, :4]
        changes = np.where(
            record['degrees'][SUPPORT_K : SUPPORT_C + 2, np.newaxis] >= 0, supports, 0
        )
        softer, less_damped = (np.repeat(changes[i : i + 2], 2, 0) for i in (0, 2))
        softened = (softer[:, : k + 1] * z[k::-1, :4].T).sum(1)
        softened += (less_damped[:, : k + 1] * slopes[::-1].T).sum(1)
        second[:4] -= softened / masses
        z[k + 2] = second / ((k + 1) * (k + 2))
        q_sum[k + 2] = z[k + 1, Q] / (k + 2)
        delta[k + 2] = z[k + 2] @ machine.apart - record['error'][0, k + 2]
    return z, delta


def assert_alike(series, z, delta):
    powers = REACH ** np.arange(ROWS)[:, np.newaxis]
    scale = np.abs(z * powers).max(axis=0)
    np.testing.assert_allclose(
        series[:, :COORDINATES] * powers / scale, z * powers / scale, rtol=0, atol=1e-13
    )
    powers = powers[:, 0] / np.abs(delta).max()
    np.testing.assert_allclose(series[:, DELTA] * powers, delta * powers, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    'given',
    [
        {},
        {'pushed': True},
        {'degree': 9},
        {'degree': 9, 'pushed': True},
        {'degree': 12, 'varying': 1},
        {'degree': 26, 'varying': 26, 'pushed': True},
        {'supports': 1},
        {'degree': 3, 'varying': 3, 'supports': 6},
    ],
    ids=str,
)
def test_series_is_that_of_the_equations(given, rng):
    record = motion(rng, **given)
    record['commands']['torque_rate'] = LOADS.torque_rate
    record['commands']['torque'] = LOADS.torque
    turn = record['constants']['pitch'] * record['constants']['z1'] / (2 * np.pi)
    record['commands']['speed'] = LOADS.travel / turn
    record['commands']['accel'] = 2 * LOADS.travel_rate / turn
    ramp = record['constants']['ratio'] * record['constants']['inertia2']
    record['commands']['torque'] -= ramp * record['commands']['accel']

    expand(record)

    z, delta = by_matrices(record, LOADS)
    assert_alike(record['series'], z, delta)
    assert np.abs(z * REACH ** np.arange(ROWS)[:, np.newaxis])[ROWS // 2].max() > 0


def test_tangent_vector_has_the_mesh_but_no_loads(rng):
    record = motion(rng, degree=5, varying=5, pushed=True)
    tangent, loads = record['tangent'], Loads(LOADS.travel, LOADS.travel_rate, 0.0, 0.0)
    tangent['segment'] = record['segment']
    tangent['segment'][2::3] = 0.0
    tangent['state'][:STATES] = record['state']

    fill_orders(record, tangent, loads, False)

    alone = motion(rng, degree=5, varying=5)
    alone['segment'], alone['state'] = tangent['segment'], record['state']
    alone['error'][:] = 0.0
    assert_alike(tangent['series'], *by_matrices(alone, loads))
