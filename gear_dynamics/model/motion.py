"""The state of a running gear pair, and what it is made of, as NumPy records and arrays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.model import mesh
from gear_dynamics.model.columns import EVENTS
from gear_dynamics.model.constants import pack
from gear_dynamics.model.contact import BACK, DRIVE, PARTS
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.layout import COLUMNS, ROWS, SEGMENT, STATES, WIDTH
from gear_dynamics.model.run_settings import RunSettings

CLOCK = np.dtype(
    [
        (name, np.float64)
        for name in (
            # the present step: begin [s since origin], length [s], mesh phase at its begin
            'begin length phase '
            # pinion speed [rad/s] and acceleration, load torque [N m] and rate, at its begin
            'speed accel torque torque_rate '
            # targets and rate limits of the commands, and when they are reached
            'speed_target torque_target speed_limit torque_limit speed_reached torque_reached '
            # where speed and acceleration last changed: phase follows from here
            'anchor anchor_phase anchor_speed '
            'sample_rate section_phase smallest_step '
            # forces before the last event, for `model.jumps`, and how fast the arms grow
            'before_force before_friction before_torque1 travel '
            'before_force_k before_force_c before_friction_k before_friction_c '
            'before_curvature before_third'
        ).split()
    ]
    + [
        (name, np.int64)
        for name in (
            # next sample, sample at the origin of time, mesh cycle, its zone, contact states
            'sample origin cycle zone contact_a contact_b '
            # 1: contact states may have jumped, and are looked at where the next step begins
            'unsettled '
            'anchor_cycle section_cycle '
            # why the present step ends, and the contact states after it
            'ending next_a next_b degree jumps jumped '
            'events steps rejected_steps contact_losses back_flank_impacts tiny_steps'
        ).split()
    ]
)
"""One record per gear pair. Times are seconds since `origin`, which moves on once a second so that
they keep their precision however long the run."""


class Motion(NamedTuple):
    """Everything the stepper works on, for n independent gear pairs: leading axis n.

    `constants` (n,) CONSTANTS, `clock` (n,) CLOCK, `state` (n, STATES), `series`
    (n, ROWS, COLUMNS), `error` (n, 3, ROWS), `segment` (n, SEGMENT, WIDTH), `work`
    (n, 2, PARTS), `point` (n, 8, COLUMNS), `events` (n, capacity) EVENTS; and shared by all:
    `zones`, `profiles`.
    """

    constants: np.ndarray
    clock: np.ndarray
    state: np.ndarray
    series: np.ndarray
    error: np.ndarray
    segment: np.ndarray
    work: np.ndarray
    point: np.ndarray
    events: np.ndarray
    zones: np.ndarray
    profiles: np.ndarray


EVENT_CAPACITY = 4096


def at_rest(
    pairs: Sequence[GearPair],
    runs: Sequence[RunSettings],
    oversampling: int = 1,
    drive: bool = True,
    profiles: np.ndarray | None = None,
) -> Motion:
    """Return the motion of gear pairs at the start of their runs.

    The start is q = 0, the static deflection of the commands at mesh phase 0 and delta' = 0. The
    pairs may differ in everything but what sets the zones of the mesh: teeth, module, pressure
    angle, and whether there is friction.
    """
    n = len(pairs)
    table = mesh.zones(pairs[0], profiles)
    clock = np.zeros(n, CLOCK)
    for i, run in enumerate(runs):
        clock[i]['speed'] = clock[i]['speed_target'] = clock[i]['anchor_speed'] = run.speed
        clock[i]['torque'] = clock[i]['torque_target'] = run.load_torque
        clock[i]['speed_limit'] = run.speed_rate_limit
        clock[i]['torque_limit'] = run.torque_rate_limit
        clock[i]['sample_rate'] = run.sample_rate * oversampling
        clock[i]['section_phase'] = run.section_phase
    clock['speed_reached'] = clock['torque_reached'] = math.inf
    clock['smallest_step'] = math.inf
    clock['contact_a'] = clock['contact_b'] = np.where(clock['torque'] >= 0, DRIVE, BACK)
    clock['length'] = -1.0
    clock['unsettled'] = profiles is not None and len(profiles) > 0
    constants = np.concatenate(
        [pack(pair, run.rtol, run.atol, drive) for pair, run in zip(pairs, runs, strict=True)]
    )
    state = np.array(
        [
            static_state(constants[i], table[0], clock['speed'][i], clock['torque'][i])
            for i in range(n)
        ]
    )
    return Motion(
        constants=constants,
        clock=clock,
        state=state,
        series=np.zeros((n, ROWS, COLUMNS)),
        error=np.zeros((n, 3, ROWS)),
        segment=np.zeros((n, SEGMENT, WIDTH)),
        work=np.zeros((n, 2, PARTS)),
        point=np.zeros((n, 8, COLUMNS)),
        events=np.zeros((n, EVENT_CAPACITY), EVENTS),
        zones=table,
        profiles=mesh.healthy() if profiles is None else profiles,
    )


def static_state(p: np.void, zone: np.void, speed: float, load_torque: float) -> np.ndarray:
    """Return the state in static balance with the load torque, at mesh phase 0, delta' = 0.

    The gear's balance -T2 + rb2 F - Tf2 = 0 gives the mesh force; the pairs share it evenly.
    """
    flank = 1.0 if load_torque >= 0 else -1.0
    pairs = int(zone['pairs'])
    share = [p['mu'] * flank * zone['sliding_a'] / pairs]
    arms = [p['arm_sum'] - p['arm1']]
    if pairs == 2:
        share.append(p['mu'] * flank * zone['sliding_b'] / pairs)
        arms.append(p['arm_sum'] - p['arm1'] - p['pitch'])
    force = load_torque / (p['rb2'] - sum(s * arm for s, arm in zip(share, arms, strict=True)))
    friction = sum(share) * force
    stiffness = p['k'] * (pairs if p['rectangular'] else 1)
    error = p['e_a'] * math.sin(p['phi0'])
    error_rate = p['e_a'] * math.cos(p['phi0']) * p['z1'] * speed
    x1, x2 = friction / p['k1'], -friction / p['k2']
    y1, y2 = force / p['k1'], -force / p['k2']
    delta = flank * p['b'] + force / stiffness
    state = np.zeros(STATES)
    state[:5] = x1, y1, x2, y2, delta - y2 + y1 + error
    state[10] = error_rate
    return state
