import math

import numpy as np
import pytest

from gear_dynamics.signal.order_tracking import (
    mesh_phase,
    order_spectrum,
    pinion_inertia_share,
    resample_by_phase,
)
from gear_dynamics.signal.synchronous import (
    hunting_revolutions,
    other_wheel_leakage,
    separate,
    synchronous_average,
)

RATE = 51200.0


def ramp(duration, start, end, teeth=34):
    """Mesh phase [cycles] while the pinion goes from `start` to `end` rad/s."""
    t = np.arange(int(duration * RATE)) / RATE
    return (start * t + (end - start) / duration * t**2 / 2) * teeth / (2 * math.pi)


def test_order_lines_stay_put_while_the_speed_doubles():
    phase = ramp(2.0, 104.72, 209.44)
    x = 3 * np.sin(2 * np.pi * phase) + 0.5 * np.cos(2 * np.pi * 2.5 * phase / 34)
    x += 0.7 * np.sin(2 * np.pi * 3 * phase)
    order, amplitude = order_spectrum(x, phase, 34, points=128, revolutions=8)
    for line, expected in ((34, 3.0), (102, 0.7), (2.5, 0.5)):
        at = np.flatnonzero(order == line)[0]
        assert amplitude[at] == pytest.approx(expected, rel=2e-3)
    lines = amplitude > 0.05 * amplitude.max()
    assert np.all(np.min(np.abs(order[lines, np.newaxis] - [34, 102, 2.5]), axis=1) <= 1 / 8)


@pytest.mark.parametrize('frequency', [0.1, 0.3, 0.4])
def test_resampling_meets_its_stated_accuracy(frequency):
    phase = np.arange(5000) / 93.7
    first, values = resample_by_phase(np.sin(2 * np.pi * frequency * np.arange(5000)), phase, 128)
    instants = 93.7 * (first + np.arange(len(values))) / 128
    assert len(values) > 0.99 * 5000 / 93.7 * 128
    np.testing.assert_allclose(values, np.sin(2 * np.pi * frequency * instants), atol=3e-5)


def test_mesh_phase_cancels_the_torsional_vibration():
    t = np.arange(20000) / RATE
    rigid = 104.72 * t
    share = pinion_inertia_share(1.0, 3.0, 34, 59)
    # Twist with (I1 th1 + I2 (z1 / z2) th2) = 0, the torsional mode.
    twist = 1e-3 * np.sin(2 * np.pi * 1800 * t)
    pinion = np.mod(rigid + twist, 2 * np.pi)
    gear = np.mod(rigid * 34 / 59 - twist * 1.0 / (3.0 * 34 / 59), 2 * np.pi)
    phase = mesh_phase(pinion, gear, 34, 59, share)
    np.testing.assert_allclose(phase, 34 * rigid / (2 * np.pi), atol=1e-9)


def test_a_shaft_that_turns_back_is_refused():
    with pytest.raises(ValueError, match='must turn forward'):
        resample_by_phase(np.zeros(10), -np.arange(10.0), 8)


def test_synchronous_average_gains_the_square_root_of_the_count():
    rng = np.random.default_rng(0)
    points, revolutions = 1024, 64
    signal = np.sin(2 * np.pi * 34 * np.arange(points) / points)
    values = np.tile(signal, revolutions) + rng.normal(size=points * revolutions)
    left = synchronous_average(values, points) - signal
    # The standard error of a standard deviation of 1024 values is 2.2 %.
    assert np.std(left) == pytest.approx(1 / math.sqrt(revolutions), rel=0.07)


def test_hunting_tooth_period():
    assert hunting_revolutions(34, 59) == 59
    assert hunting_revolutions(59, 34) == 34
    assert hunting_revolutions(20, 30) == 3


@pytest.mark.parametrize(('revolutions', 'decibel'), [(64, -22), (32, -5)])
def test_leakage_of_the_other_wheel(revolutions, decibel):
    # 34/59: the figures that go with this pair, in whole decibels
    assert round(20 * math.log10(other_wheel_leakage(revolutions, 34, 59))) == decibel


@pytest.mark.parametrize('revolutions', [32, 59, 64, 118])
def test_leakage_is_what_an_average_leaves(revolutions):
    points = 64 * 34
    turn = np.arange(points * revolutions) / points
    left = []
    for k in range(1, 59):
        order = 2 * np.pi * k * turn * 34 / 59
        both = synchronous_average(np.stack([np.cos(order), np.sin(order)], axis=1), points)
        left.append(np.max(np.hypot(*both.T)))
    assert max(left) == pytest.approx(other_wheel_leakage(revolutions, 34, 59), abs=1e-9)


def test_parts_of_an_average():
    turn = 2 * np.pi * np.arange(34 * 64) / (34 * 64)
    shaft = 0.3 + 0.2 * np.cos(turn) + 0.1 * np.cos(2 * turn)
    mesh = np.cos(34 * turn) + 0.5 * np.cos(68 * turn + 1)
    sidebands = 0.2 * np.cos(33 * turn) + 0.1 * np.cos(35 * turn) + 0.05 * np.cos(69 * turn)
    fault = 0.02 * np.cos(10 * turn) + 0.01 * np.cos(36 * turn)
    parts = separate(shaft + mesh + sidebands + fault, 34)
    np.testing.assert_allclose(parts.difference, fault, atol=1e-12)
    np.testing.assert_allclose(parts.residual, fault + sidebands, atol=1e-12)
    np.testing.assert_allclose(parts.regular, shaft - 0.3 + mesh + sidebands, atol=1e-12)
