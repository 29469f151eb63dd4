import math

import numpy as np
import pytest
from systems import duffing_exponent, duffing_section, henon, logistic, maxima, rossler

from gear_dynamics.dynamics.lyapunov import lyapunov_exponent
from gear_dynamics.dynamics.regimes import recurrence_period, regime
from gear_dynamics.dynamics.zero_one import zero_one_test

UEDA = {'damping': 0.05, 'drive': 7.5}  # Ueda 1979: the Japanese attractor


@pytest.mark.parametrize(
    ('series', 'expected'),
    [
        (logistic(1024), 1),
        (henon(1024), 1),
        (logistic(1024, r=3.55), 0),  # period 8
        (np.cos(2 * np.pi * (math.sqrt(5) - 1) / 2 * np.arange(1024)), 0),
        (duffing_section(1024, **UEDA), 1),
        (maxima(rossler(30000, 0.1)), 1),
    ],
    ids=['logistic', 'henon', 'periodic logistic', 'circle', 'duffing', 'rossler'],
)
def test_zero_one(series, expected):
    assert zero_one_test(series) == pytest.approx(expected, abs=0.05)


def test_zero_one_needs_a_series():
    with pytest.raises(ValueError, match='50 values are too few'):
        zero_one_test(np.zeros(50))


def agrees(found, expected, share):
    """Within two standard errors as stated, and the statement is not empty."""
    assert abs(found.exponent - expected) <= 2 * found.uncertainty + 0.01 * expected
    assert found.uncertainty <= share * expected


@pytest.mark.parametrize('count', [1024, 4096])
def test_lyapunov_of_the_logistic_map(count):
    agrees(lyapunov_exponent(logistic(count), lag=1), math.log(2), 0.1)


@pytest.mark.parametrize('count', [1024, 4096])
def test_lyapunov_of_the_henon_map(count):
    # 0.41922 at a = 1.4, b = 0.3 (Sprott 2003)
    agrees(lyapunov_exponent(henon(count), lag=1), 0.41922, 0.1)


def test_lyapunov_of_rossler():
    # 0.0714 at a = b = 0.2, c = 5.7 (Sprott 2003)
    agrees(lyapunov_exponent(rossler(16000, 0.2), 5.0), 0.0714, 0.2)


def test_lyapunov_of_duffing_against_its_variational_equation():
    expected = duffing_exponent(**UEDA)
    agrees(lyapunov_exponent(duffing_section(1500, **UEDA), lag=1), expected, 0.15)


def test_lyapunov_of_quasi_periodic_motion_is_zero():
    n = np.arange(2000)
    found = lyapunov_exponent(np.sin(2.4 * n) + 0.3 * np.sin(1.1 * n), lag=1)
    assert abs(found.exponent) <= 0.01
    assert found.uncertainty <= 0.01


@pytest.mark.parametrize(
    ('r', 'period'),
    [(2.9, 1), (3.2, 2), (3.5, 4), (3.55, 8), (3.566, 16), (3.8285, 3), (3.7, 0)],
)
def test_periods_of_the_logistic_map(r, period):
    # Known windows of the map (May 1976); 3.8285 lies in the period-3 window.
    series = logistic(6000, r=r)[-200:]
    found, distance = recurrence_period(series[:, np.newaxis], 1e-6)
    assert found == period
    assert math.isnan(distance) if period == 0 else distance <= 1e-6


def test_regimes_in_words():
    def words(series):
        return regime(np.stack([series, np.roll(series, 1)], 1)[1:], 500.0, 1e-3).words

    golden = 2 * np.pi * (math.sqrt(5) - 1) / 2
    assert words(logistic(4000, r=3.5)[-1024:]) == 'period-4'
    assert words(np.cos(golden * np.arange(1024))) == 'quasi-periodic'
    assert words(henon(1024)) == 'chaotic'
    assert words(henon(200)) == 'undecided'


def test_exponent_of_a_section_is_per_second():
    states = np.stack([henon(2001)[1:], henon(2001)[:-1]], axis=1)
    found = regime(states, 500.0, 1e-3).lyapunov
    agrees(found, 500 * 0.41922, 0.1)
