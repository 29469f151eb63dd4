"""Contact states of the tooth pairs over a step, and the events at which they change."""

from __future__ import annotations

import math

from gear_dynamics.integrator.contact import (
    DRIVE,
    contact_state,
    first_change,
    flank_in_contact,
)
from gear_dynamics.integrator.contact import GAP as IN_GAP
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import DELTA, GAP, PAIR_ERROR, ROWS
from gear_dynamics.integrator.phase import phase_at
from gear_dynamics.integrator.polynomials import delta_stays_above
from gear_dynamics.integrator.series import apart, polynomial, value_and_slope
from gear_dynamics.machine.columns import EventKind

# Why a step ends: the step control, the mesh or a knot, a command, contact that changes within it,
# and contact that is found changed where it begins.
CONTROL, MESH, COMMAND, CONTACT, ENTRY = range(5)

_DRIVE_LOST, _DRIVE_REGAINED = int(EventKind.DRIVE_LOST), int(EventKind.DRIVE_REGAINED)
_BACK_LOST, _BACK_REGAINED = int(EventKind.BACK_LOST), int(EventKind.BACK_REGAINED)
_HIGH, _LOW = 1, 2


@kernel
def emit(motion, tau, kind, pair, delta, delta_dot, phase):
    """Write an event at tau [s] into the step."""
    sampling, counts = motion.sampling, motion.counts
    row = motion.events[counts.events]
    row.t = sampling.origin / sampling.sample_rate + (motion.step.begin + tau)
    row.kind = kind
    row.tooth_pair = pair
    row.delta = delta
    row.delta_dot = delta_dot
    row.cycle = motion.phase.cycle + phase
    counts.events += 1


@kernel
def _flank_event(before, after):
    """Return the `EventKind` of a change of contact state."""
    if after == IN_GAP:
        return _DRIVE_LOST if before == DRIVE else _BACK_LOST
    return _DRIVE_REGAINED if after == DRIVE else _BACK_REGAINED


@kernel
def _holds(contact, pairs):
    """Return whether any tooth pair is in contact."""
    return contact.state[0, 0] != IN_GAP or (pairs == 2 and contact.state[0, 1] != IN_GAP)


@kernel
def change_contact(motion, zone):
    """Give the pairs the contact states after the step, with an event for each that changed."""
    contact, step, counts = motion.contact, motion.step, motion.counts
    held = _holds(contact, zone.pairs)
    impact = False
    phase = phase_at(motion, step.begin + step.length)
    for ahead in range(zone.pairs):
        before, after = contact.state[0, ahead], contact.after[0, ahead]
        if before == after:
            continue
        kind = _flank_event(before, after)
        impact = impact or kind == _BACK_REGAINED
        delta, delta_dot = value_and_slope(motion, DELTA, step.length)
        if contact.flawed[0, ahead]:
            error, error_dot = polynomial(motion.pairs[ahead], PAIR_ERROR, step.length)
            delta, delta_dot = delta - error, delta_dot - error_dot
        pair = (motion.phase.cycle - ahead) % motion.constants.hunting
        emit(motion, step.length, kind, pair, delta, delta_dot, phase)
    contact.state[0, 0], contact.state[0, 1] = contact.after[0, 0], contact.after[0, 1]
    if held and not _holds(contact, zone.pairs):
        counts.contact_losses += 1
    if impact:
        counts.back_flank_impacts += 1


@kernel
def _fill_held(motion, ahead):
    """Fill what a pair holds against b and -b; return the rows of `error` that have them."""
    held = motion.error
    for k in range(ROWS):
        held[_HIGH, k] = motion.series[k, DELTA]
    if motion.contact.flawed[0, ahead]:
        for k in range(motion.pair_degrees[ahead, PAIR_ERROR] + 1):
            held[_HIGH, k] -= motion.pairs[ahead, PAIR_ERROR, k]
    if not motion.step.ported or motion.degrees[GAP] < 0:
        return _HIGH, _HIGH
    for k in range(ROWS):
        wider = motion.signals[GAP, k] if k <= motion.degrees[GAP] else 0.0
        held[_LOW, k] = held[_HIGH, k] + wider
        held[_HIGH, k] -= wider
    return _HIGH, _LOW


