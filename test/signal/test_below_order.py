"""Orders above the band in which resampling is accurate are taken out of an average."""

import numpy as np

from gear_dynamics.signal.synchronous import below_order


def test_orders_above_the_highest_go_and_those_below_stay():
    angle = 2 * np.pi * np.arange(256) / 256
    kept, gone = np.cos(40 * angle + 0.3), np.sin(41 * angle)
    average = np.stack([kept + gone, 2 + kept], axis=1)
    found = below_order(average, 40.7)
    np.testing.assert_allclose(found, np.stack([kept, 2 + kept], axis=1), atol=1e-13)
