import numpy as np
import pytest
from dynamics.flows import BacklashOscillator, ImpactOscillator, lorenz_growth
from dynamics.test_cycles import one_degree_of_freedom, speed_at
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.dynamics.exponents import (
    WIDTHS,
    halves_agree,
    lyapunov_spectrum,
    standard_error,
    sum_error,
    transient,
)
from gear_dynamics.dynamics.tangent import first_tangent_vectors
from gear_dynamics.integrator.variation import VARIED
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import OperatingPoint, friction_chaos


def test_lorenz():
    """Sprott 2003, Chaos and Time-Series Analysis: 0.9056, 0, -14.5723."""
    found = lyapunov_spectrum(lorenz_growth(), cycle=0.5)
    assert found.settled.all()
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
    found = lyapunov_spectrum(growth, cycle=2 * np.pi / 2.2)
    expected = np.log(0.8) / (2 * np.pi / 2.2)
    # The variations turn: over 400 periods the mean misses at most ln of an axis ratio / 400.
    assert found.values == pytest.approx([expected] * 2, abs=2e-3)


def test_impact_oscillator_in_chaos():
    """Sum of the exponents = 2 ln r times the impacts per time, whatever the motion."""
    oscillator = ImpactOscillator(w=2.8, r=0.8)
    growth, impacts = oscillator.growth(1500, skip=100)
    found = lyapunov_spectrum(growth, cycle=1.0)
    kept = impacts[found.discarded :]
    assert found.values[0] > 10 * found.standard_errors[0]
    assert found.values.sum() == pytest.approx(2 * np.log(0.8) * kept.mean(), rel=1e-9)


def test_backlash_oscillator_in_chaos():
    """The largest exponent, by variations with jumps at the contacts, is that by which two nearby
    motions part whose paths are in closed form between the edges of the gap. No value for this
    oscillator is known to be published with its error."""
    zeta, fm, fa, w = 0.05, 0.1, 0.2, 1.2
    exact = BacklashOscillator(zeta, fm, fa, w).nearby_growth(4000, skip=200) / (2 * np.pi / w)
    pair = one_degree_of_freedom(
        mesh_damping_ratio=zeta,
        half_backlash=10e-6,
        transmission_error_amplitude=fa * 10e-6,
        transmission_error_phase=np.pi / 2,
    )
    torque = fm * 10e-6 * pair.tooth_pair_stiffness * pair.derived.gear_base_radius
    operation = OperatingPoint(pair, speed_at(pair, w), torque)
    run = run_cycles(
        [pair] * 8,
        operation.speed,
        torque,
        2200,
        states=scattered_states(operation, 8),
        vectors=first_tangent_vectors(8, k=1),
    )
    found = [lyapunov_spectrum(growth[200:], operation.cycle) for growth in run.growth]
    value = np.mean([each.values[0] for each in found])
    error = np.linalg.norm([each.standard_errors[0] for each in found]) / 8
    exact_error = standard_error(exact)
    # Both know their value to a few parts in a hundred, or the comparison would say nothing.
    assert max(error, exact_error) < 0.03 * value
    assert value == pytest.approx(exact.mean(), abs=4 * np.hypot(error, exact_error))


def test_closed_form_of_the_backlash_oscillator_obeys_its_equation():
    """Against SciPy over three periods with both flanks hit."""
    zeta, fm, fa, w = 0.05, 0.1, 0.2, 1.2

    def rates(t, s):
        x, v = s
        spring = 2 * zeta * v + x - np.sign(x) if abs(x) > 1 else 0.0
        return [v, fm + fa * w**2 * np.cos(w * t) - spring]

    oscillator, (x, v) = BacklashOscillator(zeta, fm, fa, w), (-1.3, 0.2)
    for i in range(3):
        x, v = oscillator.over_period(i, x, v)
    span = (0, 6 * np.pi / w)
    # The right side is not smooth: small steps across the edges, error of the step's square.
    path = solve_ivp(rates, span, [-1.3, 0.2], 'DOP853', rtol=1e-10, atol=1e-12, max_step=0.005)
    assert path.y[0].min() < -1
    assert path.y[0].max() > 1
    assert [x, v] == pytest.approx(path.y[:, -1], abs=1e-5)


def test_exponents_are_the_logarithms_of_the_floquet_multipliers():
    """Of a period-4 orbit with impacts and friction: the eigenvalues of its monodromy matrix."""
    operation = friction_chaos().with_value('friction_coefficient', 0.05)
    run = ([operation.pair], operation.speed, operation.load_torque)
    begin = run_cycles(*run, 3000, vectors=first_tangent_vectors(1))
    unit = np.eye(VARIED)[np.newaxis]
    orbit = run_cycles(*run, 4, states=begin.states, vectors=unit, orthogonal=False)
    assert orbit.states == pytest.approx(begin.states, rel=1e-6, abs=1e-12)
    multipliers = np.linalg.eigvals(orbit.vectors[0].T)
    expected = np.sort(np.log(np.abs(multipliers)))[::-1] / (4 * operation.cycle)
    long = run_cycles(*run, 4000, states=begin.states, vectors=begin.vectors)
    found = lyapunov_spectrum(long.growth[0], operation.cycle)
    # Pairs of complex multipliers turn: the mean over 20 000 tau misses at most 2 / 20 000.
    assert found.values == pytest.approx(expected, abs=1e-4)


def autoregressive(generator, n):
    """AR(1) with coefficient 0.9 and unit noise: the mean of n values has error 10 / sqrt(n)."""
    return lfilter([1], [1, -0.9], generator.normal(size=n + 200))[200:]


def stays(generator, n, steps=20):
    """Two values, 1 and -1, kept for so many steps in the mean: rho = 1 - 2 / steps, 0.9 with 20,
    and an error of sqrt(19 / n)."""
    return generator.choice([-1, 1]) * np.cumprod(1 - 2 * (generator.random(n) < 1 / steps))