@kernel
def _upper_bound(terms, degree, h):
    """Return a bound from above of a polynomial from time 0 to h."""
    varying = 0.0
    for k in range(degree, 0, -1):
        varying = (varying + abs(terms[k])) * h
    return terms[0] + varying


@kernel
def _highest_lift(motion, ahead):
    """Return a bound, over the step, of what flank error and backlash add to the drive edge."""
    lift, h = 0.0, motion.step.length
    if motion.contact.flawed[0, ahead]:
        degree = motion.pair_degrees[ahead, PAIR_ERROR]
        lift += _upper_bound(motion.pairs[ahead, PAIR_ERROR], degree, h)
    if motion.degrees[GAP] >= 0:
        lift += _upper_bound(motion.signals[GAP], motion.degrees[GAP], h)
    return lift


@kernel
def _pair_change(motion, ahead, entered):
    """Return when the contact of pair A (ahead 0) or B (ahead 1) changes, and its next state."""
    b, held, state = motion.constants.b, motion.error, motion.contact.state[0, ahead]
    length = motion.step.length
    if state == DRIVE and motion.step.ported:
        # Most steps stay above the edge at its highest, and need no look at how it moves.
        highest = b + _highest_lift(motion, ahead)
        if delta_stays_above(motion.series, length, highest):
            return math.inf, state
    high, low = _fill_held(motion, ahead)
    if entered:
        found = flank_in_contact(held[high, 0], held[high, 1], held[low, 0], held[low, 1], b)
        if found != state:
            return -1.0, found
    return first_change(held, high, low, length, state, b, motion.parts)


@kernel
def find_contact_change(motion, zone, entered):
    """Cut the present step at the first change of contact.

    entered : whether what is held against the edges may have jumped where the step begins.
    """
    contact, step = motion.contact, motion.step
    a, b = contact.state[0, 0], contact.state[0, 1]
    contact.after[0, 0], contact.after[0, 1] = a, b
    plain = not step.ported or motion.degrees[GAP] < 0
    if step.ported and zone.pairs == 2:
        alike = a == b and not contact.flawed[0, 0] and not contact.flawed[0, 1]
    else:
        alike = not step.ported or zone.pairs == 1
    simple = alike and plain and not contact.flawed[0, 0] and not entered
    if simple and a == DRIVE and delta_stays_above(motion.series, step.length, motion.constants.b):
        return
    if not alike and a == b == DRIVE and not entered:
        # One look for both pairs, at the higher of their edges.
        lift = max(_highest_lift(motion, 0), _highest_lift(motion, 1))
        if delta_stays_above(motion.series, step.length, motion.constants.b + lift):
            return
    t_a, next_a = _pair_change(motion, 0, entered)
    t_b, next_b = t_a, next_a
    if not alike or zone.pairs == 1:
        t_b = math.inf
        if zone.pairs == 2:
            t_b, next_b = _pair_change(motion, 1, entered)
    first = min(t_a, t_b)
    if first == math.inf:
        return
    step.length, step.ending = max(first, 0.0), ENTRY if first < 0 else CONTACT
    motion.counts.rejected_steps += 1
    if t_a == first:
        contact.after[0, 0] = next_a
    if t_b == first:
        contact.after[0, 1] = next_b


@kernel
def settle_new_pair(motion):
    """Give pair A, which is new here, the contact state that it begins in: no change of contact."""
    delta, slope = apart(motion.state, motion.error)
    if motion.contact.flawed[0, 0]:
        delta -= motion.pairs[0, PAIR_ERROR, 0]
        slope -= motion.pairs[0, PAIR_ERROR, 1]
    wider = wider_rate = 0.0
    if motion.degrees[GAP] >= 0:
        wider = motion.signals[GAP, 0]
        wider_rate = motion.signals[GAP, 1] if motion.degrees[GAP] > 0 else 0.0
    motion.contact.state[0, 0] = flank_in_contact(
        delta - wider, slope - wider_rate, delta + wider, slope + wider_rate, motion.constants.b
    )


@kernel
def place_contact(motion):
    """Set the contact states that belong to the present state, all pairs alike."""
    delta, slope = apart(motion.state, motion.error)
    state = contact_state(delta, slope, motion.constants.b)
    motion.contact.state[0, 0] = motion.contact.state[0, 1] = state
