import numpy as np
import pytest

from gear_dynamics.signal.teeth import tooth_energy

TEETH, POINTS = 34, 64


def test_energy_is_the_mean_square_of_each_tooth():
    x = np.random.default_rng(0).normal(size=(TEETH * POINTS, 2))
    expected = (x.reshape(TEETH, POINTS, 2) ** 2).mean(axis=1)
    np.testing.assert_allclose(tooth_energy(x, TEETH).energy, expected, rtol=1e-12)


def test_a_tooth_that_stands_out_is_named():
    x = np.random.default_rng(1).normal(size=TEETH * POINTS)
    x[17 * POINTS : 18 * POINTS] *= 6
    found = tooth_energy(x, TEETH)
    assert found.tooth == 17
    assert found.chance < 1e-6


def test_the_chance_holds_for_healthy_noise():
    # Of 2000 healthy wheels 1 % must be near 20; the median absolute deviation of 34 teeth is
    # itself uncertain and the energies are not quite log-normal: up to three times as many pass.
    rng = np.random.default_rng(2)
    found = tooth_energy(rng.normal(size=(TEETH * POINTS, 2000)), TEETH)
    assert np.count_nonzero(found.chance < 0.01) < 60
    assert np.count_nonzero(found.chance < 1e-6) == 0


def test_teeth_alike_to_rounding_do_not_stand_out():
    x = np.tile(np.sin(np.arange(POINTS)), TEETH) * (1 + 1e-9 * np.arange(TEETH * POINTS))
    assert tooth_energy(x, TEETH).chance == 1


def test_few_teeth_are_refused():
    with pytest.raises(ValueError, match='teeth is 3'):
        tooth_energy(np.zeros(100), 3)


def test_the_fault_begins_at_the_first_tooth_that_stands_out():
    # Near a resonance the vibration is greatest one or two mesh cycles after the fault.
    x = np.random.default_rng(3).normal(size=TEETH * POINTS)
    for tooth, gain in ((0, 20.0), (1, 30.0), (33, 8.0)):
        x[tooth * POINTS : (tooth + 1) * POINTS] *= gain
    assert tooth_energy(x, TEETH).tooth == 33
