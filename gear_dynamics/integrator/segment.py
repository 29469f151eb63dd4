"""The mesh over one step: force, friction and moment as linear forms in delta and delta'.

With x = delta, the force of tooth pair i is k_i (x - e_i - flank b) + c_i (x' - e_i'), its friction
flank lambda_i mu times that, and the moment on the pinion its friction times its arm. Summed over
the pairs each is stiffness(t) x + damping(t) x' + offset(t): three rows of a segment.
"""

from __future__ import annotations

from gear_dynamics.integrator.contact import GAP
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SEG_PAIR,
    WIDTH,
)
from gear_dynamics.integrator.profile import fill_profiled_pair, has_profile


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
def _pair_forces(p, zone, contact):
    """Return stiffness and damping of each tooth pair in the zone."""
    share = 1.0 if p.rectangular else 1.0 / zone.pairs
    stiffness = p.k * share if contact != GAP else 0.0
    damping = p.c * share if contact != GAP or p.damping_in_gap else 0.0
    return stiffness, damping


@kernel
def _fill_rows(segment, row, factor, stiffness, damping, offset):
    segment[row, 0] = factor * stiffness
    segment[row + 1, 0] = factor * damping
    segment[row + 2, 0] = factor * offset


@kernel
def fill_segment(motion, zone, profiles):
    """Fill the segment of the step that begins now; return the degree of its polynomials."""
    if profiles.size > 0:
        return _fill_profiled(motion, zone, profiles)
    # Healthy pairs have the same delta_i, and so the same contact state.
    p, clock, segment = motion.constants, motion.clock, motion.segment
    contact = clock.contact_a
    stiffness, damping = _pair_forces(p, zone, contact)
    offset = -stiffness * contact * p.b
    arm = p.arm1 + clock.phase * p.pitch
    friction = p.mu * contact * (zone.sliding_a + zone.sliding_b)
    moment = p.mu * contact * (zone.sliding_a * arm + zone.sliding_b * (arm + p.pitch))
    _fill_rows(segment, SEG_FORCE, float(zone.pairs), stiffness, damping, offset)
    _fill_rows(segment, SEG_FRICTION, friction, stiffness, damping, offset)
    _fill_rows(segment, SEG_MOMENT, moment, stiffness, damping, offset)
    return 0


@kernel
def _fill_profiled(motion, zone, profiles):
    """Fill the segment with pairs that have profiles, each with a contact state of its own."""
    p, clock, segment = motion.constants, motion.clock, motion.segment
    degree = 0
    segment[:] = 0.0
    for ahead in range(zone.pairs):
        contact = clock.contact_a if ahead == 0 else clock.contact_b
        sliding = zone.sliding_a if ahead == 0 else zone.sliding_b
        stiffness, damping = _pair_forces(p, zone, contact)
        friction = p.mu * sliding * contact
        moment = friction * (p.arm1 + (clock.phase + ahead) * p.pitch)
        segment[SEG_PAIR:] = 0.0
        if has_profile(p, clock, zone, profiles, ahead):
            degree = WIDTH - 1
        fill_profiled_pair(motion, zone, profiles, ahead, stiffness, damping, contact)
        _add_pair(segment, friction, moment)
    return degree
