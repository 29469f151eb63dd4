"""The published study of friction: what it gives, its exponents and its claims."""

from __future__ import annotations

import numpy as np

from gear_dynamics.study.harmonics import ACCELERATIONS, QUANTITIES
from gear_dynamics.study.operating_point import OperatingPoint

SOURCE = {0.0: 0.1263, 0.03: 0.0732, 0.05: -0.0462}
"""Largest exponents that the published study gives at SOURCE_W, by friction coefficient."""

SOURCE_W = 1.222

GIVEN = {
    'pinion_teeth': 34,
    'gear_teeth': 59,
    'module': 0.002,
    'pressure_angle_deg': 20.0,
    'tooth_pair_stiffness': 5.33e8,
    'mesh_stiffness': 'rectangular',
    'damping_in_gap': True,
    'half_backlash': 150e-6,
    'transmission_error_amplitude': 15e-6,
    'pinion_support_stiffness': 5e8,
    'gear_support_stiffness': 5e8,
}
"""What the published study gives of the pair, but for the damping ratio of the mesh, which may be
read in two ways. It leaves out masses, inertias, load, support damping, and the error's phase."""

CLAIMS = {
    'all_directions': 'vibration rises in all directions: x and y of both wheels',
    'y1_rises': '  y of the pinion',
    'y2_rises': '  y of the gear',
    'most_in_x': 'it rises most in x: by more than in y, on both wheels',
    'most_in_x1': '  on the pinion',
    'most_in_x2': '  on the gear',
    'into_first': 'the energy goes into the first mesh harmonic: all of the following',
    'first_rises': '  of the mesh force the first harmonic rises',
    'first_rises_most': '  and rises by more than harmonics 2 to 5',
    'first_leads_x1': '  of x of the pinion the first harmonic is the highest of 1 to 5',
    'first_leads_x2': '  of x of the gear the first harmonic is the highest of 1 to 5',
    'all_claims': 'all three',
}
"""The source's claims and their parts, each by itself."""


def is_published(point: OperatingPoint) -> bool:
    """Return whether SOURCE is about this: what the study gives is so, whatever the friction."""
    given = point.pair.to_mapping()
    return (
        all(given[name] == value for name, value in GIVEN.items())
        and abs(point.frequency_ratio - SOURCE_W) < 1e-6
    )


def holds(rows: np.ndarray) -> dict[str, np.ndarray]:
    """Return where each claim of the source holds, by the names of CLAIMS, from a map's rows.

    Vibration is the RMS of an acceleration. x vibrates by friction alone, so that it always rises,
    and by all that it is.

    Parameters
    ----------
    rows : (2, ..., quantities, 6) array
        Without and with friction.
    """
    at = {name: i for i, name in enumerate(QUANTITIES)}
    rise = {name: rows[1, ..., at[name], :] - rows[0, ..., at[name], :] for name in QUANTITIES}
    rms = {name: rise[name][..., 0] for name in ACCELERATIONS}
    force = rise['mesh_force'][..., 1:]
    found = {
        'y1_rises': rms['pinion_ay'] > 0,
        'y2_rises': rms['gear_ay'] > 0,
        'most_in_x1': rms['pinion_ax'] > rms['pinion_ay'],
        'most_in_x2': rms['gear_ax'] > rms['gear_ay'],
        'first_rises': force[..., 0] > 0,
        'first_rises_most': (force[..., 0] > 0) & (force.argmax(axis=-1) == 0),
        'first_leads_x1': rows[1, ..., at['pinion_ax'], 1:].argmax(axis=-1) == 0,
        'first_leads_x2': rows[1, ..., at['gear_ax'], 1:].argmax(axis=-1) == 0,
    }
    found['all_directions'] = found['y1_rises'] & found['y2_rises']
    found['most_in_x'] = found['most_in_x1'] & found['most_in_x2']
    found['into_first'] = (
        found['first_rises_most'] & found['first_leads_x1'] & found['first_leads_x2']
    )
    found['all_claims'] = found['all_directions'] & found['most_in_x'] & found['into_first']
    return {name: found[name] for name in CLAIMS}
