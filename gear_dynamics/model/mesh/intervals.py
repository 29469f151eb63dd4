"""The mesh cycle: its zones, and the tooth pairs in contact in each.

Tooth pair A is at s = phi' pb on the path of contact, where phi' is the mesh phase within the
cycle; pair B, one base pitch ahead, is at s = (1 + phi') pb while phi' < eps - 1. A zone is a part
of the cycle in which the same pairs are in contact on the same side of the pitch point.
"""

from __future__ import annotations

import numpy as np

from gear_dynamics.model.gear_pair import GearPair

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


def zones(pair: GearPair, reverses: bool | None = None) -> np.ndarray:
    """Return the zones of one mesh cycle, in order.

    Parameters
    ----------
    pair : GearPair
    reverses : bool, optional
        Whether there is friction, which reverses at the pitch point; by default, whether the pair's
        friction coefficient is positive. Without friction the pitch point splits no zone.
    """
    derived = pair.derived
    leaves = derived.contact_ratio - 1
    pitch_point = derived.approach_length / derived.base_pitch
    cuts = {leaves}
    if pair.friction_coefficient > 0 if reverses is None else reverses:
        cuts |= {pitch_point, pitch_point - 1}
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
