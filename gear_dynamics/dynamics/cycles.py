"""Complete mesh cycles at constant speed and load, from given states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np

from gear_dynamics.integrator import stepper
from gear_dynamics.integrator.contact_events import CONTACT
from gear_dynamics.integrator.kernel import borrowed, kernel
from gear_dynamics.integrator.layout import (
    DELTA,
    PSI,
    Q_SUM,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    STATES,
)
from gear_dynamics.integrator.motion import place_all_contacts
from gear_dynamics.integrator.output import write_due_samples
from gear_dynamics.integrator.phase import time_of_phase
from gear_dynamics.integrator.polynomials import columns_at
from gear_dynamics.integrator.segment import fill_segment
from gear_dynamics.integrator.variation import (
    VARIED,
    advance_vectors,
    damping_at_end,
    jump_at_contact,
    orthonormalise,
)
from gear_dynamics.machine.columns import SAMPLE_COLUMNS, SAMPLES
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports
from gear_dynamics.parameters.run_settings import RunSettings
from gear_dynamics.simulation.batch import gather, refuse_failure, spread

SECTION_DELTA, SECTION_DELTA_DOT, SECTION_STATE = 0, 1, 2
"""Columns of a section: delta [m], delta_dot [m/s], then the integrator's state."""

_SECTION_COLUMNS = SECTION_STATE + STATES

_BODY_COLUMNS = (
    'pinion_x',
    'pinion_y',
    'gear_x',
    'gear_y',
    'psi',
    'pinion_vx',
    'pinion_vy',
    'gear_vx',
    'gear_vy',
    'psi_dot',
    'psi_acceleration',
    'delta_acceleration',
)

BODIES = np.dtype([(name, np.float64) for name in _BODY_COLUMNS])
"""What the bodies do beside the columns of a sample: displacements and psi [m], their rates [m/s],
psi'' and delta'' [m/s2]."""


class Cycles(NamedTuple):
    """What n gear pairs did over a number of mesh cycles.

    Attributes
    ----------
    sections : (n, cycles, 15) array
        At each passage of the section phase: delta [m], delta_dot [m/s] and the full state.
    states : (n, STATES) array
        At the end, where a cycle begins: give them to go on from there.
    samples : (n, cycles * samples_per_cycle) array of SAMPLES
    bodies : (n, cycles * samples_per_cycle) array of BODIES
        At the instants of the samples; (n, 0) if not asked for.
    vectors : (n, k, VARIED) array
        The tangent vectors at the end.
    growth : (n, cycles, k) array
        Logarithm of the growth of each tangent vector over each cycle.
    divergence : (n, cycles) array
        Integral over each cycle of the trace of the Jacobian: the sum of `growth` where k is 10.
    period : (n,) array
        Length of a mesh cycle [s].
    """

    sections: np.ndarray
    states: np.ndarray
    samples: np.ndarray
    bodies: np.ndarray
    vectors: np.ndarray
    growth: np.ndarray
    divergence: np.ndarray
    period: np.ndarray


class Track(NamedTuple):
    """What one pair's cycles are written into; arrays without rows are left out.

    Attributes
    ----------
    section : (SECTION_COLUMNS,) array, of the present cycle
    vectors : (k, VARIED) array, advanced along with the motion
    growth : (k,) array, of the present cycle
    divergence : (1,) array, of the present cycle
    samples, bodies : (m, columns) arrays, of all cycles
    """

    section: np.ndarray
    vectors: np.ndarray
    growth: np.ndarray
    divergence: np.ndarray
    samples: np.ndarray
    bodies: np.ndarray


@kernel
def _write_section(motion, section):
    """Write the state at the section phase, or at the end of the step if that is before it."""
    step, point = motion.step, motion.point
    tau = time_of_phase(motion, motion.sampling.section_phase) - step.begin
    columns_at(motion.series, min(max(tau, 0.0), step.length), point)
    section[SECTION_DELTA], section[SECTION_DELTA_DOT] = point[0, DELTA], point[1, DELTA]
    for j in range(6):
        section[SECTION_STATE + j] = point[0, j]
        section[SECTION_STATE + 6 + j] = point[1, j]
    section[SECTION_STATE + 12] = point[0, Q_SUM]


@kernel
def _write_bodies(motion, bodies, first, count):
    """Write the rows of BODIES at the samples that were written last, off the same series."""
    point, times = motion.point, motion.times
    for i in range(count):
        columns_at(motion.series, times[i], point)
        for j in range(5):
            bodies[first + i, j], bodies[first + i, 5 + j] = point[0, j], point[1, j]
        columns_at(motion.rates, times[i], point)
        bodies[first + i, 10], bodies[first + i, 11] = point[1, PSI], point[1, DELTA]


@kernel
def _jump_at_contact(motion, zones, ports, before, vectors):
    """Let the tangent vectors jump: the step that has just ended did so at a contact.

    before : (3,) array
        Damping of F, Ff and the moment at its end.
    """
    segment = motion.segment
    fill_segment(motion, zones, ports)
    after = (segment[SEG_FORCE + 1, 0], segment[SEG_FRICTION + 1, 0], segment[SEG_MOMENT + 1, 0])
    for j in range(3):
        before[j] = after[j] - before[j]
    jump_at_contact(motion.constants, before, vectors)


