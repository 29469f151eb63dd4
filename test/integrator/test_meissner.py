"""The rectangular mesh stiffness on stiff supports is the Meissner equation (1918), whose monodromy
matrix is the product of two damped oscillators' transition matrices.

me delta'' + n c delta' + n k delta = const, with n = 2 pairs for eps - 1 and one pair for 2 - eps
of the mesh cycle.
"""

import math

import numpy as np
import pytest
from states import start_from, state_of_sample

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

STIFFNESS = 1e5
PER_CYCLE = 4
ACCURACY = 1e-8
"""Of the matrix; supports of 1e15 N/m yield 1e-10 of what the teeth do."""


def gear_pair(damping):
    return GearPair(
        tooth_pair_stiffness=STIFFNESS,
        mesh_damping_ratio=damping,
        friction_coefficient=0.0,
        transmission_error_amplitude=0.0,
        pinion_mass=1e5,
        gear_mass=1e5,
        pinion_inertia=6.3276e-4,
        gear_inertia=5.7e-3,
        pinion_support_stiffness=1e15,
        gear_support_stiffness=1e15,
        support_damping_ratio=0.5,
    )


def transition(w, zeta, t):
    """Return the transition matrix of x'' + 2 zeta w x' + w^2 x = 0 over t (zeta < 1)."""
    wd, decay = w * math.sqrt(1 - zeta**2), math.exp(-zeta * w * t)
    sine, cosine = math.sin(wd * t), math.cos(wd * t)
    return decay * np.array(
        [
            [cosine + zeta * w / wd * sine, sine / wd],
            [-(w**2) / wd * sine, cosine - zeta * w / wd * sine],
        ]
    )


def monodromy(pair, mesh_frequency):
    """Return the closed form over one cycle, beginning with two pairs in contact."""
    w, zeta = pair.derived.wn, pair.mesh_damping_ratio
    two = (pair.derived.contact_ratio - 1) / mesh_frequency
    # Twice the stiffness and twice the damping: sqrt(2) times the frequency and damping ratio.
    first = transition(math.sqrt(2) * w, math.sqrt(2) * zeta, two)
    return transition(w, zeta, 1 / mesh_frequency - two) @ first


def deltas_after_a_cycle(pair, mesh_frequency, delta, delta_dot):
    """Return delta and delta' one cycle after the static deflection is disturbed by these."""
    simulator = Simulator(
        pair,
        sample_rate=PER_CYCLE * mesh_frequency,
        speed=2 * math.pi * mesh_frequency / pair.pinion_teeth,
        load_torque=150.0,
        anti_alias=False,
        rtol=1e-12,
        atol=1e-15,
    )
    start = Simulator(pair, load_torque=150.0, anti_alias=False)
    start.advance(1)
    y, d = state_of_sample(start), pair.derived
    # psi = rb1 th1 - rb2 th2 without rigid rotation.
    gear = -d.pinion_inertia * d.gear_base_radius / (d.gear_inertia * d.pinion_base_radius)
    pinion = 1 / (d.pinion_base_radius - gear * d.gear_base_radius)
    y[4], y[5] = y[4] + delta * pinion, y[5] + delta * pinion * gear
    y[10], y[11] = delta_dot * pinion, delta_dot * pinion * gear
    start_from(simulator, y)
    samples = simulator.advance(PER_CYCLE + 1)
    assert simulator.counters['contact_losses'] == 0
    return np.array([samples['delta'][-1], samples['delta_dot'][-1]])


def measured_monodromy(pair, mesh_frequency):
    size = 1e-3  # the deflection is 14 mm, so contact holds and the motion is exactly linear
    base = deltas_after_a_cycle(pair, mesh_frequency, 0.0, 0.0)
    rate = size * pair.derived.wn
    columns = [
        (deltas_after_a_cycle(pair, mesh_frequency, size, 0.0) - base) / size,
        (deltas_after_a_cycle(pair, mesh_frequency, 0.0, rate) - base) / rate,
    ]
    return np.stack(columns, axis=1)


@pytest.mark.parametrize('zeta', [0.0, 0.02, 0.3])
@pytest.mark.parametrize('ratio', [0.55, 1.2, 1.9, 2.35, 2.6, 3.1])
def test_floquet_multipliers_are_those_of_the_meissner_equation(zeta, ratio):
    pair = gear_pair(zeta)
    mesh_frequency = ratio * pair.derived.wn / (2 * math.pi)
    expected, got = monodromy(pair, mesh_frequency), measured_monodromy(pair, mesh_frequency)
    scale = np.array([[1, 1 / pair.derived.wn], [pair.derived.wn, 1]])
    np.testing.assert_allclose(got / scale, expected / scale, rtol=0, atol=ACCURACY)
    # Liouville: the determinant is exp(-integral of the damping).
    two = pair.derived.contact_ratio - 1
    rate = 2 * zeta * pair.derived.wn / mesh_frequency
    assert np.linalg.det(got) == pytest.approx(math.exp(-rate * (1 + two)), abs=10 * ACCURACY)
    known = np.sort_complex(np.linalg.eigvals(expected))
    # Where two multipliers nearly meet, a matrix error moves them by its square root.
    gap = max(abs(known[1] - known[0]), 1e-3)
    multipliers = np.sort_complex(np.linalg.eigvals(got))
    np.testing.assert_allclose(multipliers, known, rtol=0, atol=10 * ACCURACY / gap)


def test_undamped_pair_is_parametrically_unstable_near_twice_its_frequency():
    pair = gear_pair(0.0)
    growing = [
        ratio
        for ratio in np.arange(2.0, 3.2, 0.05)
        if abs(np.trace(monodromy(pair, ratio * pair.derived.wn / (2 * math.pi)))) > 2
    ]
    # Principal resonance: w_mesh = 2 sqrt(mean stiffness) = 2 sqrt(eps) = 2.63.
    assert growing[0] < 2 * math.sqrt(pair.derived.contact_ratio) < growing[-1]
    for ratio in growing:
        got = measured_monodromy(pair, ratio * pair.derived.wn / (2 * math.pi))
        assert np.max(np.abs(np.linalg.eigvals(got))) > 1