@pytest.mark.parametrize(
    ('process', 'expected'),
    [(lambda generator, n: generator.normal(size=n), 1.0), (autoregressive, 10.0),
     (stays, np.sqrt(19))],
)  # fmt: skip
def test_standard_error_of_processes_with_a_known_one(process, expected):
    """sigma / sqrt(n) sqrt((1 + rho) / (1 - rho)), but for the largest of three estimates: low in
    frequency the periodogram of noise is exponential, so that its means are known too."""
    generator = np.random.default_rng(0)
    n, count = 20000, 500
    errors = np.array([standard_error(process(generator, n)) for _ in range(count)])
    ordinates = generator.exponential(size=(100_000, max(WIDTHS)))
    square = np.max([ordinates[:, :width].mean(axis=1) for width in WIDTHS], axis=0)
    # The mean square of 500 is known to 3 %.
    found = np.mean(errors**2) * n / expected**2
    assert found == pytest.approx(square.mean(), abs=4 * square.std() / np.sqrt(count))


def test_standard_error_is_known_though_stays_are_a_twentieth_of_the_record():
    """n = 1000, rho = 0.96: sigma^2 (1 + rho) / (1 - rho) / n, and its term in 1 / n^2."""
    generator, n, rho = np.random.default_rng(7), 1000, 0.96
    square = (1 + rho) / (1 - rho) / n - 2 * rho * (1 - rho**n) / (n * (1 - rho)) ** 2
    errors = np.array([standard_error(stays(generator, n, 50)) for _ in range(1000)])
    assert 0.95 < np.sqrt(np.mean(errors**2) / square) < 1.15


def test_standard_error_of_periodic_rates_is_that_of_the_period_that_is_not_whole():
    period = np.array([0.3, -0.1, 0.2, -0.4])
    assert standard_error(np.full(150, -0.3)) < 1e-16
    assert standard_error(np.tile(period, 38) - 0.3) < 1e-16
    # Two more values than whole periods: 0.2 over 150. The frequencies are not quite zero.
    rates = np.tile(period, 38)[:150]
    assert rates.mean() == pytest.approx(0.2 / 150)
    assert standard_error(rates) == pytest.approx(0.2 / 150, rel=0.5)


def test_standard_errors_are_in_the_order_of_their_exponents():
    rates = np.random.default_rng(4).normal([-1.0, 1.0], [0.01, 1.0], (400, 2))
    found = lyapunov_spectrum(rates, 1.0)
    assert found.values == pytest.approx([1.0, -1.0], abs=0.2)
    # 1 and 0.01 over sqrt(400), each known to a factor of two.
    assert 0.025 < found.standard_errors[0] < 0.1
    assert 0.00025 < found.standard_errors[1] < 0.001


def test_transient_is_found():
    generator = np.random.default_rng(1)
    steady = generator.normal(size=(4000, 2))
    assert halves_agree(steady).all()
    begun = steady.copy()
    begun[:400] += 20
    cut = transient(begun)
    assert cut >= 400
    assert halves_agree(begun[cut:]).all()


def test_what_no_transient_begins_is_kept():
    """A cut where the record looks best would state errors too small."""
    generator = np.random.default_rng(5)
    for _ in range(50):
        assert transient(autoregressive(generator, 1000)[:, np.newaxis]) == 0


def test_transient_of_another_exponent_than_the_largest_is_found():
    """The halves of the whole differ in it, though the largest is known best from the whole."""
    rates = np.random.default_rng(6).normal(size=(4000, 2))
    rates[:900, 1] += 5
    rates[900:1800, 1] += 2
    errors = [standard_error(rates[begin:, 0]) for begin in (250, 500, 1000, 2000)]
    assert standard_error(rates[:, 0]) < min(errors)
    assert list(halves_agree(rates)) == [True, False]
    assert halves_agree(rates[transient(rates) :]).all()


def test_chaos_that_dies_within_the_record_is_dropped_as_a_transient():
    """The exponent is that of the motion it ends in, not a mean over both."""
    rates = np.random.default_rng(3).normal(0.05, 0.1, (400, 1))
    rates[180:] = -0.015
    found = lyapunov_spectrum(rates, 1.0)
    assert found.discarded == 200
    assert found.settled.all()
    assert found.values == pytest.approx([-0.015])


def test_exponent_that_drifts_is_not_settled_and_the_others_are():
    rates = np.random.default_rng(2).normal(size=(4000, 3))
    rates[:, 1] += np.linspace(0, 10, 4000) - 20
    found = lyapunov_spectrum(rates, 1.0)
    # In descending order the drifting one is the last.
    assert list(found.settled) == [True, True, False]


def test_convergence_record_ends_at_the_exponents():
    """The running mean of a known series: that of 1, 2, 3 ... n is (n + 1) / 2."""
    rows = np.arange(1.0, 201.0)[:, np.newaxis]
    found = lyapunov_spectrum(rows, 1.0)
    first = found.discarded + 1
    expected = first + (found.convergence_cycles - 1) / 2
    assert found.convergence[:, 0] == pytest.approx(expected)
    assert found.convergence[-1] == pytest.approx(found.values)
    assert found.convergence_cycles[-1] == 200 - found.discarded


def test_sum_error_is_relative_unless_nothing_diverges():
    errors = sum_error(np.array([-1.1, 0.25]), np.array([-1.0, 0.0]))
    assert errors == pytest.approx([-0.1, 0.25])


def test_too_short_a_record_is_refused():
    with pytest.raises(ValueError, match='30 cycles are too few: give 40 or more'):
        lyapunov_spectrum(np.zeros((30, 2)), 1.0)
