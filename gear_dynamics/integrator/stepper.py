"""The stepper: Taylor steps that end exactly at events, and samples off their dense output."""

from __future__ import annotations

import math

from gear_dynamics.integrator.contact import (
    DRIVE,
    GAP,
    MOST_RADIANS,
    contact_state,
    first_change,
)
from gear_dynamics.integrator.jumps import note_before, note_jump
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import DELTA, ROWS, SEG_ERROR, WIDTH
from gear_dynamics.integrator.output import time_of_sample, write_due_samples
from gear_dynamics.integrator.polynomials import delta_stays_above
from gear_dynamics.integrator.segment import fill_segment
from gear_dynamics.integrator.series import (
    advance_state,
    expand,
    expand_error,
    polynomial,
    step_size,
    value_and_slope,
)

# Why a step ends.
CONTROL, MESH, COMMAND, CONTACT = 0, 1, 2, 3

# What `run` returns.
DONE, EVENTS_FULL, STUCK, NOT_FINITE = 0, 1, 2, 3

LONGEST_STEP = 0.05
"""The longest step [s]; only a soft pair at rest comes near it."""

SHORTEST_STEP = 1e-10
"""The shortest step [s] that the motion itself may ask for: at 1e10 steps a second of model time
would take hours, so that the parameters must be wrong. Events may cut a step shorter."""

_TINY = 1e-9
MANY_TINY_STEPS = 10000
_EVENTS_PER_STEP = 4


@kernel
def _phase_at(p, clock, t):
    """Return the mesh phase at time t in cycles since the beginning of the present cycle."""
    since = t - clock.anchor
    turned = since * (clock.anchor_speed + 0.5 * clock.accel * since)
    return clock.anchor_phase - (clock.cycle - clock.anchor_cycle) + p.z1 / (2 * math.pi) * turned


@kernel
def time_of_phase(p, clock, phase):
    """Return when the mesh phase (in the present cycle) is reached, or inf if it never is."""
    ahead = phase + (clock.cycle - clock.anchor_cycle) - clock.anchor_phase
    turn = 2 * math.pi / p.z1 * ahead
    root = clock.anchor_speed**2 + 2 * clock.accel * turn
    speed = clock.anchor_speed + math.sqrt(max(root, 0.0))
    if root < 0 or speed <= 0:
        # A pair that has come to a stop there, or just beyond, passes it as soon as it starts.
        return clock.anchor if ahead <= 0 and clock.accel > 0 else math.inf
    return clock.anchor + 2 * turn / speed


@kernel
def _set_anchor(clock):
    clock.anchor, clock.anchor_phase = clock.begin, clock.phase
    clock.anchor_cycle, clock.anchor_speed = clock.cycle, clock.speed


@kernel
def _move_origin(clock):
    """Count time from a later sample, so that it keeps its precision."""
    whole = math.floor(clock.begin * clock.sample_rate)
    shift = whole / clock.sample_rate
    clock.origin += int(whole)
    clock.begin -= shift
    clock.speed_reached -= shift
    clock.torque_reached -= shift
    _set_anchor(clock)


@kernel
def _emit(motion, tau, kind, pair, delta, delta_dot, phase):
    clock = motion.clock
    row = motion.events[clock.events]
    row.t = clock.origin / clock.sample_rate + (clock.begin + tau)
    row.kind = kind
    row.tooth_pair = pair
    row.delta = delta
    row.delta_dot = delta_dot
    row.cycle = clock.cycle + phase
    clock.events += 1


@kernel
def _pass_section(motion, until, wraps):
    """Emit the section state if the section phase is passed before `until` [s into the step]."""
    p, clock = motion.constants, motion.clock
    if clock.section_cycle > clock.cycle:
        return
    tau = time_of_phase(p, clock, clock.section_phase) - clock.begin
    if tau < until or wraps:
        tau = min(max(tau, 0.0), until)
        delta, delta_dot = value_and_slope(motion, DELTA, tau)
        pair = clock.cycle % p.hunting
        _emit(motion, tau, 0, pair, delta, delta_dot, clock.section_phase)
        clock.section_cycle = clock.cycle + 1


@kernel
def _flank_event(before, after):
    """Return the `EventKind` of a change of contact state."""
    if after == GAP:
        return 1 if before > 0 else 3
    return 2 if after > 0 else 4


