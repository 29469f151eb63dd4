"""Envelope spectra in orders, and the lines of defects, on signals with known answers."""

import numpy as np
import pytest

from gear_dynamics.signal.bearing import envelope_orders, find_defect

RATE, SPEED = 12800.0, 25.0


def modulated(order, duration=4.0, depth=0.5, drift=0.02):
    """Return a 3 kHz carrier modulated at an order of a shaft whose speed drifts, and its angle."""
    t = np.arange(int(duration * RATE)) / RATE
    swing = SPEED * drift / 2 * duration / (2 * np.pi)
    angle = SPEED * t + swing * (1 - np.cos(2 * np.pi * t / duration))
    x = (1 + depth * np.cos(2 * np.pi * order * angle)) * np.cos(2 * np.pi * 3000 * t)
    return x, angle


def test_a_modulation_has_its_line_at_its_order_while_the_speed_drifts():
    x, angle = modulated(4.3)
    spectrum = envelope_orders(x, RATE, angle, 2000, 4000, 15)
    line = np.argmax(spectrum.amplitude)
    assert spectrum.order[line] == pytest.approx(4.3, abs=0.01)
    # (1 + m cos)^2 = 1 + m^2 / 2 + 2 m cos + m^2 / 2 cos 2: the line has 2 m, its double m^2 / 2.
    assert spectrum.amplitude[line] == pytest.approx(1.0, rel=0.01)
    double = np.abs(spectrum.order - 8.6) < 0.05
    assert spectrum.amplitude[double].max() == pytest.approx(0.125, rel=0.02)


def impacts(order, seed=1, duration=2.0):
    random = np.random.default_rng(seed)
    x = random.normal(size=int(duration * RATE))
    ring = np.exp(-np.arange(80) / 10) * np.sin(np.arange(80) * 1.6)
    for number in range(1, int(duration * SPEED * order) - 1):
        first = int((number + 0.01 * random.normal()) / (SPEED * order) * RATE)
        x[first : first + 80] += 6 * ring
    return x, np.arange(len(x)) / RATE * SPEED


def test_impacts_are_found_within_the_tolerance_and_elsewhere_nothing():
    x, angle = impacts(5.35)
    spectrum = envelope_orders(x, RATE, angle, 0, RATE / 2, 18)
    found = find_defect(spectrum, 5.415, 0.02)
    assert found.order == pytest.approx(5.35, abs=0.02)
    assert found.level > 15
    assert find_defect(spectrum, 3.585, 0.02).level < 10
    assert find_defect(spectrum, 4.714, 0.02).level < 10


def test_orders_that_are_explained_are_left_out():
    x, angle = impacts(5.0)
    spectrum = envelope_orders(x, RATE, angle, 0, RATE / 2, 18)
    assert find_defect(spectrum, 5.05, 0.02).level > 15
    assert find_defect(spectrum, 5.05, 0.02, np.arange(1, 19)).level < 10
    everything = np.arange(1, 18, 0.01)
    assert np.isnan(find_defect(spectrum, 5.05, 0.02, everything).level)
