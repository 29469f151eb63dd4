import numpy as np
import pytest

from gear_dynamics.web.samples import SampleRing


def block(first, n):
    rows = np.zeros(n, [('a', float), ('b', float)])
    rows['a'] = np.arange(first, first + n)
    rows['b'] = -rows['a']
    return rows


@pytest.mark.parametrize('sizes', [[3, 4, 5], [10], [7, 7, 7], [25, 1], [1] * 23])
def test_the_last_samples_are_those_that_were_added(sizes):
    ring = SampleRing(('a', 'b'), 10)
    total = 0
    for size in sizes:
        ring.add(block(total, size))
        total += size
        held = min(total, 10)
        np.testing.assert_array_equal(ring.last('a', 99), np.arange(total - held, total))
        np.testing.assert_array_equal(ring.last('b', 3), -np.arange(max(total - 3, 0), total))


def test_samples_before_the_end():
    ring = SampleRing(('a',), 10)
    ring.add(block(0, 25))
    np.testing.assert_array_equal(ring.last('a', 4, before=3), [18, 19, 20, 21])
    assert len(ring.last('a', 4, before=10)) == 0
    assert len(ring.last('other', 4)) == 0
