"""Initial states and variations of studies; drawn from fixed seeds, so that a study repeats."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.dynamics.cycles import settings
from gear_dynamics.integrator.variation import VARIED
from gear_dynamics.simulation.batch import gather
from gear_dynamics.study.operation import Operation

REACH = (1.5, 0.5)
"""Greatest delta / b and delta_dot / (b wn) of scattered states."""


def static_state(operation: Operation) -> np.ndarray:
    """Return the state of static deflection at mesh phase 0, one of model.layout.STATES."""
    run = settings(operation.speed, operation.load_torque, 0.5, 1e-9, 1e-12)
    return gather([operation.pair], [run], drive=False).motion.records['state'][0]


def states_at(operation: Operation, delta: np.ndarray, delta_dot: np.ndarray) -> np.ndarray:
    """Return states with given delta / b and delta_dot / (b wn) at mesh phase 0.

    The bodies are where the static load puts them and at rest; the rotation alone differs.

    Returns
    -------
    (n, STATES) array
    """
    pair = operation.pair
    b, wn = pair.half_backlash, pair.derived.wn
    phase = pair.transmission_error_phase
    rate = pair.pinion_teeth * operation.speed
    error = pair.transmission_error_amplitude * math.sin(phase)
    error_rate = pair.transmission_error_amplitude * math.cos(phase) * rate
    states = np.repeat(static_state(operation)[np.newaxis], len(delta), axis=0)
    states[:, 4] = b * np.asarray(delta) + error + states[:, 1] - states[:, 3]
    states[:, 10] = b * wn * np.asarray(delta_dot) + error_rate
    return states


def scattered_states(operation: Operation, count: int, seed: int = 0) -> np.ndarray:
    """Return the static state and count - 1 others, evenly drawn within REACH."""
    draw = np.random.default_rng(seed).uniform(-1, 1, (count, 2)) * REACH
    states = states_at(operation, draw[:, 0], draw[:, 1])
    states[0] = static_state(operation)
    return states


def first_variations(count: int, k: int = VARIED, seed: int = 0) -> np.ndarray:
    """Return k orthonormal variations, (count, k, VARIED), in no special direction.

    The unit vectors would not do: those of x1 and x2 never leave that plane.
    """
    square = np.random.default_rng(seed).normal(size=(VARIED, VARIED))
    return np.repeat(np.linalg.qr(square)[0][np.newaxis, :k], count, axis=0)
