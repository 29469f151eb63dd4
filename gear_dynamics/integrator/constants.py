"""The numbers that the compiled kernels need of a gear pair, as one NumPy record.

Symbols are those of docs/model.md: index 1 the pinion, 2 the gear, y along the line of action.
"""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.integrator.layout import COLUMNS, PSI, Q_SUM, X1, X2, Y1, Y2, Q
from gear_dynamics.integrator.recurrence import (
    ANSWERS,
    DAMPING,
    STIFFNESS,
    TO_FORCE,
    TO_FRICTION,
    TO_LOAD,
    TO_MOMENT,
    TO_Q,
    TO_Q_DOT,
    TO_Q_SUM,
)
from gear_dynamics.model.gear_pair import GearPair

CONSTANTS = np.dtype(
    [
        (name, np.float64)
        for name in (
            # rigid bodies, supports
            'm1 m2 inertia1 inertia2 c1 c2 k1 k2 me rb1 rb2 ratio inertia_t '
            # one tooth pair, mesh
            'k c b mu e_a phi0 z1 z2 pitch arm1 arm_sum '
            # drive
            'kd cd ki '
            # ready for the equations: 1 / m, c / m, k / m and the like
            'inv_m1 inv_m2 inv_me inv_it c1_m c2_m k1_m k2_m psi_1 psi_2 th1_psi th2_psi '
            # scales and tolerances
            'wn fastest rtol atol '
            # angle of one tooth [rad]
            'tooth1 tooth2'
        ).split()
    ]
    + [(name, np.int64) for name in ('rectangular', 'damping_in_gap', 'drive', 'hunting')]
    + [
        ('answers', np.float64, (ANSWERS, COLUMNS)),
        ('scales', np.float64, (COLUMNS,)),
    ]
)
"""k, c: of one tooth pair; pitch: base pitch; arm1: r1 sin a - l1; arm_sum: (rb1 + rb2) tan a;
ratio: rb1 / rb2; inertia_t: It; psi_1, psi_2: rb / I;
th1_psi, th2_psi: what psi adds to th1 and takes from th2;
fastest: bound of the natural frequencies [rad/s];
drive: 1 for the six-coordinate form, 0 for the reduced one;
hunting: tooth pairs until the same two teeth meet again; answers: see `model.recurrence`;
scales: of the columns of a series, to weigh them against each other."""


