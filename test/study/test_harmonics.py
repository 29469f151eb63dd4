import numpy as np
import pytest

from gear_dynamics.study.harmonics import row_of, row_of_slope


def test_row_of_a_known_signal():
    """Amplitude 3 in the second mesh harmonic and 4 between the first two, on a mean of 5."""
    cycles = 30
    turn = 2 * np.pi * np.arange(64 * cycles) / 64
    row = row_of(5 + 3 * np.sin(2 * turn) + 4 * np.sin(1.5 * turn), cycles)
    assert row == pytest.approx([5 / np.sqrt(2), 0, 3, 0, 0, 0], abs=1e-12)


def test_row_of_the_slope_of_a_known_signal():
    """Of a record that does not close: a drift of 7 has no whole harmonics, and jumps of a square
    wave of amplitude 2 leave 8 / (pi k) in the odd ones."""
    cycles, count, duration = 4, 4 * 4096, 0.1
    turn = 2 * np.pi * np.arange(count + 1) / 4096
    omega = 2 * np.pi * cycles / duration
    triangle = np.pi / 2 - np.abs((turn % (2 * np.pi)) - np.pi)
    rate = 7 * turn / omega - 3 / (2 * omega) * np.cos(2 * turn) + 2 / omega * triangle
    slope = 7 + 3 * np.sin(2 * turn) + 2 * np.where(turn % (2 * np.pi) < np.pi, 1, -1)
    row = row_of_slope(slope[:-1], rate, cycles, duration)
    odd = 8 / np.pi / np.array([1, 3, 5])
    expected = [np.sqrt(4.5 + 4), odd[0], 3, odd[1], 0, odd[2]]
    # The trapezoidal rule is off by 14 (pi k / 4096)^2 / 3 of the drift in harmonic k.
    assert row == pytest.approx(expected, abs=1e-4)
