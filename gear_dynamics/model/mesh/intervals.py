"""The mesh cycle: its zones, the tooth pairs in contact in each, and their flank profiles.

Tooth pair A is at s = phi' pb on the path of contact, where phi' is the mesh phase within the
cycle; pair B, one base pitch ahead, is at s = (1 + phi') pb while phi' < eps - 1. A zone is a part
of the cycle in which the same pairs are in contact on the same side of the pitch point.
"""

from __future__ import annotations

import numpy as np

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.parameter import ParameterError

ZONES = np.dtype(
    [
        ('begin', np.float64),
        ('end', np.float64),
        ('pairs', np.int64),
        ('sliding_a', np.float64),
        ('sliding_b', np.float64),
    ]
)
"""Mesh phase where the zone begins and ends, number of tooth pairs in contact, and lambda of
pairs A and B: +1 before the pitch point, -1 after it, 0 for a pair that is not in contact."""

DEGREE = 3
"""Greatest degree of a flank profile's polynomials in s."""

PROFILES = np.dtype(
    [
        ('pinion_tooth', np.int64),
        ('gear_tooth', np.int64),
        ('begin', np.float64),
        ('end', np.float64),
        ('stiffness', np.float64, (DEGREE + 1,)),
        ('damping', np.float64, (DEGREE + 1,)),
        ('error', np.float64, (DEGREE + 1,)),
    ]
)
"""A stretch of the path of contact on which the named teeth depart from the healthy pair.

pinion_tooth, gear_tooth: -1 stands for every tooth. begin, end: the stretch, s [m]. stiffness,
damping: change relative to the healthy pair (-0.2: a fifth less), error: flank error e_i [m], each
as polynomial coefficients in s, lowest first. Where stretches overlap, they add.
"""


def healthy() -> np.ndarray:
    """Return the profile table of a pair without faults: no rows."""
    return np.zeros(0, PROFILES)


def checked(profiles: np.ndarray) -> np.ndarray:
    """Return a table of profiles.

    Raises
    ------
    ParameterError
        If it is none, or has a number that is not finite or a stretch that ends before it begins.
    """
    if not isinstance(profiles, np.ndarray) or profiles.dtype != PROFILES or profiles.ndim != 1:
        kind = getattr(profiles, 'dtype', type(profiles).__name__)
        raise ParameterError(f'profiles is of {kind}: it must be a table of mesh.PROFILES')
    for row in profiles:
        for name in ('begin', 'end', 'stiffness', 'damping', 'error'):
            if not np.isfinite(row[name]).all():
                raise ParameterError(f'{name} of a profile is {row[name]}: it must be finite')
        if row['end'] <= row['begin']:
            raise ParameterError(
                f'a profile ends at s = {row["end"]:g} m: it must end after its begin, '
                f'{row["begin"]:g} m'
            )
    return profiles


def zones(pair: GearPair, profiles: np.ndarray | None = None) -> np.ndarray:
    """Return the zones of one mesh cycle, in order.

    The pitch point splits a zone only where there is friction to reverse; the ends of profiles
    split zones wherever they fall.
    """
    derived = pair.derived
    leaves = derived.contact_ratio - 1
    pitch_point = derived.approach_length / derived.base_pitch
    cuts = {leaves}
    if pair.friction_coefficient > 0:
        cuts |= {pitch_point, pitch_point - 1}
    for profile in healthy() if profiles is None else profiles:
        ends = (profile['begin'] / derived.base_pitch, profile['end'] / derived.base_pitch)
        cuts |= {end - ahead for end in ends for ahead in (0, 1)}
    inside = sorted(float(cut) for cut in cuts if 0 < cut < 1)
    edges = [0.0, *inside, 1.0]
    table = np.zeros(len(edges) - 1, ZONES)
    for zone, begin, end in zip(table, edges[:-1], edges[1:], strict=True):
        middle = (begin + end) / 2
        two = middle < leaves
        zone['begin'], zone['end'], zone['pairs'] = begin, end, 2 if two else 1
        zone['sliding_a'] = 1.0 if middle < pitch_point else -1.0
        zone['sliding_b'] = 0.0 if not two else 1.0 if middle < pitch_point - 1 else -1.0
    return table
