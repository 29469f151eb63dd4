"""The mesh over one step: force, friction and moment as linear forms in delta and delta'.

With x = delta, the force of tooth pair i is k_i (x - e_i - flank b) + c_i (x' - e_i'), its friction
flank lambda_i mu times that, and the moment on the pinion its friction times its arm. Summed over
the pairs each is stiffness(t) x + damping(t) x' + offset(t): three rows of a segment.
"""

from __future__ import annotations

from gear_dynamics.integrator.contact import GAP as IN_GAP
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    GAP,
    MU,
    PAIR_DAMPING,
    PAIR_ERROR,
    PAIR_FRICTION,
    PAIR_ROWS,
    PAIR_STIFFNESS,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SEGMENT,
    WIDTH,
)
from gear_dynamics.integrator.polynomial import add_product, add_scaled, differentiate
from gear_dynamics.integrator.signals import fill_signals
from gear_dynamics.integrator.tooth_pairs import look_up

_STIFFNESS, _DAMPING, _LIFT, _RATE, _FRICTION, _OFFSET, _RUBBED = range(7)
"""Rows of the scratch, of one tooth pair: k_i, c_i, e_i + flank b and its rate, flank lambda mu_i,
the offset of the force, and one of the three times flank lambda mu_i."""


@kernel
def _pair_forces(p, zone, contact):
    """Return stiffness and damping of each tooth pair in the zone, without deviations."""
    share = 1.0 if p.rectangular else 1.0 / zone.pairs
    stiffness = p.k * share if contact != IN_GAP else 0.0
    damping = p.c * share if contact != IN_GAP or p.damping_in_gap else 0.0
    return stiffness, damping


@kernel
def _fill_rows(segment, row, factor, stiffness, damping, offset):
    segment[row, 0] = factor * stiffness
    segment[row + 1, 0] = factor * damping
    segment[row + 2, 0] = factor * offset


@kernel
def fill_segment(motion, zones, ports):
    """Fill signals and segment of the step that begins now; return the segment's degree."""
    zone = zones[motion.phase.zone]
    motion.step.edge = zone.end
    if not motion.step.ported:
        return _fill_healthy(motion, zone)
    fill_signals(motion, ports)
    look_up(motion, ports, zone.pairs)
    return fill_mesh(motion, zone)


@kernel
def fill_mesh(motion, zone):
    """Fill the segment by the present contact states; return its degree.

    The signals and the deviations of the tooth pairs must be there.
    """
    contact, degrees = motion.contact, motion.degrees
    _clear(motion.segment, motion.step.degree)
    alike = zone.pairs == 1 or contact.state[0, 0] == contact.state[0, 1]
    deviates = contact.active[0, 0] or (zone.pairs == 2 and contact.active[0, 1])
    if not motion.step.ported or (alike and not deviates and degrees[MU] < 0):
        return _fill_healthy(motion, zone)
    degree = motion.step.stiffness_degree = 0
    for ahead in range(zone.pairs):
        degree = max(degree, _add_pair(motion, zone, ahead))
    return degree


@kernel
def _clear(segment, degree):
    """Set a segment to zero, which is so beyond its degree."""
    for row in range(SEGMENT):
        for j in range(degree + 1):
            segment[row, j] = 0.0


@kernel
def _fill_healthy(motion, zone):
    """Fill the segment with pairs that have the same delta_i, and so the same contact state."""
    p, segment, phase = motion.constants, motion.segment, motion.phase.phase
    motion.step.stiffness_degree = 0
    contact = motion.contact.state[0, 0]
    stiffness, damping = _pair_forces(p, zone, contact)
    offset = -stiffness * contact * p.b
    arm = p.arm1 + phase * p.pitch
    friction = p.mu * contact * (zone.sliding_a + zone.sliding_b)
    moment = p.mu * contact * (zone.sliding_a * arm + zone.sliding_b * (arm + p.pitch))
    _fill_rows(segment, SEG_FORCE, float(zone.pairs), stiffness, damping, offset)
    _fill_rows(segment, SEG_FRICTION, friction, stiffness, damping, offset)
    _fill_rows(segment, SEG_MOMENT, moment, stiffness, damping, offset)
    if not motion.step.ported or motion.degrees[GAP] < 0 or contact == IN_GAP:
        return 0
    forces = (float(zone.pairs), friction, moment)
    return _widen_gap(motion, contact * stiffness, contact * damping, forces)


@kernel
def _widen_gap(motion, stiffness, damping, forces):
    """Add what widens the half backlash to the offsets of pairs that are alike.

    forces : how many times the force of one pair is in F, Ff and the moment. Return the degree.
    """
    segment, wider, last = motion.segment, motion.signals[GAP], motion.degrees[GAP]
    degree = min(last, WIDTH - 1)
    for j in range(degree + 1):
        force = stiffness * wider[j]
        if j < last and not motion.constants.damping_in_gap:
            force += damping * ((j + 1) * wider[j + 1])
        segment[SEG_FORCE + 2, j] -= forces[0] * force
        segment[SEG_FRICTION + 2, j] -= forces[1] * force
        segment[SEG_MOMENT + 2, j] -= forces[2] * force
    return degree