@kernel
def run_cycle(motion, zones, ports, track):
    """Advance to the beginning of the next mesh cycle.

    Step by step, and not from sample to sample as `stepper.run` does: tangent vectors take each
    step as a whole.
    """
    vectors, out, bodies = track.vectors, track.samples, track.bodies
    phase, step, sampling = motion.phase, motion.step, motion.sampling
    cycle = phase.cycle
    damping = motion.forced[:3]
    while phase.cycle == cycle:
        status = stepper.begin_step(motion, zones, ports)
        if status != stepper.DONE:
            return status
        while sampling.sample < out.shape[0]:
            first = sampling.sample
            count = write_due_samples(motion, 1, out, first)
            if count == 0:
                break
            if bodies.shape[0] > 0:
                _write_bodies(motion, bodies, first, count)
        if vectors.shape[0] > 0:
            track.divergence[0] += advance_vectors(motion, vectors)
        if sampling.section_cycle <= cycle:
            _write_section(motion, track.section)
        contact = step.ending == CONTACT and vectors.shape[0] > 0
        if contact:
            damping_at_end(motion, damping)
        stepper.end_step(motion, zones, ports)
        motion.counts.events = 0
        if contact:
            _jump_at_contact(motion, zones, ports, damping, vectors)
    if track.growth.size > 0:
        orthonormalise(vectors, track.growth)
    return stepper.DONE


@kernel(parallel=True)
def _run_all(batch, tracks, status):
    """Run each pair of a batch; `tracks` is a Track whose arrays have a row for each pair."""
    for i in numba.prange(status.size):
        bounds = batch.bounds
        a, b, c, d = bounds[i, 0], bounds[i, 1], bounds[i + 1, 0], bounds[i + 1, 1]
        zones, ports = borrowed(batch.zones)[a:c], borrowed(batch.ports)[b:d]
        for cycle in range(tracks.section.shape[1]):
            track = Track(
                borrowed(tracks.section)[i, cycle],
                borrowed(tracks.vectors)[i],
                borrowed(tracks.growth)[i, cycle],
                borrowed(tracks.divergence)[i, cycle : cycle + 1],
                borrowed(tracks.samples)[i],
                borrowed(tracks.bodies)[i],
            )
            status[i] = run_cycle(batch.records[i], zones, ports, track)
            if status[i] != stepper.DONE:
                break


def settings(
    speed: float, load_torque: float, section_phase: float, rtol: float, atol: float
) -> RunSettings:
    """Return the settings of a run at constant speed and load."""
    return RunSettings(
        speed=float(speed),
        load_torque=float(load_torque),
        section_phase=section_phase,
        rtol=rtol,
        atol=atol,
    )


def run_cycles(
    pairs: Sequence[GearPair],
    speeds: float | Sequence[float] | np.ndarray,
    load_torques: float | Sequence[float] | np.ndarray,
    cycles: int,
    *,
    states: np.ndarray | None = None,
    vectors: np.ndarray | None = None,
    orthogonal: bool = True,
    samples_per_cycle: int = 0,
    with_bodies: bool = False,
    drive: bool = False,
    ports: Sequence[Ports] | None = None,
    section_phase: float = 0.5,
    rtol: float = 1e-9,
    atol: float = 1e-12,
) -> Cycles:
    """Run many gear pairs for a number of mesh cycles, over all cores.

    Parameters
    ----------
    pairs : sequence of n GearPair
    speeds : float or n floats
        Pinion speed [rad/s], positive.
    load_torques : float or n floats
        On the gear [N m].
    cycles : int
    states : (n, STATES) array, optional
        At mesh phase 0; the static deflection by default. Tooth 0 of both wheels comes into contact
        then, also where the states are those that another call ended with.
    vectors : (n, k, VARIED) array, optional
        Variations to advance along with the motion; of the reduced form alone.
    orthogonal : bool
        Make the tangent vectors orthonormal after each cycle; without it `growth` has no cycles,
        and tangent vectors that begin as the unit matrix become the monodromy matrix.
    samples_per_cycle : int
        Samples at equal distances in each cycle, the first at its beginning.
    with_bodies : bool
        Return what the bodies do at the samples too.
    drive : bool
        True runs the full form of docs/model.md.
    ports : n Ports, optional
        How the machines depart from the healthy ones.
    section_phase : float
        In cycles, [0, 1).
    rtol, atol : float
        Tolerances of the integrator.

    Returns
    -------
    Cycles

    Raises
    ------
    ParameterError
        If an argument is out of its range.
    IntegrationError
        If the integrator cannot go on with one of the pairs.
    """
    n = len(pairs)
    speeds, load_torques = spread(speeds, n, 'speeds'), spread(load_torques, n, 'load_torques')
    period = 2 * np.pi / (np.array([pair.pinion_teeth for pair in pairs]) * speeds)
    runs = [
        settings(speed, torque, section_phase, rtol, atol)
        for speed, torque in zip(speeds, load_torques, strict=True)
    ]
    batch = gather(pairs, runs, drive, ports)
    records = batch.records
    records['sampling']['sample_rate'] = max(samples_per_cycle, 1) / period
    if states is not None:
        records['state'] = states
        place_all_contacts(records)
    vectors = np.zeros((n, 0, VARIED)) if vectors is None else np.array(vectors, dtype=float)
    result = Cycles(
        sections=np.zeros((n, cycles, _SECTION_COLUMNS)),
        states=records['state'],
        samples=np.zeros((n, cycles * samples_per_cycle), SAMPLES),
        bodies=np.zeros((n, cycles * samples_per_cycle if with_bodies else 0), BODIES),
        vectors=vectors,
        growth=np.zeros((n, cycles, vectors.shape[1] if orthogonal else 0)),
        divergence=np.zeros((n, cycles)),
        period=period,
    )
    tracks = Track(
        result.sections,
        result.vectors,
        result.growth,
        result.divergence,
        result.samples.view(np.float64).reshape(n, -1, len(SAMPLE_COLUMNS)),
        result.bodies.view(np.float64).reshape(n, -1, len(_BODY_COLUMNS)),
    )
    status = np.zeros(n, np.int64)
    _run_all(batch, tracks, status)
    refuse_failure(status, records)
    return result
