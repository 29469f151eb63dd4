"""Without loss of contact, friction and change of stiffness the model is linear: its steady state
against the frequency response of the 6 x 6 matrices, in closed form.
"""

import math

import numpy as np
import pytest
import scipy.linalg
from states import state_of_sample

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

# Well damped, so that transients are below 1e-9 of the response after 20 ms.
PAIR = GearPair(
    mesh_stiffness='constant',
    friction_coefficient=0.0,
    mesh_damping_ratio=0.3,
    support_damping_ratio=0.3,
    transmission_error_amplitude=5e-6,
    transmission_error_phase=0.4,
    gear_support_stiffness=3e8,
)
LOAD = 1000.0
PER_CYCLE = 8
SETTLE = 0.02
ACCURACY = 1e-6
"""Relative, of complex amplitudes."""


def frequency_response(frequency):
    """Return the static deflection and the complex amplitudes of x1, y1, x2, y2, th1, th2.

    delta = h . u - e presses with F = k (delta - b) + c delta' and acts with -h F, so that
    (-w^2 M + i w (C + c h h') + K + k h h') U = h (k + i w c) e_a exp(i phi0) [amplitude of exp(i w
    t) whose imaginary part is the motion].
    """
    d = PAIR.derived
    w = 2 * math.pi * frequency
    mass = np.diag([d.pinion_mass] * 2 + [d.gear_mass] * 2 + [d.pinion_inertia, d.gear_inertia])
    c1, c2 = d.pinion_support_damping, d.gear_support_damping
    damping = np.diag([c1, c1, c2, c2, 0, 0])
    stiffness = np.diag([5e8, 5e8, 3e8, 3e8, 0, 0])
    h = np.array([0, -1, 0, 1, d.pinion_base_radius, -d.gear_base_radius])
    mesh = PAIR.tooth_pair_stiffness + 1j * w * d.tooth_pair_damping
    dynamic = -(w**2) * mass + 1j * w * damping + stiffness + mesh * np.outer(h, h)
    error = 5e-6 * np.exp(0.4j)
    amplitude = np.linalg.solve(dynamic, h * mesh * error)
    force = LOAD / d.gear_base_radius
    static = np.array([0, force / 5e8, 0, -force / 3e8])
    return static, amplitude


def measured(frequency):
    """Return mean and complex amplitude of the six coordinates over one mesh cycle."""
    speed = 2 * math.pi * frequency / PAIR.pinion_teeth
    simulator = Simulator(
        PAIR, sample_rate=PER_CYCLE * frequency, speed=speed, load_torque=LOAD,
        anti_alias=False, rtol=1e-10, atol=1e-13,
    )  # fmt: skip
    cycles = math.ceil(SETTLE * frequency)
    simulator.advance(cycles * PER_CYCLE)
    states = []
    for _ in range(PER_CYCLE):
        simulator.advance(1)
        states.append(state_of_sample(simulator)[:6])
    assert simulator.counters['contact_losses'] == 0
    states = np.array(states)
    turn = np.exp(-2j * np.pi * np.arange(PER_CYCLE) / PER_CYCLE)
    # u = Im(U exp(i w t)) has the first coefficient U / (2i).
    return states.mean(axis=0), 2j * (turn @ states) / PER_CYCLE, states


@pytest.mark.parametrize(
    'frequency', [300.0, 800.0, 1500.0, 1793.0, 2300.0, 2845.0, 4000.0, 7039.0, 9000.0, 14000.0]
)
def test_steady_state_is_the_frequency_response(frequency):
    static, amplitude = frequency_response(frequency)
    mean, got, states = measured(frequency)
    for j in (1, 3, 4, 5):
        assert abs(got[j] - amplitude[j]) < ACCURACY * abs(amplitude[j])
    # Without friction nothing moves across the line of action.
    assert np.all(states[:, [0, 2]] == 0)
    assert abs(amplitude[0]) == abs(amplitude[2]) == 0
    np.testing.assert_allclose(mean[[1, 3]], static[[1, 3]], rtol=ACCURACY)


@pytest.mark.parametrize(
    ('pairs', 'known'), [(1, ['1793', '2845', '7039']), (2, ['1803', '2895', '9730'])]
)
def test_modes_on_the_line_of_action_are_the_known_ones(pairs, known):
    # Generalised eigenvalues of the default pair's mass and stiffness, without rigid rotation.
    d = GearPair().derived
    mass = np.diag([d.pinion_mass, d.gear_mass, d.pinion_inertia, d.gear_inertia])
    h = np.array([-1, 1, d.pinion_base_radius, -d.gear_base_radius])
    stiffness = np.diag([5e8, 5e8, 0, 0]) + pairs * 5.33e8 * np.outer(h, h)
    squares = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)
    assert squares[0] == pytest.approx(0, abs=1)
    assert [f'{math.sqrt(w2) / (2 * math.pi):.0f}' for w2 in squares[1:]] == known
