import numpy as np
import pytest

from gear_dynamics.signal.shaft_phase import (
    phase_from_angle,
    phase_from_constant,
    phase_from_pulses,
    phase_from_speed,
)
from gear_dynamics.signal.tacho import repair_pulses, rising_edges

RATE = 51200.0


def turning(duration=2.0):
    """Return time and revolutions: 17 revolutions/s, swinging by 1 % twice a second."""
    t = np.arange(int(duration * RATE)) / RATE
    return t, 17 * t + 0.17 / (4 * np.pi) * (1 - np.cos(4 * np.pi * t))


def error_of(phase):
    """Return the RMS error in revolutions, about its mean, where the phase is known."""
    t, true = turning()
    known = (t >= phase.start) & (t <= phase.end)
    assert np.mean(known) > 0.9
    return np.std(phase.at(t[known]) - true[known])


def test_from_pulses_within_5e_4_revolutions():
    _, revolutions = turning()
    # A pulse of 3 % of a revolution with edges of 0.2 ms.
    pulse = np.convolve(np.mod(revolutions, 1) < 0.03, np.ones(10) / 10)[: len(revolutions)]
    pulses = repair_pulses(rising_edges(pulse, 0.5, 0.2) / RATE)
    assert error_of(phase_from_pulses(pulses.instants, pulses.numbers, 1)) < 5e-4


@pytest.mark.parametrize('sign', [1, -1])
def test_from_an_encoder(sign):
    _, revolutions = turning()
    counts = np.mod(np.floor(sign * revolutions * 4096), 4096)
    assert error_of(phase_from_angle(counts, RATE, 4096)) < 2e-4


def test_from_the_speed():
    t, _ = turning()
    speed = 17 + 0.17 * np.sin(4 * np.pi * t)
    assert error_of(phase_from_speed(speed[::64], RATE / 64)) < 1e-5


def test_from_a_constant():
    phase = phase_from_constant(10.0, 1.0, 3.0)
    assert (phase.turned, phase.speed, phase.variation) == (20.0, 10.0, 0.0)
    np.testing.assert_allclose(phase.at(np.array([1.0, 1.25])), [0, 2.5])


def test_variation_is_the_range_of_the_speed():
    t, revolutions = turning(0.5)  # one period: the speed swings by 2 % peak to peak
    phase = phase_from_angle(revolutions, RATE, 1.0)
    assert phase.variation == pytest.approx(0.019, abs=0.001)
    assert phase.speed == pytest.approx(17, rel=1e-3)
    assert len(t) > len(phase.time)


@pytest.mark.parametrize('angle', [np.zeros(9000), np.sin(np.arange(9000) / 900)])
def test_a_shaft_that_stands_or_turns_back_is_refused(angle):
    with pytest.raises(ValueError, match=r'stands still|turns back'):
        phase_from_angle(angle, RATE, 1.0)
    with pytest.raises(ValueError, match='stops or turns back'):
        phase_from_speed(angle, RATE)


def test_marks_that_are_not_even_are_calibrated_out():
    t, revolutions = turning()
    places = np.array([0.0, 0.18, 0.33, 0.52, 0.7, 0.83])  # instead of sixths
    marks = (np.arange(33)[:, np.newaxis] + places).ravel()
    instants = np.interp(marks, revolutions, t)
    assert error_of(phase_from_pulses(instants, np.arange(len(marks)), 6)) < 5e-4