@kernel
def _change_contact(motion, zone):
    """Give the pairs the contact states after the step, with an event for each that changed."""
    p, clock = motion.constants, motion.clock
    held = clock.contact_a != GAP or (zone.pairs == 2 and clock.contact_b != GAP)
    impact = False
    phase = _phase_at(p, clock, clock.begin + clock.length)
    for ahead in range(zone.pairs):
        before = clock.contact_a if ahead == 0 else clock.contact_b
        after = clock.next_a if ahead == 0 else clock.next_b
        if before == after:
            continue
        kind = _flank_event(before, after)
        impact = impact or kind == 4
        delta, delta_dot = value_and_slope(motion, DELTA, clock.length)
        error, error_dot = polynomial(motion.segment, SEG_ERROR + ahead, clock.length)
        pair = (clock.cycle - ahead) % p.hunting
        _emit(motion, clock.length, kind, pair, delta - error, delta_dot - error_dot, phase)
    clock.contact_a, clock.contact_b = clock.next_a, clock.next_b
    holds = clock.contact_a != GAP or (zone.pairs == 2 and clock.contact_b != GAP)
    if held and not holds:
        clock.contact_losses += 1
    if impact:
        clock.back_flank_impacts += 1


@kernel
def _enter_zone(p, clock, zones, profiles):
    """Go on to the next zone of the mesh, where another tooth pair may enter.

    Return whether flank errors may jump there, and contact states with them.
    """
    clock.zone += 1
    if clock.zone == zones.size:
        clock.zone = 0
        clock.cycle += 1
        clock.tooth1, clock.tooth2 = clock.cycle % int(p.z1), clock.cycle % int(p.z2)
        clock.contact_b = clock.contact_a
    clock.phase = zones[clock.zone].begin
    return profiles.size > 0


@kernel
def end_step(motion, zones, profiles):
    """Put the state at the end of the present step, and do what happens there.

    Return whether flank errors may have jumped.
    """
    p, clock = motion.constants, motion.clock
    clock.steps += 1
    wraps = clock.ending == MESH and clock.zone == zones.size - 1
    _pass_section(motion, clock.length, wraps)
    advance_state(motion, clock.length)
    if clock.ending == CONTACT:
        _change_contact(motion, zones[clock.zone])
    end = clock.begin + clock.length
    clock.phase = _phase_at(p, clock, end)
    clock.speed = clock.anchor_speed + clock.accel * (end - clock.anchor)
    clock.torque += clock.torque_rate * clock.length
    clock.begin = end
    enters = False
    if clock.ending == MESH:
        enters = _enter_zone(p, clock, zones, profiles)
    elif clock.ending == COMMAND:
        if end >= clock.speed_reached:
            clock.speed, clock.accel = clock.speed_target, 0.0
            clock.speed_reached = math.inf
            _set_anchor(clock)
        if end >= clock.torque_reached:
            clock.torque, clock.torque_rate = clock.torque_target, 0.0
            clock.torque_reached = math.inf
    return enters


@kernel
def _pair_change(motion, profiles, ahead, state, entered):
    """Return when the contact of pair A (ahead 0) or B (ahead 1) changes, and its next state."""
    b, error, row = motion.constants.b, motion.error, 1 + ahead
    for k in range(ROWS):
        error[row, k] = motion.series[k, DELTA]
    if profiles.size > 0:
        for k in range(WIDTH):
            error[row, k] -= motion.segment[SEG_ERROR + ahead, k]
    if entered:
        jumped = contact_state(error[row, 0], error[row, 1], b)
        if jumped != state:
            return 0.0, jumped
    return first_change(error, row, motion.clock.length, state, b, motion.parts)


@kernel
def _find_contact_change(motion, zone, profiles, entered):
    """Cut the present step at the first change of contact."""
    clock = motion.clock
    a, b = clock.contact_a, clock.contact_b
    clock.next_a, clock.next_b = a, b
    b_half, alone = motion.constants.b, profiles.size == 0
    if alone and a == DRIVE and delta_stays_above(motion.series, clock.length, b_half):
        return
    t_a, next_a = _pair_change(motion, profiles, 0, a, entered)
    t_b, next_b = t_a, next_a
    if profiles.size > 0:
        t_b = math.inf
        if zone.pairs == 2:
            t_b, next_b = _pair_change(motion, profiles, 1, b, entered)
    first = min(t_a, t_b)
    if first == math.inf:
        return
    clock.length, clock.ending = first, CONTACT
    clock.rejected_steps += 1
    if t_a == first:
        clock.next_a = next_a
    if t_b == first:
        clock.next_b = next_b


@kernel
def _choose_length(motion, zone):
    """Set how far the present step goes, and why it ends there."""
    p, clock = motion.constants, motion.clock
    longest = min(LONGEST_STEP, MOST_RADIANS / p.fastest)
    clock.length, clock.ending = min(step_size(motion), longest), CONTROL
    to_mesh = max(time_of_phase(p, clock, zone.end) - clock.begin, 0.0)
    if to_mesh <= clock.length:
        clock.length, clock.ending = to_mesh, MESH
    to_command = min(clock.speed_reached, clock.torque_reached) - clock.begin
    if to_command < clock.length:
        clock.length, clock.ending = max(to_command, 0.0), COMMAND


