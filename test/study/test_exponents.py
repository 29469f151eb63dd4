import numpy as np
import pytest
from study.flows import ImpactOscillator, lorenz_growth

from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.model.variation import VARIED
from gear_dynamics.study.exponents import exponents, standard_error, transient
from gear_dynamics.study.initial import first_variations
from gear_dynamics.study.operation import friction_chaos


def test_lorenz():
    """Sprott 2003, Chaos and Time-Series Analysis: 0.9056, 0, -14.5723."""
    found = exponents(lorenz_growth(), cycle=0.5)
    assert found.settled
    # Four standard errors of 1e4 time units, 0.003 each.
    assert found.values == pytest.approx([0.9056, 0.0, -14.5723], abs=0.012)
    # The trace is -(sigma + 1 + beta) everywhere; Runge-Kutta at 0.01 holds it to 1e-5.
    assert found.values.sum() == pytest.approx(-(10 + 1 + 8 / 3), rel=1e-5)


def test_impact_oscillator_with_complex_multipliers():
    """One impact a period, det = r^2: both exponents are ln r over the period (Shaw and Holmes
    1983, equation for the stability of single-impact orbits)."""
    oscillator = ImpactOscillator(w=2.2, r=0.8)
    growth, impacts = oscillator.growth(400, skip=400)
    assert set(impacts) == {1}
    found = exponents(growth, cycle=2 * np.pi / 2.2)
    expected = np.log(0.8) / (2 * np.pi / 2.2)
    # The variations turn: over 400 periods the mean misses at most ln of an axis ratio / 400.
    assert found.values == pytest.approx([expected] * 2, abs=2e-3)


def test_impact_oscillator_in_chaos():
    """Sum of the exponents = 2 ln r times the impacts per time, whatever the motion."""
    oscillator = ImpactOscillator(w=2.8, r=0.8)
    growth, impacts = oscillator.growth(1500, skip=100)
    found = exponents(growth, cycle=1.0)
    kept = impacts[found.discarded :]
    assert found.values[0] > 10 * found.standard_errors[0]
    assert found.values.sum() == pytest.approx(2 * np.log(0.8) * kept.mean(), rel=1e-9)


def test_exponents_are_the_logarithms_of_the_floquet_multipliers():
    """Of a period-4 orbit with impacts and friction: the eigenvalues of its monodromy matrix."""
    operation = friction_chaos().with_value('friction_coefficient', 0.05)
    run = ([operation.pair], operation.speed, operation.load_torque)
    begin = run_cycles(*run, 3000, vectors=first_variations(1))
    unit = np.eye(VARIED)[np.newaxis]
    orbit = run_cycles(*run, 4, states=begin.states, vectors=unit, orthogonal=False)
    assert orbit.states == pytest.approx(begin.states, rel=1e-6, abs=1e-12)
    multipliers = np.linalg.eigvals(orbit.vectors[0].T)
    expected = np.sort(np.log(np.abs(multipliers)))[::-1] / (4 * operation.cycle)
    long = run_cycles(*run, 4000, states=begin.states, vectors=begin.vectors)
    found = exponents(long.growth[0], operation.cycle)
    # Pairs of complex multipliers turn: the mean over 20 000 tau misses at most 2 / 20 000.
    assert found.values == pytest.approx(expected, abs=1e-4)


def test_standard_error_of_correlated_values():
    """AR(1) with coefficient 0.9 and unit noise: the mean of n values has error 10 / sqrt(n)."""
    generator = np.random.default_rng(0)
    errors = []
    for _ in range(40):
        noise, x, series = generator.normal(size=20000), 0.0, []
        for each in noise:
            x = 0.9 * x + each
            series.append(x)
        errors.append(standard_error(np.array(series)))
    # The mean of 40 estimates from 20 parts each has a relative error of 0.03.
    assert np.mean(errors) == pytest.approx(10 / np.sqrt(20000), rel=0.1)


def test_transient_is_found():
    generator = np.random.default_rng(1)
    steady = generator.normal(size=4000)
    assert transient(steady)[1]
    begun = steady.copy()
    begun[:400] += 20
    cut, settled = transient(begun)
    assert cut >= 400
    assert settled


def test_record_that_drifts_is_not_settled():
    drifts = np.linspace(0, 10, 4000) + np.random.default_rng(2).normal(size=4000)
    assert not transient(drifts)[1]


def test_too_short_a_record_is_refused():
    with pytest.raises(ValueError, match='30 cycles are too few: give 40 or more'):
        exponents(np.zeros((30, 2)), 1.0)
