"""Tasks of the study of spectra: the harmonics of one motion, and of many for the map."""

from __future__ import annotations

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.regimes import LONGEST_STUDIED, RECURS, recurrence_period
from gear_dynamics.study.harmonics import (
    ACCELERATIONS,
    QUANTITIES,
    row_of,
    row_of_slope,
    slope_harmonics,
)
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import OperatingPoint, unzip
from gear_dynamics.study.outcome import Arrays

BODY_UNITS = {
    'pinion_x': 'm',
    'pinion_y': 'm',
    'gear_x': 'm',
    'gear_y': 'm',
    'psi': 'm',
    'psi_acceleration': 'm/s2',
    'delta_acceleration': 'm/s2',
}
"""What the table of the full form has of the bodies beside QUANTITIES."""

RATES = {
    'pinion_ax': 'pinion_vx',
    'pinion_ay': 'pinion_vy',
    'gear_ax': 'gear_vx',
    'gear_ay': 'gear_vy',
    'psi_acceleration': 'psi_dot',
    'delta_acceleration': 'delta_dot',
}
"""What the accelerations of that table are the slopes of."""

OTHER_UNITS = {'delta': 'm', 'mesh_force': 'N', 'friction_force': 'N'}

RECORD = 32
"""Mesh cycles in a record, or the most that are whole periods of the motion."""

TABLE_SAMPLES, MAP_SAMPLES = 8192, 1024
"""Samples in a mesh cycle; the forces jump, so that what folds back falls as one over this."""

RECURS_IN = 128
"""Mesh cycles, the last of which are the record, in which a motion is seen to recur."""

DRIVE_SETTLES = 5000
"""Mesh cycles before the record of the full form, in which the drive takes up the mean loss."""


def quantities() -> dict[str, str]:
    """Return the units of what the table has."""
    found = {}
    for name in QUANTITIES:
        found[name] = OTHER_UNITS.get(name, 'm/s2')
        if name in ACCELERATIONS:
            body = name.replace('_a', '_')
            found[body] = BODY_UNITS[body]
    return found | BODY_UNITS


def recurrence(point: OperatingPoint, sections: np.ndarray) -> tuple[int, int]:
    """Return the period of a motion, 0 without one, and of how many cycles its record is.

    sections : (cycles, ...) array
        As `run_cycles` has them, up to the end of the record of RECORD cycles.
    """
    scaled = point.scaled(sections[-RECURS_IN:])
    period, _ = recurrence_period(scaled, RECURS, LONGEST_STUDIED)
    return period, RECORD // period * period if period else RECORD


def table_task(point: OperatingPoint) -> Arrays:
    """Return all rows of the full form, once the drive has settled."""
    pairs = [point.pair]
    run = (pairs, point.speed, point.load_torque)
    before = dynamics.run_cycles(*run, DRIVE_SETTLES, drive=True)
    # A cycle more, for what rates have come to at the end.
    after = dynamics.run_cycles(
        *run,
        RECORD + 1,
        states=before.states,
        drive=True,
        samples_per_cycle=TABLE_SAMPLES,
        with_bodies=True,
    )
    sections = np.concatenate([before.sections[0], after.sections[0]])
    period, cycles = recurrence(point, sections)
    end, duration = cycles * TABLE_SAMPLES, cycles * float(after.period[0])
    samples, bodies = after.samples[0], after.bodies[0]
    found = {name: samples[name] for name in (*QUANTITIES, 'delta_dot')}
    found |= {name: bodies[name] for name in bodies.dtype.names}
    rows = {name: row_of(found[name][:end], cycles) for name in quantities() if name not in RATES}
    for name, rate in RATES.items():
        rows[name] = row_of_slope(found[name][:end], found[rate][: end + 1], cycles, duration)
    return rows | {
        'period': np.array(period),
        'cycles': np.array(cycles),
        'ax_lines': slope_harmonics(found['pinion_vx'][: end + 1], cycles, duration),
        'ay_lines': slope_harmonics(found['pinion_vy'][: end + 1], cycles, duration),
    }


def map_task(points: list[OperatingPoint], transient: int) -> Arrays:
    """Return rows of QUANTITIES of motions of the reduced form, (n, quantities, 6), and periods.

    The period is 0 for a motion without one: what its record shows is partly chance.
    """
    pairs, speeds, torques = unzip(points)
    states = np.concatenate([scattered_states(each, 1) for each in points])
    before = dynamics.run_cycles(pairs, speeds, torques, transient, states=states)
    after = dynamics.run_cycles(
        pairs, speeds, torques, RECORD, states=before.states, samples_per_cycle=MAP_SAMPLES
    )
    sections = np.concatenate([before.sections, after.sections], axis=1)
    found = [recurrence(*each) for each in zip(points, sections, strict=True)]
    rows = [
        [row_of(samples[name][: cycles * MAP_SAMPLES], cycles) for name in QUANTITIES]
        for samples, (_, cycles) in zip(after.samples, found, strict=True)
    ]
    return {'rows': np.array(rows), 'period': np.array([period for period, _ in found])}
