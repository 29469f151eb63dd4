"""The stepper: Taylor steps that end exactly at events, and samples off their dense output."""

from __future__ import annotations

import math

from gear_dynamics.integrator.contact_events import (
    COMMAND,
    CONTACT,
    CONTROL,
    ENTRY,
    MESH,
    change_contact,
    emit,
    find_contact_change,
    settle_new_pair,
)
from gear_dynamics.integrator.jumps import note_before, note_jump
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import DELTA
from gear_dynamics.integrator.output import time_of_sample, write_due_samples
from gear_dynamics.integrator.phase import advance_clock, move_origin, set_anchor, time_of_phase
from gear_dynamics.integrator.segment import fill_mesh, fill_segment
from gear_dynamics.integrator.series import (
    advance_state,
    expand,
    expand_error,
    step_size,
    value_and_slope,
)
from gear_dynamics.integrator.signals import elapsed, longest_step, next_knot, pass_knot
from gear_dynamics.integrator.tables import unpack
from gear_dynamics.machine.columns import EventKind

# What `begin_step` and `run` return.
DONE, EVENTS_FULL, STUCK, NOT_FINITE = 0, 1, 2, 3

SHORTEST_STEP = 1e-10
"""The shortest step [s] that the motion itself may ask for: at 1e10 steps a second of model time
would take hours, so that the parameters must be wrong. Events may cut a step shorter."""

_TINY = 1e-9
MANY_TINY_STEPS = 10000
_EVENTS_PER_STEP = 4
_SECTION = int(EventKind.SECTION)


@kernel
def _pass_section(motion, until, wraps):
    """Emit the section state if the section phase is passed before `until` [s into the step]."""
    phase, sampling = motion.phase, motion.sampling
    if sampling.section_cycle > phase.cycle:
        return
    tau = time_of_phase(motion, sampling.section_phase) - motion.step.begin
    if tau < until or wraps:
        tau = min(max(tau, 0.0), until)
        delta, delta_dot = value_and_slope(motion, DELTA, tau)
        pair = phase.cycle % motion.constants.hunting
        emit(motion, tau, _SECTION, pair, delta, delta_dot, sampling.section_phase)
        sampling.section_cycle = phase.cycle + 1


@kernel
def _enter_zone(motion, zones):
    """Go on to the next zone of the mesh, where another tooth pair may enter."""
    p, phase, contact = motion.constants, motion.phase, motion.contact
    phase.zone += 1
    if phase.zone == zones.size:
        phase.zone = 0
        phase.cycle += 1
        phase.tooth1, phase.tooth2 = phase.cycle % int(p.z1), phase.cycle % int(p.z2)
        contact.state[0, 1] = contact.state[0, 0]
    phase.phase = zones[phase.zone].begin


@kernel
def _pass_knots(motion, tables):
    """Go on to the next piece of each curve whose piece ends at the phase that ended the step."""
    for i in range(tables.curves.size):
        curve = tables.curves[i]
        if not curve.timed and next_knot(motion, curve, tables.curve_pieces) <= motion.step.edge:
            pass_knot(curve)


@kernel
def _pass_mesh_event(motion, zones, ports):
    """Put the mesh where it is after the event; return whether delta_i may have jumped."""
    step = motion.step
    if not step.ported:
        _enter_zone(motion, zones)
        return False
    tables = unpack(ports)
    _pass_knots(motion, tables)
    if step.edge < zones[motion.phase.zone].end:
        motion.phase.phase = step.edge
    else:
        _enter_zone(motion, zones)
    return step.jumpy != 0


@kernel
def _reach_commands(motion, ports):
    """Let what is reached at the end of the step stand; return whether delta_i may have jumped."""
    commands, end = motion.commands, motion.step.begin
    if end >= commands.speed_reached:
        commands.speed, commands.accel = commands.speed_target, 0.0
        commands.speed_reached = math.inf
        set_anchor(motion)
    if end >= commands.torque_reached:
        commands.torque, commands.torque_rate = commands.torque_target, 0.0
        commands.torque_reached = math.inf
    if end >= commands.ports_reached:
        commands.ports_reached = math.inf
    if not motion.step.ported:
        return False
    tables = unpack(ports)
    for i in range(tables.curves.size):
        curve = tables.curves[i]
        if curve.timed and _time_left(motion, curve, tables.curve_pieces) <= 0.0:
            pass_knot(curve)
    return motion.step.jumpy != 0


@kernel
def _time_left(motion, curve, pieces):
    """Return how long the present piece of a curve in time lasts from the step's beginning on."""
    end = next_knot(motion, curve, pieces)
    return end - elapsed(motion)


@kernel
def end_step(motion, zones, ports):
    """Put the state at the end of the present step, and do what happens there."""
    step, phase = motion.step, motion.phase
    motion.counts.steps += 1
    wraps = (
        step.ending == MESH and phase.zone == zones.size - 1 and step.edge >= zones[phase.zone].end
    )
    _pass_section(motion, step.length, wraps)
    advance_state(motion, step.length)
    if step.ending == CONTACT or step.ending == ENTRY:
        change_contact(motion, zones[phase.zone])
    advance_clock(motion, step.length)
    if step.ending == MESH:
        step.unsettled = _pass_mesh_event(motion, zones, ports)
    elif step.ending == COMMAND:
        step.unsettled = _reach_commands(motion, ports)
    step.length = -1.0


