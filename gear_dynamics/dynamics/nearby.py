"""The largest exponent from two nearby motions, without any variational equation."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numba
import numpy as np

from gear_dynamics.dynamics.cycles import Track, run_cycle, settings
from gear_dynamics.integrator import stepper
from gear_dynamics.integrator.contact_events import place_contact
from gear_dynamics.integrator.kernel import borrowed, kernel
from gear_dynamics.integrator.motion import place_all_contacts
from gear_dynamics.integrator.series import expand_own_error
from gear_dynamics.integrator.variation import VARIED
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.batch import gather, refuse_failure

DISTANCE = 1e-6
"""Distance to which the two are brought back, over half the backlash."""


@kernel
def _bring_back(motion, base):
    """Put the motion at DISTANCE from the base, on the line between; return their distance."""
    p, near, y = motion.constants, motion.state, base.state
    total = 0.0
    for j in range(12):
        scale = 1.0 if j < 6 else p.wn
        total += ((near[j] - y[j]) / scale) ** 2
    distance = math.sqrt(total) / p.b
    for j in range(12):
        near[j] = y[j] + (near[j] - y[j]) * (DISTANCE / distance)
    expand_own_error(motion)
    place_contact(motion)
    return distance


@kernel(parallel=True)
def _run_pairs(batch, growth, status):
    records, bounds = batch.records, batch.bounds
    for i in numba.prange(growth.shape[0]):
        base, near = 2 * i, 2 * i + 1
        nothing, vectors, none = np.empty((0, 16)), np.empty((0, VARIED)), np.empty(0)
        track = Track(np.empty(32), vectors, none, none, nothing, nothing)
        for cycle in range(growth.shape[1]):
            for j in range(base, near + 1):
                zones = borrowed(batch.zones)[bounds[j, 0] : bounds[j + 1, 0]]
                ports = borrowed(batch.ports)[bounds[j, 1] : bounds[j + 1, 1]]
                status[j] = run_cycle(records[j], zones, ports, track)
            if status[base] != stepper.DONE or status[near] != stepper.DONE:
                break
            growth[i, cycle] = math.log(_bring_back(records[near], records[base]) / DISTANCE)


def nearby_growth(
    pairs: Sequence[GearPair],
    speed: float,
    load_torque: float,
    cycles: int,
    states: np.ndarray,
    *,
    rtol: float = 1e-12,
    atol: float = 1e-15,
) -> np.ndarray:
    """Return how fast a second motion, begun nearby, leaves each of n motions.

    The second one is brought back to a small distance after each mesh cycle (Benettin, Galgani
    and Strelcyn 1976).

    Parameters
    ----------
    pairs : sequence of n GearPair
    speed, load_torque : float
        Pinion speed [rad/s], torque on the gear [N m].
    cycles : int
    states : (n, STATES) array
        At mesh phase 0.
    rtol, atol : float
        Tolerances of the integrator: well below the distance.

    Returns
    -------
    (n, cycles) array
        Logarithm of the growth of the distance over each cycle.
    """
    n = len(pairs)
    run = settings(speed, load_torque, 0.5, rtol, atol)
    batch = gather([pair for pair in pairs for _ in range(2)], [run] * 2 * n, False)
    records = batch.records
    records['state'] = np.repeat(states, 2, axis=0)
    apart = DISTANCE / math.sqrt(5) * records['constants']['b'][1::2]
    records['state'][1::2, :5] += apart[:, np.newaxis]
    place_all_contacts(records)
    growth, status = np.zeros((n, cycles)), np.zeros(2 * n, np.int64)
    _run_pairs(batch, growth, status)
    refuse_failure(status, records)
    return growth
