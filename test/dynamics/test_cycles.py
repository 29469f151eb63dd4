import dataclasses

import numpy as np
import pytest

import gear_dynamics as gd
from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.dynamics.nearby import nearby_growth
from gear_dynamics.integrator.variation import VARIED

FIVE = [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]
"""The reduced form's ten numbers among the integrator's states."""

PAIR = gd.GearPair(half_backlash=50e-6, friction_coefficient=0.08)
SPEED, TORQUE = 1100.0, 60.0
"""At this speed the default pair hits both flanks."""


def one_degree_of_freedom(**values):
    """A pair whose bodies are so heavy and so firmly held that only psi moves, to 5e-6."""
    held = dict.fromkeys(('pinion_support_stiffness', 'gear_support_stiffness'), 1e15)
    heavy = {'pinion_mass': 1e5, 'gear_mass': 1e5, 'pinion_inertia': 6e-4, 'gear_inertia': 6e-3}
    return gd.GearPair(mesh_stiffness='constant', friction_coefficient=0, **held, **heavy, **values)


def speed_at(pair, w):
    return w * pair.derived.wn / pair.pinion_teeth


@pytest.mark.parametrize('anti_alias', [False, True])
def test_batch_equals_single_runs_to_the_last_bit(anti_alias):
    pairs = [gd.GearPair(friction_coefficient=mu) for mu in (0.0, 0.03, 0.05)]
    speeds, torques = [104.72, 1200.0, 800.0], [150.0, 60.0, -40.0]
    batch = gd.simulate_batch(pairs, speeds, torques, duration=0.05, anti_alias=anti_alias)
    for row, pair, speed, torque in zip(batch, pairs, speeds, torques, strict=True):
        values = {'speed': speed, 'load_torque': torque, 'anti_alias': anti_alias}
        assert np.array_equal(row, gd.simulate(pair, 0.05, **values).samples)


def test_batch_refuses_wrong_number_of_speeds():
    with pytest.raises(gd.ParameterError, match='speeds has 3 values: give one, or 2'):
        gd.simulate_batch([gd.GearPair()] * 2, [1.0, 2.0, 3.0])


def test_sections_are_those_of_the_simulator():
    simulator = gd.Simulator(PAIR, drive=False, anti_alias=False, speed=SPEED, load_torque=TORQUE)
    simulator.advance(5000)
    events = simulator.take_events()
    sections = events[events['kind'] == gd.EventKind.SECTION]
    run = run_cycles([PAIR], SPEED, TORQUE, len(sections), rtol=1e-6, atol=1e-9)
    # The same steps, and two ways to sum a polynomial: rounding of 50 um and of its rate.
    assert np.allclose(run.sections[0, :, 0], sections['delta'], rtol=0, atol=1e-17)
    assert np.allclose(run.sections[0, :, 1], sections['delta_dot'], rtol=0, atol=1e-12)


def test_goes_on_from_its_own_states_in_a_periodic_motion():
    pair = gd.GearPair()
    whole = run_cycles([pair], 104.72, 150.0, 40)
    half = run_cycles([pair], 104.72, 150.0, 20)
    rest = run_cycles([pair], 104.72, 150.0, 20, states=half.states)
    # Ten thousand times the tolerance of a step: the phase is counted from another beginning.
    assert np.allclose(rest.sections, whole.sections[:, 20:], rtol=1e-5, atol=1e-14)


def test_samples_of_a_cycle_are_those_of_the_simulator():
    rate = 64 * PAIR.pinion_teeth * SPEED / (2 * np.pi)
    simulator = gd.Simulator(
        PAIR, drive=False, anti_alias=False, sample_rate=rate, speed=SPEED, load_torque=TORQUE
    )
    run = run_cycles([PAIR], SPEED, TORQUE, 10, samples_per_cycle=64, rtol=1e-6, atol=1e-9)
    expected = simulator.advance(640)
    for name in ('pinion_ax', 'mesh_force', 'delta', 'delta_dot'):
        assert np.allclose(run.samples[0][name], expected[name], rtol=1e-9, atol=1e-12), name


