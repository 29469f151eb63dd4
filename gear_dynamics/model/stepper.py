"""The stepper: Taylor steps that end exactly at events, and samples off their dense output."""

from __future__ import annotations

import math

from gear_dynamics.model.contact import GAP, MOST_RADIANS, contact_state, first_change
from gear_dynamics.model.jumps import note_before, note_jump
from gear_dynamics.model.kernel import kernel
from gear_dynamics.model.layout import DELTA, ROWS, SEG_ERROR, WIDTH
from gear_dynamics.model.output import time_of_sample, write_samples
from gear_dynamics.model.segment import fill_segment
from gear_dynamics.model.series import (
    advance_state,
    expand,
    polynomial,
    step_size,
    transmission_error,
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
    if root < 0:
        return math.inf
    speed = clock.anchor_speed + math.sqrt(root)
    if speed <= 0:
        return math.inf
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
def _emit(clock, events, tau, kind, pair, delta, delta_dot, phase):
    row = events[clock.events]
    row.t = clock.origin / clock.sample_rate + (clock.begin + tau)
    row.kind = kind
    row.tooth_pair = pair
    row.delta = delta
    row.delta_dot = delta_dot
    row.cycle = clock.cycle + phase
    clock.events += 1


@kernel
def _pass_section(p, clock, series, until, wraps, events):
    """Emit the section state if the section phase is passed before `until` [s into the step]."""
    if clock.section_cycle > clock.cycle:
        return
    tau = time_of_phase(p, clock, clock.section_phase) - clock.begin
    if tau < until or wraps:
        tau = min(max(tau, 0.0), until)
        delta, delta_dot = value_and_slope(series, DELTA, tau)
        pair = clock.cycle % p.hunting
        _emit(clock, events, tau, 0, pair, delta, delta_dot, clock.section_phase)
        clock.section_cycle = clock.cycle + 1


@kernel
def _flank_event(before, after):
    """Return the `EventKind` of a change of contact state."""
    if after == GAP:
        return 1 if before > 0 else 3
    return 2 if after > 0 else 4


@kernel
def _change_contact(p, clock, zone, series, segment, events):
    """Give the pairs the contact states after the step, with an event for each that changed."""
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
        delta, delta_dot = value_and_slope(series, DELTA, clock.length)
        error, error_dot = polynomial(segment, SEG_ERROR + ahead, clock.length)
        pair = (clock.cycle - ahead) % p.hunting
        _emit(clock, events, clock.length, kind, pair, delta - error, delta_dot - error_dot, phase)
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
        clock.contact_b = clock.contact_a
    clock.phase = zones[clock.zone].begin
    return profiles.size > 0


@kernel
def end_step(p, clock, zones, profiles, y, series, segment, point, events):
    """Put the state at the end of the present step, and do what happens there."""
    clock.steps += 1
    wraps = clock.ending == MESH and clock.zone == zones.size - 1
    _pass_section(p, clock, series, clock.length, wraps, events)
    advance_state(series, clock.length, y, point)
    if clock.ending == CONTACT:
        _change_contact(p, clock, zones[clock.zone], series, segment, events)
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
def _pair_change(clock, profiles, series, error, segment, ahead, state, b, work, entered):
    """Return when the contact of pair A (ahead 0) or B (ahead 1) changes, and its next state."""
    row = 1 + ahead
    for k in range(ROWS):
        error[row, k] = series[k, DELTA]
    if profiles.size > 0:
        for k in range(WIDTH):
            error[row, k] -= segment[SEG_ERROR + ahead, k]
    if entered:
        jumped = contact_state(error[row, 0], error[row, 1], b)
        if jumped != state:
            return 0.0, jumped
    return first_change(error, row, clock.length, state, b, work)


@kernel
def _find_contact_change(p, clock, zone, profiles, series, error, segment, work, entered):
    """Cut the present step at the first change of contact."""
    a, b = clock.contact_a, clock.contact_b
    clock.next_a, clock.next_b = a, b
    t_a, next_a = _pair_change(clock, profiles, series, error, segment, 0, a, p.b, work, entered)
    t_b, next_b = t_a, next_a
    if profiles.size > 0:
        t_b = math.inf
        if zone.pairs == 2:
            t_b, next_b = _pair_change(
                clock, profiles, series, error, segment, 1, b, p.b, work, entered
            )
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
def _choose_length(p, clock, zones, series, y):
    """Set how far the present step goes, and why it ends there."""
    longest = min(LONGEST_STEP, MOST_RADIANS / p.fastest)
    clock.length, clock.ending = min(step_size(p, series, y), longest), CONTROL
    to_mesh = max(time_of_phase(p, clock, zones[clock.zone].end) - clock.begin, 0.0)
    if to_mesh <= clock.length:
        clock.length, clock.ending = to_mesh, MESH
    to_command = min(clock.speed_reached, clock.torque_reached) - clock.begin
    if to_command < clock.length:
        clock.length, clock.ending = max(to_command, 0.0), COMMAND


@kernel
def begin_step(p, clock, zones, profiles, y, series, error, segment, work, entered):
    """Expand the motion about the present state and choose the step."""
    if clock.begin > 1.0:
        _move_origin(clock)
    zone = zones[clock.zone]
    clock.degree = fill_segment(p, clock, zone, profiles, segment)
    transmission_error(p, clock.phase, clock.speed, clock.accel, error)
    if entered and profiles.size > 0 and clock.phase == 0.0:
        # Pair A is new: the state that it begins in is no change of contact.
        delta = y[3] - y[1] + y[4] - error[0, 0] - segment[SEG_ERROR, 0]
        slope = y[9] - y[7] + y[10] - error[0, 1] - segment[SEG_ERROR, 1]
        clock.contact_a = contact_state(delta, slope, p.b)
        clock.degree = fill_segment(p, clock, zone, profiles, segment)
    turn = p.pitch * p.z1 / (2 * math.pi)
    clock.travel = turn * clock.speed
    ratio_inertia = p.ratio * p.inertia2
    expand(
        p,
        y,
        error,
        segment,
        clock.degree,
        clock.travel,
        0.5 * turn * clock.accel,
        clock.torque + ratio_inertia * clock.accel,
        clock.torque_rate,
        series,
    )
    _choose_length(p, clock, zones, series, y)
    too_fast = clock.ending == CONTROL and clock.length < SHORTEST_STEP
    _find_contact_change(p, clock, zone, profiles, series, error, segment, work, entered)
    if too_fast:
        clock.tiny_steps = MANY_TINY_STEPS
    elif clock.length < _TINY / p.wn:
        clock.tiny_steps += 1
    else:
        clock.tiny_steps = 0
    if clock.length > 0:
        clock.smallest_step = min(clock.smallest_step, clock.length)


@kernel
def run(p, clock, zones, profiles, y, series, error, segment, work, point, events, jumps, sample):
    """Step until the present step spans the instant of a sample.

    jumps : (m, ROWS_OF_JUMP, HIGH_RATE_COLUMNS) array
        Filled with the jumps at events; none are looked for if m is 0.

    Returns DONE, EVENTS_FULL (empty events and jumps and call again), STUCK or NOT_FINITE.
    """
    entered = clock.unsettled != 0
    clock.unsettled = 0
    while True:
        if clock.length < 0:
            begin_step(p, clock, zones, profiles, y, series, error, segment, work, entered)
            if clock.tiny_steps >= MANY_TINY_STEPS:
                return STUCK
            if not math.isfinite(series[2, DELTA] + clock.length):
                return NOT_FINITE
            if clock.jumped:
                note_jump(p, clock, series, segment, jumps)
        if time_of_sample(clock, sample) < clock.begin + clock.length:
            return DONE
        if clock.events > events.size - _EVENTS_PER_STEP:
            return EVENTS_FULL
        if jumps.shape[0] > 0 and (clock.ending == MESH or clock.ending == CONTACT):
            if clock.jumps == jumps.shape[0]:
                return EVENTS_FULL
            note_before(p, clock, series, segment)
        entered = end_step(p, clock, zones, profiles, y, series, segment, point, events)
        clock.length = -1.0


@kernel
def pass_section_before_sample(p, clock, series, events):
    """Emit the section state that the present step has before the next sample.

    `run` must have reached that sample.
    """
    tau = max(time_of_sample(clock, clock.sample) - clock.begin, 0.0)
    _pass_section(p, clock, series, tau, False, events)


@kernel
def interrupt(p, clock, y, series, point):
    """End the present step at the instant of the next sample, so that commands may change there.

    `run` must have reached that sample, and the section before it have been passed.
    """
    tau = max(time_of_sample(clock, clock.sample) - clock.begin, 0.0)
    advance_state(series, tau, y, point)
    end = clock.begin + tau
    clock.phase = _phase_at(p, clock, end)
    clock.speed = clock.anchor_speed + clock.accel * (end - clock.anchor)
    clock.torque += clock.torque_rate * tau
    clock.begin = end
    clock.length = -1.0
    _set_anchor(clock)


@kernel
def fill_samples(
    p,
    clock,
    zones,
    profiles,
    y,
    series,
    error,
    segment,
    work,
    point,
    events,
    jumps,
    whole_every,
    out,
):
    """Fill the rows of `out` with the next samples; return their number and a status.

    out : (n, 13 or more) array
        Columns in the order of SAMPLE_COLUMNS.
    whole_every : int
        Time, angles and load torque are wanted only of every so many samples, a power of two.
    """
    count = out.shape[0]
    i = 0
    while i < count:
        if clock.length < 0 or time_of_sample(clock, clock.sample) >= clock.begin + clock.length:
            status = run(
                p,
                clock,
                zones,
                profiles,
                y,
                series,
                error,
                segment,
                work,
                point,
                events,
                jumps,
                clock.sample,
            )
            if status != DONE:
                return i, status
        together = min(count - i, 4)
        end = clock.begin + clock.length
        while time_of_sample(clock, clock.sample + together - 1) >= end:
            together -= 1
        write_samples(p, clock, series, segment, point, whole_every, out, i, together)
        clock.sample += together
        i += together
    return count, DONE
