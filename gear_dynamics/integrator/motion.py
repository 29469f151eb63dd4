"""The state of a running gear pair, and what it is made of, as NumPy records and arrays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.integrator.constants import CONSTANTS, pack
from gear_dynamics.integrator.contact import BACK, DRIVE, PARTS
from gear_dynamics.integrator.layout import COLUMNS, ROWS, SEGMENT, STATES, VALUES, WIDTH
from gear_dynamics.integrator.vector import LANES
from gear_dynamics.machine.columns import EVENTS
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh import intervals as mesh
from gear_dynamics.parameters.run_settings import RunSettings

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
            # the pinion and the gear tooth of pair A
            'tooth1 tooth2 '
            # why the present step ends, and the contact states after it
            'ending next_a next_b degree jumps jumped rated '
            'events steps rejected_steps contact_losses back_flank_impacts tiny_steps'
        ).split()
    ]
)
"""One record per gear pair. Times are seconds since `origin`, which moves on once a second so that
they keep their precision however long the run."""


EVENT_ROOM = 128
"""Events that a motion can hold until they are taken out."""

_CACHE_LINE = 64


def _in_cache_lines(fields: dict[str, tuple]) -> np.dtype:
    """Return a record of fields (dtype, shape), each of which begins a cache line.

    A vector that lies in two of them takes twice as long to load and to store.
    """
    offsets, end = [], 0
    for kind in fields.values():
        offsets.append(end)
        end += -(-np.dtype(kind).itemsize // _CACHE_LINE) * _CACHE_LINE
    formats = [np.dtype(kind) for kind in fields.values()]
    return np.dtype(
        {'names': list(fields), 'formats': formats, 'offsets': offsets, 'itemsize': end}
    )


MOTION = _in_cache_lines(
    {
        'constants': (CONSTANTS, ()),
        'clock': (CLOCK, ()),
        'state': (np.float64, (STATES,)),
        'series': (np.float64, (ROWS, COLUMNS)),
        # the transmission error; and delta_i of pairs A and B while their contact is looked at
        'error': (np.float64, (3, ROWS)),
        'segment': (np.float64, (SEGMENT, WIDTH)),
        'parts': (np.float64, (2, PARTS)),
        'point': (np.float64, (2, COLUMNS)),
        # of samples: series of derivatives, times in the step, values at them
        'rates': (np.float64, (ROWS, COLUMNS)),
        'times': (np.float64, (LANES,)),
        'values': (np.float64, (VALUES, LANES)),
        'forced': (np.float64, (4,)),
        'events': (EVENTS, (EVENT_ROOM,)),
    }
)
"""Everything that the stepper keeps of one gear pair."""


class Motion(NamedTuple):
    """The motion of n independent gear pairs.

    `records` is (n,) MOTION; `zones` and `profiles` of the mesh are shared by all.
    """

    records: np.ndarray
    zones: np.ndarray
    profiles: np.ndarray


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
    records = empty_records(n)
    clock = records['clock']
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
    for i, (pair, run) in enumerate(zip(pairs, runs, strict=True)):
        records['constants'][i] = pack(pair, run.rtol, run.atol, drive)[0]
        records['state'][i] = static_state(
            records['constants'][i], table[0], clock['speed'][i], clock['torque'][i]
        )
    return Motion(records, table, mesh.healthy() if profiles is None else profiles)


def empty_records(n: int) -> np.ndarray:
    """Return n records of MOTION that begin at a cache line."""
    memory = np.zeros(n * MOTION.itemsize + _CACHE_LINE, np.uint8)
    skip = -memory.ctypes.data % _CACHE_LINE
    return memory[skip : skip + n * MOTION.itemsize].view(MOTION)


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
