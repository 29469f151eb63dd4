"""The motion of gear pairs: their records and tables, and where a run starts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.integrator.constants import pack
from gear_dynamics.integrator.contact import BACK, DRIVE
from gear_dynamics.integrator.contact_events import place_contact
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    COORDINATES,
    ERROR,
    GAP,
    MU,
    PAIR_ERROR,
    PAIR_FRICTION,
    PAIR_STIFFNESS,
    PSI,
    PUSH,
    REST,
    STATES,
    SUPPORT_K,
    SUPPORTED,
    VELOCITY,
)
from gear_dynamics.integrator.records import empty_records
from gear_dynamics.integrator.segment import fill_segment
from gear_dynamics.integrator.series import expand_error, expand_own_error
from gear_dynamics.integrator.tables import (
    Fade,
    Group,
    Tables,
    folded_offsets,
    has_friction,
    jumps_possible,
    make_tables,
    packed,
    place_curves,
    unpacked,
)
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.intervals import zones
from gear_dynamics.model.ports import HEALTHY, Ports
from gear_dynamics.model.system import PairInContact, static_equilibrium
from gear_dynamics.parameters.run_settings import RunSettings


class Motion(NamedTuple):
    """The motion of one gear pair.

    `records` is (1,) MOTION, `zones` are the mesh intervals, `ports` are tables in bytes.
    """

    records: np.ndarray
    zones: np.ndarray
    ports: np.ndarray


def copy_of(motion: Motion) -> Motion:
    """Return an independent copy of a motion."""
    records = empty_records(len(motion.records))
    records[:] = motion.records
    return Motion(records, motion.zones, motion.ports.copy())


def elapsed(record: np.void) -> float:
    """Return the time since the start of the run where the present step begins [s]."""
    sampling = record['sampling']
    return float(sampling['origin'] / sampling['sample_rate'] + record['step']['begin'])


def time_of(record: np.void, sample: int) -> float:
    """Return when a sample is due, from the beginning of the present step on [s]."""
    sampling = record['sampling']
    since = (sample - sampling['origin']) / sampling['sample_rate']
    return float(since - record['step']['begin'])


def start(
    pair: GearPair,
    run: RunSettings,
    oversampling: int = 1,
    drive: bool = True,
    ports: Ports = HEALTHY,
) -> Motion:
    """Return the motion of a gear pair at the start of its run.

    The start is q = 0, the static deflection of the commands at mesh phase 0 and delta' = 0.
    """
    groups = [Group(ports)]
    motion = Motion(
        empty_records(1),
        zones(pair, has_friction(pair, groups)),
        packed(make_tables(pair, groups)),
    )
    record = motion.records[0]
    commands, step, sampling = record['commands'], record['step'], record['sampling']
    commands['speed'] = commands['speed_target'] = record['phase']['anchor_speed'] = run.speed
    commands['torque'] = commands['torque_target'] = run.load_torque
    commands['speed_limit'] = run.speed_rate_limit
    commands['torque_limit'] = run.torque_rate_limit
    for name in ('speed_reached', 'torque_reached', 'ports_reached'):
        commands[name] = math.inf
    sampling['sample_rate'] = run.sample_rate * oversampling
    sampling['section_phase'] = run.section_phase
    record['contact']['state'] = DRIVE if run.load_torque >= 0 else BACK
    step['smallest'] = math.inf
    step['length'] = -1.0
    place_curves(unpacked(motion.ports), 0.0, 0.0)
    set_model(motion, pair, run, drive, groups)
    record['state'] = static_state(motion, pair)
    return motion


def set_model(
    motion: Motion, pair: GearPair, run: RunSettings, drive: bool, groups: Sequence[Group]
) -> None:
    """Put constants and what depends on ports into the record of a motion."""
    record, tables = motion.records[0], unpacked(motion.ports)
    stiffest = _stiffest(tables)
    record['constants'] = pack(pair, run.rtol, run.atol, drive, folded_offsets(groups), stiffest)[0]
    step, contact = record['step'], record['contact']
    step['ported'] = motion.ports.size > 0
    step['pushed'] = 0
    contact['active'] = contact['flawed'] = 0
    record['degrees'] = -1
    step['degree'] = 0
    record['segment'] = 0.0
    # Where a cycle begins, rounding may leave the phase just below zero.
    begins, phase = motion.zones['begin'], record['phase']
    phase['zone'] = max(np.searchsorted(begins, phase['phase'], side='right') - 1, 0)
    step['unsettled'] = step['jumpy'] = jumps_possible(tables)


def renewed(motion: Motion, pair: GearPair, run: RunSettings, drive: bool, fade: Fade) -> Motion:
    """Return a motion that goes on from the same state with other parameters and ports."""
    record, phase = motion.records[0], motion.records[0]['phase']
    motion = Motion(
        motion.records,
        zones(pair, has_friction(pair, fade.groups)),
        packed(make_tables(pair, fade.groups, fade.begin, fade.duration)),
    )
    time = elapsed(record)
    place_curves(unpacked(motion.ports), float(phase['cycle'] + phase['phase']), time)
    set_model(motion, pair, run, drive, fade.groups)
    left = fade.begin + fade.duration - time
    record['commands']['ports_reached'] = record['step']['begin'] + left if left > 0 else math.inf
    record['step']['unsettled'] = 1
    return motion


@kernel
def place_all_contacts(records):
    """Set the contact states that belong to the present states, at mesh phase 0, pairs alike."""
    for i in range(records.size):
        motion = records[i]
        expand_own_error(motion)
        place_contact(motion)
        # What ports add is looked at where the first step begins.
        motion.step.unsettled = motion.step.ported


def _stiffest(tables: Tables) -> float:
    """Return a bound of a tooth pair's stiffness over the nominal one."""
    rows = np.maximum(tables.pieces['coefficients'][:, PAIR_STIFFNESS], 0.0).sum(axis=1)
    return 1.0 + float(rows.max(initial=0.0))


