"""The mesh over one step: force, friction and moment as linear forms in delta and delta'.

With x = delta, the force of tooth pair i is k_i (x - e_i - flank b) + c_i (x' - e_i'), its friction
flank lambda_i mu times that, and the moment on the pinion its friction times its arm. Summed over
the pairs each is stiffness(t) x + damping(t) x' + offset(t): three rows of a segment.
"""

from __future__ import annotations

from gear_dynamics.model.contact import GAP
from gear_dynamics.model.kernel import kernel
from gear_dynamics.model.layout import (
    SEG_ERROR,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SEG_PAIR,
    WIDTH,
)
from gear_dynamics.model.profile import fill_profiled_pair, has_profile


@kernel
def _add_pair(segment, friction, moment):
    """Add the rows of the pair's own stiffness, damping and offset to the sums."""
    for j in range(WIDTH):
        for row in range(3):
            value = segment[SEG_PAIR + row, j]
            segment[SEG_FORCE + row, j] += value
            segment[SEG_FRICTION + row, j] += friction * value
            segment[SEG_MOMENT + row, j] += moment * value


@kernel
def fill_segment(p, clock, zone, profiles, segment):
    """Fill `segment` for the step that begins now; return the degree of its polynomials."""
    degree = 0
    for row in range(SEG_ERROR):
        segment[row, 0] = 0.0
    for ahead in range(zone.pairs):
        contact = clock.contact_a if ahead == 0 else clock.contact_b
        sliding = zone.sliding_a if ahead == 0 else zone.sliding_b
        share = 1.0 if p.rectangular else 1.0 / zone.pairs
        stiffness = p.k * share if contact != GAP else 0.0
        damping = p.c * share if contact != GAP or p.damping_in_gap else 0.0
        friction = p.mu * sliding * contact
        moment = friction * (p.arm1 + (clock.phase + ahead) * p.pitch)
        if profiles.size > 0:
            first = 0 if ahead == 0 else SEG_PAIR
            segment[first:] = 0.0
            if has_profile(p, clock, zone, profiles, ahead):
                degree = WIDTH - 1
            fill_profiled_pair(
                p, clock, zone, profiles, ahead, stiffness, damping, contact, segment
            )
            _add_pair(segment, friction, moment)
        else:
            offset = -stiffness * contact * p.b
            segment[0, 0] += stiffness
            segment[1, 0] += damping
            segment[2, 0] += offset
            segment[3, 0] += friction * stiffness
            segment[4, 0] += friction * damping
            segment[5, 0] += friction * offset
            segment[6, 0] += moment * stiffness
            segment[7, 0] += moment * damping
            segment[8, 0] += moment * offset
    return degree
