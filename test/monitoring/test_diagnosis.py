import numpy as np
import pytest

from gear_dynamics.monitoring.diagnosis import local_fault, once_per_revolution
from gear_dynamics.signal.indicators import has_difference
from gear_dynamics.signal.synchronous import separate

TEETH, POINTS = 34, 64
TURN = 2 * np.pi * np.arange(TEETH * POINTS) / (TEETH * POINTS)
CHANNELS = 4


def diagnosed(noise, *faulty, gain=0.3, extra=0.0):
    """The diagnosis of a mesh in noise, with ringing from the given tooth on in each channel."""
    rng = np.random.default_rng(0)
    average = np.tile((np.cos(TEETH * TURN) + extra)[:, np.newaxis], (1, CHANNELS))
    average += noise * rng.normal(size=average.shape)
    for channel, tooth in enumerate(faulty):
        after = np.mod(TURN * TEETH / (2 * np.pi) - tooth, TEETH)
        average[:, channel] += gain * np.exp(-after / 1.5) * np.sin(2 * np.pi * 7 * after)
    parts = separate(average, TEETH)
    return local_fault(parts, TEETH, has_difference(parts))


@pytest.mark.parametrize('noise', [0.0, 1e-4, 1e-2, 0.1])
def test_a_healthy_wheel_has_no_local_fault(noise):
    assert diagnosed(noise).sure == 0


@pytest.mark.parametrize('tooth', [0, 17, 33])
@pytest.mark.parametrize('noise', [0.0, 1e-2])
def test_a_tooth_that_rings_in_all_channels_is_named(tooth, noise):
    assert diagnosed(noise, *[tooth] * CHANNELS) == (1.0, tooth)


def test_channels_that_disagree_are_less_sure():
    assert diagnosed(0.01, 5, 5, 5, 20) == (0.75, 5)
    assert diagnosed(0.01, 5, 12, 20, 28).sure == 0.25


def test_motion_of_twice_the_period_is_no_fault():
    assert diagnosed(0.01, extra=0.5 * np.cos(TEETH / 2 * TURN)).sure == 0


def test_a_modulation_once_a_revolution_is_no_local_fault():
    assert diagnosed(0.01, extra=0.3 * np.cos(TURN) * np.cos(TEETH * TURN)).sure == 0


def test_the_remainder_of_a_slow_change_is_too_small():
    # A linear growth over the record leaves a saw tooth of 1e-3 in the average.
    growth = 1e-3 * (TURN / (2 * np.pi) - 0.5) * np.cos(TEETH * TURN)
    assert diagnosed(0.0, extra=growth).sure == 0


def stands_above(order_1, noise=0.01, seed=1):
    rng = np.random.default_rng(seed)
    average = (
        np.cos(TEETH * TURN) + order_1 * np.cos(TURN + 0.3) + noise * rng.normal(size=len(TURN))
    )
    return once_per_revolution(separate(average[:, np.newaxis], TEETH), TEETH)


def test_order_1_is_compared_with_its_surroundings():
    # White noise of standard deviation s has lines of median s sqrt(4 ln 2 / n).
    around = 0.01 * np.sqrt(4 * np.log(2) / len(TURN))
    assert stands_above(0.2) == pytest.approx(0.2 / around, rel=0.3)
    assert stands_above(0.001) == 0  # less than 2 % of the standard deviation
    assert stands_above(0.2, noise=0.0) == 1000
    assert stands_above(0.0, noise=0.0) == 0


def test_noise_alone_does_not_stand_out():
    assert max(stands_above(0.0, noise=3.0, seed=seed) for seed in range(50)) < 10