@kernel
def _choose_length(motion, ports):
    """Set how far the present step goes, and why it ends there."""
    step, commands = motion.step, motion.commands
    step.length, step.ending = min(step_size(motion), longest_step(motion.constants)), CONTROL
    to_command = min(commands.speed_reached, commands.torque_reached) - step.begin
    if step.ported:
        to_command = min(to_command, commands.ports_reached - step.begin)
        tables = unpack(ports)
        for i in range(tables.curves.size):
            curve = tables.curves[i]
            if curve.timed:
                left = _time_left(motion, curve, tables.curve_pieces)
                to_command = min(to_command, left)
            else:
                step.edge = min(step.edge, next_knot(motion, curve, tables.curve_pieces))
    to_mesh = max(time_of_phase(motion, step.edge) - step.begin, 0.0)
    if to_mesh <= step.length:
        step.length, step.ending = to_mesh, MESH
    if to_command < step.length:
        step.length, step.ending = max(to_command, 0.0), COMMAND


@kernel
def begin_step(motion, zones, ports):
    """Expand the motion about the present state and choose the step.

    Return DONE, STUCK or NOT_FINITE.
    """
    step = motion.step
    entered = step.unsettled != 0
    step.unsettled = 0
    if step.begin > 1.0:
        move_origin(motion)
    step.degree = fill_segment(motion, zones, ports)
    expand_error(motion)
    if entered and step.ported and motion.phase.phase == 0.0:
        settle_new_pair(motion)
        step.degree = fill_mesh(motion, zones[motion.phase.zone])
    expand(motion)
    step.rated = 0
    _choose_length(motion, ports)
    too_fast = step.ending == CONTROL and step.length < SHORTEST_STEP
    find_contact_change(motion, zones[motion.phase.zone], entered and step.ported)
    if too_fast:
        step.tiny_steps = MANY_TINY_STEPS
    elif step.length < _TINY / motion.constants.wn:
        step.tiny_steps += 1
    else:
        step.tiny_steps = 0
    if step.length > 0:
        step.smallest = min(step.smallest, step.length)
    stuck = step.tiny_steps >= MANY_TINY_STEPS
    if stuck or not math.isfinite(motion.series[2, DELTA] + step.length):
        # Nothing of this step counts, so that the next call ends here too.
        step.length = -1.0
        return STUCK if stuck else NOT_FINITE
    return DONE


@kernel
def run(motion, zones, ports, jumps):
    """Step until the present step spans the instant of the next sample.

    jumps : (m, ROWS_OF_JUMP, HIGH_RATE_COLUMNS) array
        Filled with the jumps at events; none are looked for if m is 0.

    Returns DONE, EVENTS_FULL (empty events and jumps and call again), STUCK or NOT_FINITE.
    """
    step = motion.step
    while True:
        if step.length < 0:
            status = begin_step(motion, zones, ports)
            if status != DONE:
                return status
            if motion.before.jumped:
                note_jump(motion, jumps)
        if time_of_sample(motion, motion.sampling.sample) < step.begin + step.length:
            return DONE
        if motion.counts.events > motion.events.size - _EVENTS_PER_STEP:
            return EVENTS_FULL
        if jumps.shape[0] > 0 and step.ending != CONTROL and step.ending != COMMAND:
            if motion.counts.jumps == jumps.shape[0]:
                return EVENTS_FULL
            note_before(motion)
        end_step(motion, zones, ports)


@kernel
def interrupt(motion):
    """End the present step at the instant of the next sample, so that commands may change there.

    `run` must have reached that sample, and the section before it have been passed.
    """
    step = motion.step
    tau = max(time_of_sample(motion, motion.sampling.sample) - step.begin, 0.0)
    advance_state(motion, tau)
    advance_clock(motion, tau)
    step.length = -1.0
    set_anchor(motion)


@kernel
def _pass_section_before_sample(motion):
    """Emit the section state that the present step has before the next sample.

    `run` must have reached that sample.
    """
    until = time_of_sample(motion, motion.sampling.sample) - motion.step.begin
    _pass_section(motion, max(until, 0.0), False)


@kernel
def fill_samples(motion, zones, ports, jumps, whole_every, out):
    """Fill the rows of `out` with the next samples; return their number and a status.

    Without rows, step up to the instant of the next sample. A kernel of its own for that would
    compile the whole stepper again.

    jumps : as in `run`
    whole_every : int
        Time, angles and load torque are wanted only of every so many samples, a power of two.
    out : (n, 13 or more) array
        Columns in the order of SAMPLE_COLUMNS.
    """
    step, sampling = motion.step, motion.sampling
    i, rows = 0, out.shape[0]
    while i < rows or rows == 0:
        if step.length < 0 or time_of_sample(motion, sampling.sample) >= step.begin + step.length:
            status = run(motion, zones, ports, jumps)
            if status != DONE:
                return i, status
        if rows == 0:
            _pass_section_before_sample(motion)
            break
        i += write_due_samples(motion, whole_every, out, i)
    return i, DONE
