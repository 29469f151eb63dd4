"""Measures of basins on pictures whose answers are known in closed form."""

import numpy as np
import pytest

from gear_dynamics import dynamics


def test_wilson_interval_is_that_of_the_published_example():
    """Newcombe 1998, Statistics in Medicine 17, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29."""
    for count, total, expected in (
        (81, 263, (0.2553, 0.3662)),
        (15, 148, (0.0624, 0.1605)),
        (0, 20, (0.0, 0.1611)),
        (1, 29, (0.0061, 0.1718)),
    ):
        assert dynamics.wilson_interval(count, total) == pytest.approx(expected, abs=5e-5)
    assert dynamics.wilson_interval(20, 20)[1] == 1


def test_entropy_of_boxes_with_known_colours():
    """One colour: 0. Half and half: ln 2 each. Of four boxes of 4 x 4 one has four colours in
    equal parts, one two, and two have one: (ln 4 + ln 2) / 4."""
    assert dynamics.basin_entropy(np.zeros((20, 20), int)).entropy == 0
    stripes = np.indices((8, 8))[0] % 2
    found = dynamics.basin_entropy(stripes, 4)
    assert found.entropy == found.boundary_entropy == pytest.approx(np.log(2))
    picture = np.zeros((8, 8), int)
    picture[:4, :4] = np.arange(4)
    picture[4:, 4:] = stripes[:4, :4]
    found = dynamics.basin_entropy(picture, 4)
    assert found.entropy == pytest.approx((np.log(4) + np.log(2)) / 4)
    assert found.boundary_entropy == pytest.approx((np.log(4) + np.log(2)) / 2)
    assert (found.boundary_boxes, found.boxes) == (2, 4)


def test_random_colours_have_the_greatest_entropy_and_no_exponent():
    """n colours at random: entropy towards ln n, and the share of uncertain pairs is 1 - 1/n at
    any distance, so that the exponent is 0."""
    labels = np.random.default_rng(1).integers(0, 3, (300, 300))
    assert dynamics.basin_entropy(labels, 50).entropy == pytest.approx(np.log(3), abs=2e-3)
    found = dynamics.uncertainty_exponent(labels)
    assert found.shares == pytest.approx(2 / 3, abs=5e-3)
    assert found.exponent == pytest.approx(0, abs=5e-3)


def test_smooth_boundary_has_the_exponent_one():
    """A circle: the share of uncertain pairs is proportional to their distance; distances up to an
    eighth of the picture leave 0.03."""
    x, y = np.meshgrid(*[np.linspace(-1, 1, 400)] * 2)
    found = dynamics.uncertainty_exponent((x**2 + y**2 < 0.4).astype(int))
    assert found.exponent == pytest.approx(1, abs=0.04)
    assert dynamics.basin_entropy((x > 0.1 * y).astype(int)).boundary_entropy < np.log(2)


def test_cantor_boundary_has_the_exponent_of_its_dimension():
    """Stripes that change at the points of the middle-third Cantor set (dimension ln 2 / ln 3),
    along one axis: the exponent is 1 - ln 2 / ln 3 along it."""
    n = 3**7
    x = np.arange(n)
    level = np.zeros(n, int)
    for power in range(7):
        digit = x // 3**power % 3
        level[digit == 1] = power + 1
    labels = np.tile(level % 2, (n // 8, 1))
    # Along the stripes nothing differs, which halves all shares and leaves the slope.
    found = dynamics.uncertainty_exponent(labels)
    assert found.exponent == pytest.approx(1 - np.log(2) / np.log(3), abs=0.1)


def test_picture_of_one_basin_has_no_exponent():
    found = dynamics.uncertainty_exponent(np.zeros((40, 40), int))
    assert np.isnan(found.exponent)
    with pytest.raises(ValueError, match='fewer than a box of 5 x 5'):
        dynamics.basin_entropy(np.zeros((3, 3), int))