@kernel
def _settle_new_pair(motion):
    """Give pair A, which is new here, the contact state that it begins in: no change of contact."""
    y, error, segment = motion.state, motion.error, motion.segment
    delta = y[3] - y[1] + y[4] - error[0, 0] - segment[SEG_ERROR, 0]
    slope = y[9] - y[7] + y[10] - error[0, 1] - segment[SEG_ERROR, 1]
    motion.clock.contact_a = contact_state(delta, slope, motion.constants.b)


@kernel
def begin_step(motion, zones, profiles, entered):
    """Expand the motion about the present state and choose the step.

    entered : whether flank errors may have jumped there.
    """
    p, clock = motion.constants, motion.clock
    if clock.begin > 1.0:
        _move_origin(clock)
    zone = zones[clock.zone]
    clock.degree = fill_segment(motion, zone, profiles)
    expand_error(motion)
    if entered and profiles.size > 0 and clock.phase == 0.0:
        _settle_new_pair(motion)
        clock.degree = fill_segment(motion, zone, profiles)
    expand(motion)
    clock.rated = 0
    _choose_length(motion, zone)
    too_fast = clock.ending == CONTROL and clock.length < SHORTEST_STEP
    _find_contact_change(motion, zone, profiles, entered)
    if too_fast:
        clock.tiny_steps = MANY_TINY_STEPS
    elif clock.length < _TINY / p.wn:
        clock.tiny_steps += 1
    else:
        clock.tiny_steps = 0
    if clock.length > 0:
        clock.smallest_step = min(clock.smallest_step, clock.length)


@kernel
def run(motion, zones, profiles, jumps):
    """Step until the present step spans the instant of the next sample.

    jumps : (m, ROWS_OF_JUMP, HIGH_RATE_COLUMNS) array
        Filled with the jumps at events; none are looked for if m is 0.

    Returns DONE, EVENTS_FULL (empty events and jumps and call again), STUCK or NOT_FINITE.
    """
    clock = motion.clock
    entered = clock.unsettled != 0
    clock.unsettled = 0
    while True:
        if clock.length < 0:
            begin_step(motion, zones, profiles, entered)
            stuck = clock.tiny_steps >= MANY_TINY_STEPS
            if stuck or not math.isfinite(motion.series[2, DELTA] + clock.length):
                # Nothing of this step counts, so that the next call ends here too.
                clock.length = -1.0
                return STUCK if stuck else NOT_FINITE
            if clock.jumped:
                note_jump(motion, jumps)
        if time_of_sample(clock, clock.sample) < clock.begin + clock.length:
            return DONE
        if clock.events > motion.events.size - _EVENTS_PER_STEP:
            return EVENTS_FULL
        if jumps.shape[0] > 0 and (clock.ending == MESH or clock.ending == CONTACT):
            if clock.jumps == jumps.shape[0]:
                return EVENTS_FULL
            note_before(motion)
        entered = end_step(motion, zones, profiles)
        clock.length = -1.0


@kernel
def pass_section_before_sample(motion):
    """Emit the section state that the present step has before the next sample.

    `run` must have reached that sample.
    """
    clock = motion.clock
    _pass_section(motion, max(time_of_sample(clock, clock.sample) - clock.begin, 0.0), False)


@kernel
def interrupt(motion):
    """End the present step at the instant of the next sample, so that commands may change there.

    `run` must have reached that sample, and the section before it have been passed.
    """
    p, clock = motion.constants, motion.clock
    tau = max(time_of_sample(clock, clock.sample) - clock.begin, 0.0)
    advance_state(motion, tau)
    end = clock.begin + tau
    clock.phase = _phase_at(p, clock, end)
    clock.speed = clock.anchor_speed + clock.accel * (end - clock.anchor)
    clock.torque += clock.torque_rate * tau
    clock.begin = end
    clock.length = -1.0
    _set_anchor(clock)


@kernel
def fill_samples(motion, zones, profiles, jumps, whole_every, out):
    """Fill the rows of `out` with the next samples; return their number and a status.

    jumps : as in `run`
    whole_every : int
        Time, angles and load torque are wanted only of every so many samples, a power of two.
    out : (n, 13 or more) array
        Columns in the order of SAMPLE_COLUMNS.
    """
    clock = motion.clock
    i = 0
    while i < out.shape[0]:
        if clock.length < 0 or time_of_sample(clock, clock.sample) >= clock.begin + clock.length:
            status = run(motion, zones, profiles, jumps)
            if status != DONE:
                return i, status
        i += write_due_samples(motion, whole_every, out, i)
    return i, DONE