@kernel
def _open(records, zones, ports):
    motion = records[0]
    motion.step.degree = fill_segment(motion, zones, ports)
    expand_error(motion)


def static_state(motion: Motion, pair: GearPair) -> np.ndarray:
    """Return the state in static balance with the load torque, at mesh phase 0, delta' = 0.

    Rest points and forces of ports are those at that instant; their torques act from then on.
    """
    _open(*motion)
    record, zone = motion.records[0], motion.zones[0]
    p, degrees, signals = record['constants'], record['degrees'], record['signals']
    torque = float(record['commands']['torque'])
    flank = 1.0 if torque >= 0 else -1.0
    share = 1.0 if p['rectangular'] else 1.0 / zone['pairs']
    mu = p['mu'] + (signals[MU, 0] if degrees[MU] >= 0 else 0.0)
    half_backlash = p['b'] + (signals[GAP, 0] if degrees[GAP] >= 0 else 0.0)
    pairs = []
    for ahead, sliding in enumerate((zone['sliding_a'], zone['sliding_b'])[: zone['pairs']]):
        own = record['pairs'][ahead, :, 0] * record['contact']['active'][0, ahead]
        pairs.append(
            PairInContact(
                stiffness=p['k'] * share * (1.0 + own[PAIR_STIFFNESS]),
                error=own[PAIR_ERROR],
                friction=(mu + own[PAIR_FRICTION]) * flank * sliding,
                arm2=p['arm_sum'] - p['arm1'] - ahead * p['pitch'],
            )
        )
    state = np.zeros(STATES)
    k1, k2 = (
        float(p[name] + (signals[row, 0] if degrees[row] >= 0 else 0.0))
        for name, row in (('k1', SUPPORT_K), ('k2', SUPPORT_K + 1))
    )
    rest, force = (
        np.where(degrees[row : row + SUPPORTED] >= 0, signals[row : row + SUPPORTED, 0], 0.0)
        for row in (REST, PUSH)
    )
    state[:COORDINATES] = static_equilibrium(
        pairs,
        torque,
        float(half_backlash),
        pair.derived.gear_base_radius,
        (k1, k2),
        rest + force / np.array([k1, k1, k2, k2]),
    )
    state[PSI] += record['error'][0, 0]
    # In the order of a literal e', which a series would round otherwise.
    rate = p['e_a'] * math.cos(p['phi0']) * p['z1'] * record['commands']['speed']
    state[VELOCITY + PSI] = rate + (signals[ERROR, 1] if degrees[ERROR] > 0 else 0.0)
    return state
