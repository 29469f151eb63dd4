import numpy as np
import pytest

from gear_dynamics.web.decimation import extremes


@pytest.mark.parametrize('n', [2001, 51200, 204_799])
def test_a_peak_of_one_sample_stays_visible_wherever_it_is(n):
    generator = np.random.default_rng(3)
    values = generator.normal(size=n).astype(np.float32)
    for place in generator.integers(n, size=50):
        for peak in (100.0, -100.0):
            spoiled = values.copy()
            spoiled[place] = peak
            at, drawn = extremes(spoiled, 1000)
            assert peak in drawn
            assert abs(at[np.flatnonzero(drawn == peak)[0]] - place) <= n / 1000


def test_few_samples_are_drawn_as_they_are():
    values = np.arange(10.0)
    at, drawn = extremes(values, 5)
    np.testing.assert_array_equal(at, values)
    np.testing.assert_array_equal(drawn, values)


def test_each_pixel_has_its_least_and_greatest_value():
    values = np.arange(12.0)
    _, drawn = extremes(values, 3)
    np.testing.assert_array_equal(drawn, [0, 3, 4, 7, 8, 11])
