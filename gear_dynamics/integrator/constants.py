"""The numbers that the compiled kernels need of a gear pair, as one NumPy record.

Symbols are those of docs/model.md: index 1 the pinion, 2 the gear, y along the line of action. The
equations of motion come from `model.system`; here they are laid out for the kernels.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from gear_dynamics.integrator.layout import (
    ANSWERS,
    COLUMNS,
    COORDINATES,
    DAMPING,
    STIFFNESS,
    TO_FORCE,
    TO_Q,
    TO_Q_DOT,
    TO_Q_SUM,
    Q,
)
from gear_dynamics.model import system as equations
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Offset, Term
from gear_dynamics.parameters.parameter import ParameterError

FOLDED = {
    'half_backlash': 'b',
    'friction': 'mu',
    'pinion_support_stiffness': 'k1',
    'gear_support_stiffness': 'k2',
    'pinion_support_damping': 'c1',
    'gear_support_damping': 'c2',
}
"""Signals whose constant offsets change a constant, so that they cost nothing."""

CONSTANTS = np.dtype(
    [
        (name, np.float64)
        for name in (
            # rigid bodies, supports
            'm1 m2 c1 c2 k1 k2 inertia_t inertia2 rb1 ratio '
            # one tooth pair, mesh
            'k c b mu e_a phi0 z1 z2 pitch arm1 arm_sum '
            # drive
            'kd cd ki made_up '
            # th1 and th2 of psi
            'th1_psi th2_psi '
            # scales and tolerances
            'wn fastest rtol atol '
            # angle of one tooth [rad]
            'tooth1 tooth2'
        ).split()
    ]
    + [(name, np.int64) for name in ('rectangular', 'damping_in_gap', 'drive', 'hunting')]
    + [
        ('answers', np.float64, (ANSWERS, COLUMNS)),
        ('torques', np.float64, (2, COLUMNS)),
        ('scales', np.float64, (COLUMNS,)),
    ]
)
"""k, c: of one tooth pair; pitch: base pitch; arm1: r1 sin a - l1; arm_sum: (rb1 + rb2) tan a;
ratio: rb1 / rb2; inertia_t: It; th1_psi, th2_psi: what psi adds to th1 and takes from th2;
fastest: bound of the natural frequencies [rad/s];
made_up: torque that the drive adds per unit of T2*;
drive: 1 for the six-coordinate form, 0 for the reduced one;
hunting: tooth pairs until the same two teeth meet again; answers: see `layout`;
torques: acceleration of the columns per torque on the pinion (row 0) and against the gear (1);
scales: of the columns of a series, to weigh them against each other."""


UNYIELDING = 1e300
"""Stiffness of rigid supports [N/m]: no force that occurs deflects them."""


def pack(
    pair: GearPair,
    rtol: float,
    atol: float,
    drive: bool = True,
    offsets: Iterable[Term] = (),
    stiffest: float = 1.0,
) -> np.ndarray:
    """Return the constants of a gear pair as an array of one record.

    Parameters
    ----------
    pair : GearPair
    rtol, atol : float
        Tolerances of the integrator; atol is scaled by b, b wn or b / rb.
    drive : bool
        False gives the reduced form: no rigid rotation q, and T1 carries the load and, while the
        speed ramps, the inertias.
    offsets : iterable of ports.Offset
        Constant offsets of the signals in FOLDED; other terms are ignored.
    stiffest : float
        Bound of a tooth pair's stiffness over the nominal one.

    Raises
    ------
    ParameterError
        If the half backlash, mu or a support would not be positive with its offsets.
    """
    derived = pair.derived
    system = equations.system(pair, drive)
    ratio = derived.pinion_base_radius / derived.gear_base_radius
    inertia_t = derived.pinion_inertia + derived.gear_inertia * ratio**2
    arm1, arm_sum = equations.arms(pair)
    kd, cd, ki = equations.drive_control(pair, inertia_t)
    m1, m2 = equations.masses(pair)
    rigid = pair.support_model == 'rigid'
    values = {
        'm1': m1,
        'm2': m2,
        'inertia2': derived.gear_inertia,
        'inertia_t': inertia_t,
        'c1': derived.pinion_support_damping,
        'c2': derived.gear_support_damping,
        'k1': UNYIELDING if rigid else pair.pinion_support_stiffness,
        'k2': UNYIELDING if rigid else pair.gear_support_stiffness,
        'rb1': derived.pinion_base_radius,
        'ratio': ratio,
        'k': derived.single_stiffness,
        'c': derived.tooth_pair_damping,
        'b': pair.half_backlash,
        'mu': pair.friction_coefficient,
        'e_a': pair.transmission_error_amplitude,
        'phi0': pair.transmission_error_phase,
        'z1': pair.pinion_teeth,
        'z2': pair.gear_teeth,
        'pitch': derived.base_pitch,
        'arm1': arm1,
        'arm_sum': arm_sum,
        'kd': kd,
        'cd': cd,
        'ki': ki,
        'made_up': equations.feed_forward(pair) if drive else 0.0,
        'th1_psi': system.angles[0, 0],
        'th2_psi': -system.angles[1, 0],
        'wn': derived.wn,
        'rtol': rtol,
        'atol': atol,
        'rectangular': pair.mesh_stiffness != 'constant',
        'damping_in_gap': pair.damping_in_gap,
        'drive': drive,
        'tooth1': 2 * math.pi / pair.pinion_teeth,
        'tooth2': 2 * math.pi / pair.gear_teeth,
        'hunting': math.lcm(pair.pinion_teeth, pair.gear_teeth),
    }
    _add_offsets(values, offsets)
    values['fastest'] = _fastest_mode(pair, values, stiffest)
    packed = np.zeros(1, CONSTANTS)
    for name, value in values.items():
        packed[name] = value
    packed['answers'] = _answers(system, values)
    packed['torques'][0, :, :COORDINATES] = system.torques.T
    packed['scales'][0, :COORDINATES] = 1.0
    packed['scales'][0, Q] = values['rb1']
    return packed


def _add_offsets(values: dict[str, float], offsets: Iterable[Term]) -> None:
    for term in offsets:
        if isinstance(term, Offset) and term.signal in FOLDED:
            name = FOLDED[term.signal]
            values[name] += term.value
            least = 0.0 if name in ('mu', 'c1', 'c2') else 1e-12
            if values[name] < least:
                raise ParameterError(
                    f'{term.signal} is {values[name]:g} with its offsets: it must be positive'
                )


def _answers(system: equations.System, values: dict[str, float]) -> np.ndarray:
    """Return the equations of motion by columns of a series, one vector an influence."""
    rows = np.zeros((ANSWERS, COLUMNS))
    n = COORDINATES
    rows[TO_FORCE : TO_FORCE + 4, :n] = system.loads.T
    for row, k1, k2 in ((STIFFNESS, 'k1', 'k2'), (DAMPING, 'c1', 'c2')):
        rows[row, 0:2] = -values[k1] / values['m1']
        rows[row, 2:4] = -values[k2] / values['m2']
    rows[TO_Q, :n] = -system.stiffness[:, Q]
    rows[TO_Q_DOT, :n] = -system.damping[:, Q]
    rows[TO_Q_SUM, :n] = -system.integral
    return rows


def _fastest_mode(pair: GearPair, values: dict[str, float], stiffest: float) -> float:
    """Return a bound of the highest natural frequency, with two pairs in contact [rad/s].

    The sum of what the mesh and the supports alone would give (Weyl's inequality).
    """
    derived = pair.derived
    mesh = 2 * derived.single_stiffness * stiffest
    m1, m2 = values['m1'], values['m2']
    mesh *= 1 / m1 + 1 / m2 + 1 / derived.equivalent_mass
    supports = max(values['k1'] / m1, values['k2'] / m2)
    return math.sqrt(mesh + supports)
