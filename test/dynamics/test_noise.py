"""Periods under noise, on sequences whose period is known."""

import numpy as np
import pytest

from gear_dynamics.dynamics.noise import noisy_period
from gear_dynamics.dynamics.regimes import regime

COUNT = 1024


def periodic(period, noise, seed=0):
    """States that repeat after `period`, of standard deviation 1, in noise; the second coordinate
    has twenty times as much."""
    rng = np.random.default_rng(seed)
    orbit = rng.normal(size=(period, 2)) if period > 1 else np.ones((1, 2))
    states = np.tile(orbit, (COUNT // period + 1, 1))[:COUNT]
    return states + rng.normal(size=states.shape) * [noise, 20 * noise]


def logistic(r, count=COUNT):
    """The logistic map after its transient, as delay coordinates."""
    x = [0.4]
    for _ in range(2000 + count):
        x.append(r * x[-1] * (1 - x[-1]))
    return np.column_stack([x[-count - 1 : -1], x[-count:]])


@pytest.mark.parametrize('noise', [0.0, 1e-3, 1e-2, 3e-2])
@pytest.mark.parametrize('period', [1, 2, 3, 4, 6, 16])
def test_a_period_is_found_in_noise(period, noise):
    found, scatter = noisy_period(periodic(period, noise), 64, 0.01)
    assert found == period
    # The mean of a class of COUNT / period states is itself noisy; 64 is the fewest.
    assert scatter == pytest.approx(noise, rel=0.2, abs=1e-12)


@pytest.mark.parametrize('period', [1, 2, 6])
def test_the_regime_is_periodic_in_noise(period):
    assert regime(periodic(period, 0.02), 1.0, 0.01).words == f'period-{period}'


def test_period_32_without_noise_is_told():
    # Between the doublings to 32, at r = 3.5687, and to 64, at 3.5697.
    assert regime(logistic(3.5691), 1.0, 1e-4).words == 'period-32'


@pytest.mark.parametrize('r', [3.58, 3.6, 3.8, 3.95])
def test_chaos_is_no_noise(r):
    # Lyapunov exponents of the logistic map here are 0.11, 0.18, 0.43, 0.58 a step.
    states = logistic(r) / logistic(r).std(axis=0)
    assert noisy_period(states, 64, 0.01)[0] == 0
    assert regime(states, 1.0, 0.01).words == 'chaotic'


def test_a_narrow_band_of_chaos_is_no_noise():
    # Two bands a standard deviation apart, each a chaotic map of 3 % width.
    chaos = logistic(3.9)
    states = np.where(np.arange(COUNT)[:, np.newaxis] % 2, 1.0, -1.0) + 0.1 * (
        np.repeat(chaos[: COUNT // 2], 2, axis=0) - 0.5
    )
    assert noisy_period(states, 64, 0.01)[0] == 0