def pack(pair: GearPair, rtol: float, atol: float, drive: bool = True) -> np.ndarray:
    """Return the constants of a gear pair as an array of one record.

    Parameters
    ----------
    pair : GearPair
    rtol, atol : float
        Tolerances of the integrator; atol is scaled by b, b wn or b / rb.
    drive : bool
        False gives the reduced form: no rigid rotation q, and T1 carries the load and, while the
        speed ramps, the inertias.
    """
    derived = pair.derived
    angle = math.radians(pair.pressure_angle_deg)
    ratio = derived.pinion_base_radius / derived.gear_base_radius
    inertia_t = derived.pinion_inertia + derived.gear_inertia * ratio**2
    drive_rate = 2 * math.pi * pair.drive_frequency
    kd = drive_rate**2 * inertia_t
    values = {
        'm1': derived.pinion_mass,
        'm2': derived.gear_mass,
        'inertia1': derived.pinion_inertia,
        'inertia2': derived.gear_inertia,
        'c1': derived.pinion_support_damping,
        'c2': derived.gear_support_damping,
        'k1': pair.pinion_support_stiffness,
        'k2': pair.gear_support_stiffness,
        'me': derived.equivalent_mass,
        'rb1': derived.pinion_base_radius,
        'rb2': derived.gear_base_radius,
        'ratio': ratio,
        'inertia_t': inertia_t,
        'k': derived.single_stiffness,
        'c': derived.tooth_pair_damping,
        'b': pair.half_backlash,
        'mu': pair.friction_coefficient,
        'e_a': pair.transmission_error_amplitude,
        'phi0': pair.transmission_error_phase,
        'z1': pair.pinion_teeth,
        'z2': pair.gear_teeth,
        'pitch': derived.base_pitch,
        'arm1': derived.pinion_pitch_radius * math.sin(angle) - derived.approach_length,
        'arm_sum': (derived.pinion_base_radius + derived.gear_base_radius) * math.tan(angle),
        'kd': kd,
        'cd': 2 * pair.drive_damping_ratio * drive_rate * inertia_t,
        'ki': kd * drive_rate / 5,
        'wn': derived.wn,
        'fastest': _fastest_mode(pair),
        'rtol': rtol,
        'atol': atol,
        'rectangular': pair.mesh_stiffness != 'constant',
        'damping_in_gap': pair.damping_in_gap,
        'drive': drive,
        'tooth1': 2 * math.pi / pair.pinion_teeth,
        'tooth2': 2 * math.pi / pair.gear_teeth,
        'hunting': math.lcm(pair.pinion_teeth, pair.gear_teeth),
    }
    values |= {
        'inv_m1': 1 / values['m1'],
        'inv_m2': 1 / values['m2'],
        'inv_me': 1 / values['me'],
        'inv_it': 1 / inertia_t,
        'c1_m': values['c1'] / values['m1'],
        'c2_m': values['c2'] / values['m2'],
        'k1_m': values['k1'] / values['m1'],
        'k2_m': values['k2'] / values['m2'],
        'psi_1': values['rb1'] / values['inertia1'],
        'psi_2': values['rb2'] / values['inertia2'],
        'th1_psi': ratio * values['inertia2'] / (values['rb2'] * inertia_t),
        'th2_psi': values['inertia1'] / (values['rb2'] * inertia_t),
    }
    packed = np.zeros(1, CONSTANTS)
    for name, value in values.items():
        packed[name] = value
    packed['answers'] = _answers(packed[0])
    packed['scales'][0, [X1, Y1, X2, Y2, PSI]], packed['scales'][0, Q] = 1.0, values['rb1']
    return packed


def _answers(p: np.void) -> np.ndarray:
    """Return what the columns of a series answer to: the equations of docs/model.md, by columns."""
    rows = np.zeros((ANSWERS, COLUMNS))
    rows[TO_FORCE, [Y1, Y2, PSI]] = p['inv_m1'], -p['inv_m2'], -p['inv_me']
    rows[TO_FRICTION, [X1, X2, PSI]] = p['inv_m1'], -p['inv_m2'], p['psi_2'] * p['arm_sum']
    rows[TO_MOMENT, PSI] = p['psi_1'] - p['psi_2']
    rows[TO_LOAD, PSI] = p['inv_me'] / p['rb2']
    rows[STIFFNESS, [X1, Y1, X2, Y2]] = -p['k1_m'], -p['k1_m'], -p['k2_m'], -p['k2_m']
    rows[DAMPING, [X1, Y1, X2, Y2]] = -p['c1_m'], -p['c1_m'], -p['c2_m'], -p['c2_m']
    if p['drive']:
        rows[TO_FRICTION, Q] = -p['ratio'] * p['arm_sum'] * p['inv_it']
        rows[TO_MOMENT, Q] = (1 + p['ratio']) * p['inv_it']
        control = {TO_Q: p['kd'], TO_Q_DOT: p['cd'], TO_Q_SUM: p['ki']}
        for to, strength in control.items():
            rows[to, [PSI, Q]] = -strength * p['psi_1'], -strength * p['inv_it']
        rows[TO_Q_DOT, Q_SUM] = 1.0
    return rows


def _fastest_mode(pair: GearPair) -> float:
    """Return a bound of the highest natural frequency, with two pairs in contact [rad/s].

    The sum of what the mesh and the supports alone would give (Weyl's inequality).
    """
    derived = pair.derived
    mesh = 2 * derived.single_stiffness
    mesh *= 1 / derived.pinion_mass + 1 / derived.gear_mass + 1 / derived.equivalent_mass
    supports = max(
        pair.pinion_support_stiffness / derived.pinion_mass,
        pair.gear_support_stiffness / derived.gear_mass,
    )
    return math.sqrt(mesh + supports)