def test_bodies_are_those_of_the_samples():
    """psi by the angles, accelerations by the samples' own and by second differences."""
    run = run_cycles([PAIR], SPEED, TORQUE, 10, samples_per_cycle=4096, with_bodies=True)
    samples, bodies, step = run.samples[0], run.bodies[0], run.period[0] / 4096
    derived = PAIR.derived
    psi = derived.pinion_base_radius * np.unwrap(samples['pinion_angle'])
    psi -= derived.gear_base_radius * np.unwrap(samples['gear_angle'])
    # Angles begin anywhere in a turn; rounding of them.
    assert np.allclose(bodies['psi'] - bodies['psi'][0], psi - psi[0], rtol=0, atol=1e-15)
    for name in ('pinion_x', 'pinion_y', 'gear_x', 'gear_y'):
        differences = np.diff(bodies[name], 2) / step**2
        exact = samples[name.replace('_', '_a')][1:-1]
        # Beside a jump differences see half of it; few samples lie there.
        assert np.median(np.abs(differences - exact)) < 1e-4 * exact.std()
    for name, values in (('psi', bodies['psi']), ('delta', samples['delta'])):
        exact = bodies[f'{name}_acceleration'][1:-1]
        assert np.median(np.abs(np.diff(values, 2) / step**2 - exact)) < 1e-4 * exact.std()


@pytest.mark.parametrize('mu', [0.0, 0.08])
@pytest.mark.parametrize('in_gap', [False, True])
def test_variations_are_the_differences_of_nearby_motions(mu, in_gap):
    """Central differences over cycles with contact on both flanks, saltation on the way: the
    identity with damping in the gap and no friction, and with either another."""
    pair = dataclasses.replace(PAIR, friction_coefficient=mu, damping_in_gap=in_gap)
    tight = {'rtol': 1e-13, 'atol': 1e-15}
    begin = run_cycles([pair], SPEED, TORQUE, 32, **tight).states[0]
    cycles, step, wn = 4, 1e-11, pair.derived.wn
    scale = np.array([1.0] * 5 + [wn] * 5)
    states = np.repeat(begin[np.newaxis], 2 * VARIED, axis=0)
    for i, j in enumerate(FIVE):
        states[2 * i, j] += step * scale[i]
        states[2 * i + 1, j] -= step * scale[i]
    near = [pair] * 2 * VARIED
    ends = run_cycles(near, SPEED, TORQUE, cycles, states=states, samples_per_cycle=256, **tight)
    delta = ends.samples['delta'][0] / pair.half_backlash
    assert delta.min() < -1
    assert delta.max() > 1
    difference = (ends.states[::2] - ends.states[1::2])[:, FIVE] / (2 * step * scale)
    unit = np.eye(VARIED)[np.newaxis]
    varied = run_cycles(
        [pair], SPEED, TORQUE, cycles, states=begin[None], vectors=unit, orthogonal=False, **tight
    )
    # Each coordinate by itself, as x moves little. Differences carry an error of the state's
    # rounding over the step, 1e-4 / 1e-11 * 1e-16.
    apart = np.abs(varied.vectors[0] - difference).max(axis=0)
    assert np.all(apart <= 1e-7 * np.abs(difference).max(axis=0))


def test_divergence_is_that_of_the_closed_form_with_damping_in_the_gap_and_no_friction():
    """Whatever the contact does."""
    pair = dataclasses.replace(PAIR, damping_in_gap=True, friction_coefficient=0.0)
    d = pair.derived
    run = run_cycles([pair], SPEED, TORQUE, 50, vectors=np.eye(VARIED)[np.newaxis])
    supports = 2 * d.pinion_support_damping / d.pinion_mass
    supports += 2 * d.gear_support_damping / d.gear_mass
    inverse_masses = 1 / d.pinion_mass + 1 / d.gear_mass + 1 / d.equivalent_mass
    expected = -supports - d.tooth_pair_damping * d.contact_ratio * inverse_masses
    assert run.divergence[0].sum() == pytest.approx(expected * 50 * run.period[0], rel=1e-9)


@pytest.mark.parametrize('mu', [0.0, 0.08])
@pytest.mark.parametrize('in_gap', [False, True])
def test_exponents_sum_to_the_divergence(mu, in_gap):
    pair = dataclasses.replace(PAIR, friction_coefficient=mu, damping_in_gap=in_gap)
    run = run_cycles([pair], SPEED, TORQUE, 300, vectors=np.eye(VARIED)[np.newaxis])
    assert run.growth.sum() == pytest.approx(run.divergence.sum(), rel=1e-6)


