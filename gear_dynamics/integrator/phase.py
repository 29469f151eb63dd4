"""The mesh phase, which is piecewise quadratic in time and so known ahead in closed form."""

from __future__ import annotations

import math

from gear_dynamics.integrator.kernel import kernel


@kernel
def phase_at(motion, t):
    """Return the mesh phase at time t in cycles since the beginning of the present cycle."""
    phase = motion.phase
    since = t - phase.anchor
    turned = since * (phase.anchor_speed + 0.5 * motion.commands.accel * since)
    return (
        phase.anchor_phase
        - (phase.cycle - phase.anchor_cycle)
        + motion.constants.z1 / (2 * math.pi) * turned
    )


@kernel
def time_of_phase(motion, at):
    """Return when a mesh phase (in the present cycle) is reached, or inf if it never is."""
    phase, accel = motion.phase, motion.commands.accel
    ahead = at + (phase.cycle - phase.anchor_cycle) - phase.anchor_phase
    turn = 2 * math.pi / motion.constants.z1 * ahead
    root = phase.anchor_speed**2 + 2 * accel * turn
    speed = phase.anchor_speed + math.sqrt(max(root, 0.0))
    if root < 0 or speed <= 0:
        # A pair that has come to a stop there, or just beyond, passes it as soon as it starts.
        return phase.anchor if ahead <= 0 and accel > 0 else math.inf
    return phase.anchor + 2 * turn / speed


@kernel
def set_anchor(motion):
    """Let the phase follow from the beginning of the step on."""
    phase = motion.phase
    phase.anchor, phase.anchor_phase = motion.step.begin, phase.phase
    phase.anchor_cycle, phase.anchor_speed = phase.cycle, motion.commands.speed


@kernel
def advance_clock(motion, tau):
    """Go on by tau [s] from the beginning of the step: time, phase and commands."""
    phase, commands, step = motion.phase, motion.commands, motion.step
    end = step.begin + tau
    # Where an event has put the phase exactly, rounding must not take it back before the event.
    phase.phase = max(phase_at(motion, end), phase.phase)
    commands.speed = phase.anchor_speed + commands.accel * (end - phase.anchor)
    commands.torque += commands.torque_rate * tau
    step.begin = end


@kernel
def move_origin(motion):
    """Count time from a later sample, so that it keeps its precision."""
    commands, sampling, step = motion.commands, motion.sampling, motion.step
    whole = math.floor(step.begin * sampling.sample_rate)
    shift = whole / sampling.sample_rate
    sampling.origin += int(whole)
    step.begin -= shift
    commands.speed_reached -= shift
    commands.torque_reached -= shift
    commands.ports_reached -= shift
    set_anchor(motion)
