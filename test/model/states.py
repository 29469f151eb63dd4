"""States of a simulator in the coordinates x1, y1, x2, y2, th1, th2 of the equations.

A state is (13,): six positions, six velocities, integral of q.
"""

import numpy as np

from gear_dynamics.integrator.contact import contact_state
from gear_dynamics.simulation.simulator import Simulator


def _angles(p, psi, q):
    """Return th1, th2 of psi = rb1 th1 - rb2 th2 and q = (I1 th1 + (rb1/rb2) I2 th2) / It."""
    matrix = [
        [p['rb1'], -p['rb2']],
        [p['inertia1'] / p['inertia_t'], p['ratio'] * p['inertia2'] / p['inertia_t']],
    ]
    return np.linalg.solve(matrix, [psi, q])


def state_of_sample(simulator):
    """Return the state at the instant of the simulator's most recent sample."""
    motion = simulator._motion.records[0]
    clock, p = motion['clock'], motion['constants']
    tau = (clock['sample'] - 1 - clock['origin']) / clock['sample_rate'] - clock['begin']
    y = np.zeros(13)
    for j in range(6):
        series = np.polynomial.Polynomial(motion['series'][:, j])
        y[j], y[6 + j] = series(tau), series.deriv()(tau)
    y[12] = motion['state'][12] + series.integ()(tau)
    y[4:6] = _angles(p, *y[4:6])
    y[10:12] = _angles(p, *y[10:12])
    return y


def start_from(simulator, y):
    """Let a simulator that has not run yet start from a state instead of the static one."""
    motion = simulator._motion.records[0]
    p, state, clock = motion['constants'], motion['state'], motion['clock']
    state[:] = y
    for j in (4, 10):
        state[j] = p['rb1'] * y[j] - p['rb2'] * y[j + 1]
        state[j + 1] = (p['inertia1'] * y[j] + p['ratio'] * p['inertia2'] * y[j + 1]) / p[
            'inertia_t'
        ]
    error = p['e_a'] * np.sin(p['phi0'])
    error_dot = p['e_a'] * np.cos(p['phi0']) * p['z1'] * clock['speed']
    contact = contact_state(
        state[3] - state[1] + state[4] - error, state[9] - state[7] + state[10] - error_dot, p['b']
    )
    clock['contact_a'] = clock['contact_b'] = contact


def settled_state(pair, speed, load_torque, cycles):
    """Return the state after whole mesh cycles from the static deflection."""
    mesh_frequency = speed * pair.pinion_teeth / (2 * np.pi)
    simulator = Simulator(
        pair,
        sample_rate=max(mesh_frequency, 100.0),
        speed=speed,
        load_torque=load_torque,
        anti_alias=False,
        rtol=1e-10,
        atol=1e-13,
    )
    simulator.advance(cycles + 1)
    return state_of_sample(simulator)