def test_two_nearby_motions_part_as_the_variation_grows():
    """Over the same cycles of the same motion the two logarithms are the same number."""
    run = run_cycles([PAIR], SPEED, TORQUE, 60)
    first = np.array([1.0] * 5 + [0.0] * 5) / np.sqrt(5)
    tight = {'rtol': 1e-12, 'atol': 1e-15}
    unit = first[np.newaxis, np.newaxis]
    varied = run_cycles([PAIR], SPEED, TORQUE, 8, states=run.states, vectors=unit, **tight)
    growth = nearby_growth([PAIR], SPEED, TORQUE, 8, run.states)
    assert growth[0] == pytest.approx(varied.growth[0, :, 0], abs=1e-3)


def test_linear_oscillator_has_exponent_minus_zeta_twice():
    pair = one_degree_of_freedom(mesh_damping_ratio=0.05, transmission_error_amplitude=1e-6)
    begin = np.linalg.qr(np.random.default_rng(0).normal(size=(VARIED, VARIED)))[0]
    run = run_cycles([pair], speed_at(pair, 0.7), 150.0, 2000, vectors=begin[np.newaxis])
    per_tau = run.growth[0, 500:].mean(axis=0) / (pair.derived.wn * run.period[0])
    # Of the ten, the eight of the supports lie at -0.03 * 1e5 rad/s / wn.
    others = -0.03 * 1e5 / pair.derived.wn
    assert np.sort(np.abs(per_tau - others))[:8] == pytest.approx(0, abs=1e-4)
    farthest = per_tau[np.argsort(np.abs(per_tau - others))[8:]]
    assert farthest == pytest.approx(-0.05, abs=1e-4)


@pytest.mark.parametrize('w', [0.4, 0.7, 1.6])
def test_backlash_oscillator_without_loss_has_the_closed_form_amplitude(w):
    """x'' + 2 zeta x' + f(x) = Fm + Fa W^2 cos(W tau) swings about 1 + Fm with
    Fa W^2 / sqrt((1 - W^2)^2 + (2 zeta W)^2) while that is below Fm."""
    pair = one_degree_of_freedom(
        mesh_damping_ratio=0.05,
        transmission_error_amplitude=1e-6,
        transmission_error_phase=np.pi / 2,
    )
    run = run_cycles([pair], speed_at(pair, w), 500.0, 400, samples_per_cycle=64)
    x = run.samples[0]['delta'][-64:] / pair.half_backlash
    force = 1e-6 / pair.half_backlash * w**2
    amplitude = force / np.hypot(1 - w**2, 2 * 0.05 * w)
    mean = 500.0 / (pair.derived.gear_base_radius * 5.33e8 * pair.half_backlash)
    assert 2 * np.abs(np.fft.rfft(x)[1]) / 64 == pytest.approx(amplitude, rel=1e-4)
    assert x.mean() == pytest.approx(1 + mean, rel=1e-6)


def test_backlash_oscillator_first_loses_contact_where_the_closed_form_says():
    """Amplitude = Fm: Fa^2 W^4 = Fm^2 ((1 - W^2)^2 + 4 zeta^2 W^2), the lower root."""
    zeta, torque = 0.05, 100.0
    pair = one_degree_of_freedom(mesh_damping_ratio=zeta, transmission_error_amplitude=2e-6)
    b = pair.half_backlash
    fm, fa = torque / (pair.derived.gear_base_radius * 5.33e8 * b), 2e-6 / b
    square = np.roots([fm**2 - fa**2, fm**2 * (4 * zeta**2 - 2), fm**2])
    critical = np.sqrt(square[np.isreal(square) & (square > 0)].real.min())
    # Swept upwards: a motion with impacts exists beside the one without from lower down on.
    states, lowest = None, []
    for factor in [*np.linspace(0.5, 0.9995, 50), 1.0005]:
        speed = speed_at(pair, critical * factor)
        run = run_cycles([pair], speed, torque, 100, states=states, samples_per_cycle=256)
        states = run.states
        lowest.append(run.samples['delta'][0, -256:].min() / b)
    assert min(lowest[:-1]) > 1 > lowest[-1]
