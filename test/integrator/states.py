"""States of a simulator in the coordinates x1, y1, x2, y2, th1, th2 of the equations.

A state is (13,): six positions, six velocities, integral of q.
"""

import numpy as np

from gear_dynamics.simulation.simulator import Simulator


def state_of_sample(simulator):
    """Return the state at the instant of the simulator's most recent sample."""
    return simulator.state().coordinates()


def start_from(simulator, y):
    """Let a simulator that has not run yet start from a state instead of the static one."""
    simulator.set_state(simulator.state().at(y))


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
