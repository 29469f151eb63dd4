"""Initial states of studies, drawn from fixed seeds, so that a study repeats."""

from __future__ import annotations

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.study.operating_point import OperatingPoint

REACH = (1.5, 0.5)
"""Greatest delta / b and delta_dot / (b wn) of scattered states."""


def states_at(point: OperatingPoint, delta: np.ndarray, delta_dot: np.ndarray) -> np.ndarray:
    """Return states with given delta / b and delta_dot / (b wn), as `dynamics.states_at`."""
    return dynamics.states_at(point.pair, point.speed, point.load_torque, delta, delta_dot)


def scattered_states(point: OperatingPoint, count: int, seed: int = 0) -> np.ndarray:
    """Return the static state and count - 1 others, evenly drawn within REACH."""
    draw = np.random.default_rng(seed).uniform(-1, 1, (count, 2)) * REACH
    states = states_at(point, draw[:, 0], draw[:, 1])
    states[0] = dynamics.static_state(point.pair, point.speed, point.load_torque)
    return states
