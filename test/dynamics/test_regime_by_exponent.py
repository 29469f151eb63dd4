import numpy as np
import pytest
from dynamics.systems import logistic

from gear_dynamics.dynamics.regimes import regime


def pairs(series):
    return np.stack([series[:-1], series[1:]], axis=1)


@pytest.mark.parametrize(
    ('r', 'period'),
    # Windows of the logistic map: the period-doubling cascade (Strogatz, section 10.2: 2 from 3,
    # 4 from 3.449, 8 from 3.54409, 16 from 3.5644, 32 from 3.568759) and the period-3 window.
    [(2.8, 1), (3.2, 2), (3.5, 4), (3.55, 8), (3.566, 16), (3.5695, 32), (3.83, 3)],
)
def test_periods_of_the_logistic_map(r, period):
    # The section's scale: distances in the cascade shrink to 0.002, near the tolerance.
    states = 10 * pairs(logistic(20200, r)[20000:])
    kind = regime(states, exponent=-0.01, standard_error=1e-4)
    assert kind.words == f'period-{period}'


def test_chaos_of_the_logistic_map():
    kind = regime(pairs(logistic(2000, 4.0)), exponent=np.log(2), standard_error=0.01)
    assert kind.words == 'chaotic'
    assert kind.zero_one > 0.9


def test_quasi_periodic_motion():
    angle = 2 * np.pi * (np.sqrt(5) - 1) / 2 * np.arange(2000)
    states = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert regime(states, exponent=0.0, standard_error=1e-4).words == 'quasi-periodic'


def test_short_record_without_period_is_undecided_unless_it_grows():
    states = pairs(logistic(200, 4.0))
    assert regime(states, exponent=0.0005, standard_error=0.001).words == 'undecided'
    assert regime(states, exponent=0.6, standard_error=0.05).words == 'chaotic'


def test_growth_within_its_error_is_no_chaos_whatever_the_zero_one_test_says():
    kind = regime(pairs(logistic(2000, 4.0)), exponent=0.01, standard_error=0.01)
    assert kind.zero_one > 0.9
    assert kind.words == 'undecided'


def test_states_that_recur_are_no_period_where_nearby_motions_part():
    """Chaos that stays near an unstable orbit; with 1000 points the 0-1 test contradicts it."""
    orbit = pairs(logistic(21200, 3.5)[20000:])
    assert regime(orbit[:200], exponent=0.05, standard_error=0.001).words == 'chaotic'
    assert regime(orbit, exponent=0.05, standard_error=0.001).words == 'undecided'
