import numpy as np
import pytest

from gear_dynamics.signal.tacho import repair_pulses, rising_edges

RATE = 10000.0


def turning(duration=4.0, speed=17.0, drift=0.02):
    """Return time, and the revolutions of a shaft whose speed drifts sinusoidally."""
    t = np.arange(int(duration * RATE)) / RATE
    swing = drift / 2 * duration / (2 * np.pi)
    return t, speed * (t + swing * (1 - np.cos(2 * np.pi * t / duration)))


def test_edges_of_a_sine_lie_between_samples():
    # sin(2 pi 50 t) rises through 0 at whole periods: every 200 samples, offset by 0.3.
    t = (np.arange(2000) - 0.3) / RATE
    edges = rising_edges(np.sin(2 * np.pi * 50 * t), 0.0, 0.5)
    # The first sample is too near to the level to say that the signal comes from below.
    np.testing.assert_allclose(edges, 0.3 + 200 * np.arange(1, 10), atol=1e-3)


def test_noise_at_the_level_makes_no_second_edge():
    t, revolutions = turning()
    pulse = (np.mod(revolutions, 1) < 0.3) * 5 + np.random.default_rng(1).normal(0, 0.3, len(t))
    assert len(rising_edges(pulse, 2.5, 1.0)) == int(revolutions[-1])


def test_missing_and_spurious_pulses_are_counted_and_numbered_over():
    t, revolutions = turning()
    true = np.interp(np.arange(68), revolutions, t)
    damaged = np.delete(true, [10, 11, 30])
    damaged = np.sort(np.append(damaged, [true[20] + 0.02, true[50] - 0.025]))
    pulses = repair_pulses(damaged)
    assert (pulses.missing, pulses.spurious) == (3, 2)
    assert pulses.numbers[-1] == 67
    np.testing.assert_allclose(pulses.instants, true[pulses.numbers], atol=1e-12)


@pytest.mark.parametrize('count', [0, 1, 2])
def test_few_pulses(count):
    pulses = repair_pulses(np.arange(float(count)))
    assert len(pulses.instants) == len(pulses.numbers) == count
