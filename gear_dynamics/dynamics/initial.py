"""Initial states of the reduced form at mesh phase 0."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.dynamics.cycles import settings
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.number_lists import number_rows
from gear_dynamics.simulation.batch import gather


def static_state(pair: GearPair, speed: float, load_torque: float) -> np.ndarray:
    """Return the state of static deflection at mesh phase 0, as `run_cycles` takes it.

    Parameters
    ----------
    pair : GearPair
    speed : float
        Of the pinion [rad/s].
    load_torque : float
        On the gear [N m].

    Returns
    -------
    (STATES,) array
    """
    run = settings(speed, load_torque, 0.5, 1e-9, 1e-12)
    return gather([pair], [run], drive=False).records['state'][0]


def error_at_phase_0(pair: GearPair, speed: float) -> tuple[float, float]:
    """Return the transmission error [m] at mesh phase 0 and its rate [m/s], with all harmonics."""
    rate = pair.pinion_teeth * speed
    name = 'transmission_error_harmonics'
    rows = [
        (1.0, pair.transmission_error_amplitude, pair.transmission_error_phase),
        *number_rows(name, getattr(pair, name), 3),
    ]
    error = sum(amplitude * math.sin(phase) for _, amplitude, phase in rows)
    slope = sum(order * amplitude * math.cos(phase) for order, amplitude, phase in rows)
    return error, rate * slope


def states_at(
    pair: GearPair, speed: float, load_torque: float, delta: np.ndarray, delta_dot: np.ndarray
) -> np.ndarray:
    """Return states with given delta / b and delta_dot / (b wn) at mesh phase 0.

    The bodies are where the static load puts them and at rest; the rotation alone differs.

    Parameters
    ----------
    pair : GearPair
    speed, load_torque : float
        As in `static_state`.
    delta, delta_dot : (n,) arrays

    Returns
    -------
    (n, STATES) array
    """
    b, wn = pair.half_backlash, pair.derived.wn
    error, error_rate = error_at_phase_0(pair, speed)
    states = np.repeat(static_state(pair, speed, load_torque)[np.newaxis], len(delta), axis=0)
    states[:, 4] = b * np.asarray(delta) + error + states[:, 1] - states[:, 3]
    states[:, 10] = b * wn * np.asarray(delta_dot) + error_rate
    return states