@kernel
def _fill_pair(motion, zone, ahead):
    """Fill the scratch with the polynomials of one tooth pair; return their degrees."""
    p, degrees, signals, s = motion.constants, motion.degrees, motion.signals, motion.scratch
    flank = motion.contact.state[0, ahead]
    sliding = zone.sliding_a if ahead == 0 else zone.sliding_b
    stiffness, damping = _pair_forces(p, zone, flank)
    s[_STIFFNESS, 0], s[_DAMPING, 0] = stiffness, damping
    s[_LIFT, 0], s[_FRICTION, 0] = flank * p.b, flank * sliding * p.mu
    k = c = lift = mu = 0
    mu = add_scaled(s[_FRICTION], mu, signals[MU], degrees[MU], flank * sliding * 1.0, 0.0, WIDTH)
    if not p.damping_in_gap:
        lift = add_scaled(s[_LIFT], lift, signals[GAP], degrees[GAP], flank * 1.0, 0.0, WIDTH + 1)
    if motion.contact.active[0, ahead]:
        own, last = motion.pairs[ahead], motion.pair_degrees[ahead]
        k = add_scaled(
            s[_STIFFNESS], k, own[PAIR_STIFFNESS], last[PAIR_STIFFNESS], stiffness, 0.0, WIDTH
        )
        c = add_scaled(s[_DAMPING], c, own[PAIR_DAMPING], last[PAIR_DAMPING], damping, 0.0, WIDTH)
        rubs = flank * sliding * 1.0
        mu = add_scaled(s[_FRICTION], mu, own[PAIR_FRICTION], last[PAIR_FRICTION], rubs, 0.0, WIDTH)
        if motion.contact.flawed[0, ahead]:
            lift = add_scaled(
                s[_LIFT], lift, own[PAIR_ERROR], last[PAIR_ERROR], 1.0, 0.0, WIDTH + 1
            )
    rate = differentiate(s[_LIFT], lift, s[_RATE])
    if p.damping_in_gap:
        # The damper then knows nothing of the edges, and so nothing of their motion.
        lift = add_scaled(s[_LIFT], lift, signals[GAP], degrees[GAP], flank * 1.0, 0.0, WIDTH + 1)
    return k, c, lift, rate, mu


@kernel
def _constant(motion, ahead):
    """Return whether nothing of a tooth pair varies within the step."""
    degrees = motion.pair_degrees[ahead]
    varies = motion.degrees[GAP] >= 0 or motion.degrees[MU] >= 0
    if motion.contact.active[0, ahead]:
        for row in range(PAIR_ROWS):
            varies = varies or degrees[row] > 0
    return not varies


@kernel
def _add_constant_pair(motion, zone, ahead):
    """Add one tooth pair, of which nothing varies, to the segment."""
    p, segment = motion.constants, motion.segment
    flank = motion.contact.state[0, ahead]
    sliding = zone.sliding_a if ahead == 0 else zone.sliding_b
    stiffness, damping = _pair_forces(p, zone, flank)
    lift, friction = flank * p.b, flank * sliding * p.mu
    if motion.contact.active[0, ahead]:
        own = motion.pairs[ahead]
        stiffness += stiffness * own[PAIR_STIFFNESS, 0]
        damping += damping * own[PAIR_DAMPING, 0]
        friction += flank * sliding * own[PAIR_FRICTION, 0]
        if motion.contact.flawed[0, ahead]:
            lift += own[PAIR_ERROR, 0]
    offset = -stiffness * lift
    moment = friction * (p.arm1 + (motion.phase.phase + ahead) * p.pitch)
    for row, factor in ((SEG_FORCE, 1.0), (SEG_FRICTION, friction), (SEG_MOMENT, moment)):
        segment[row, 0] += factor * stiffness
        segment[row + 1, 0] += factor * damping
        segment[row + 2, 0] += factor * offset


@kernel
def _add_pair(motion, zone, ahead):
    """Add one tooth pair to the segment; return the degree of what it adds."""
    p, segment, s, step = motion.constants, motion.segment, motion.scratch, motion.step
    if _constant(motion, ahead):
        _add_constant_pair(motion, zone, ahead)
        return 0
    k, c, lift, rate, mu = _fill_pair(motion, zone, ahead)
    offset = add_product(s[_OFFSET], -1, s[_STIFFNESS], k, s[_LIFT], lift, -1.0, WIDTH)
    offset = add_product(s[_OFFSET], offset, s[_DAMPING], c, s[_RATE], rate, -1.0, WIDTH)
    arm = p.arm1 + (motion.phase.phase + ahead) * p.pitch
    rubs = mu > 0 or s[_FRICTION, 0] != 0.0
    degree = 0
    for row in range(3):
        source = _STIFFNESS if row == 0 else _DAMPING if row == 1 else _OFFSET
        size = k if row == 0 else c if row == 1 else offset
        for j in range(size + 1):
            segment[SEG_FORCE + row, j] += s[source, j]
        if rubs and mu == 0:
            for j in range(size + 1):
                rubbed = s[_FRICTION, 0] * s[source, j]
                segment[SEG_FRICTION + row, j] += rubbed
                segment[SEG_MOMENT + row, j] += arm * rubbed
        elif rubs:
            last = add_product(s[_RUBBED], -1, s[_FRICTION], mu, s[source], size, 1.0, WIDTH)
            for j in range(last + 1):
                segment[SEG_FRICTION + row, j] += s[_RUBBED, j]
                segment[SEG_MOMENT + row, j] += arm * s[_RUBBED, j]
            size = max(size, last)
        degree = max(degree, size)
        if source != _OFFSET:
            step.stiffness_degree = max(step.stiffness_degree, size)
    return degree
