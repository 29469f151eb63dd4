"""Tooth pairs whose stiffness, damping or flank error departs from the healthy one."""

from __future__ import annotations

import math

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import SEG_ERROR, SEG_PAIR
from gear_dynamics.model.mesh.intervals import DEGREE

_SPAN = 2 * DEGREE + 1


@kernel
def _applies(p, clock, zone, profile, ahead):
    """Return whether a profile row holds for pair A (ahead 0) or B (ahead 1) in this zone."""
    pair = clock.cycle - ahead
    pinion_tooth, gear_tooth = pair % int(p.z1), pair % int(p.z2)
    middle = (0.5 * (zone.begin + zone.end) + ahead) * p.pitch
    return (
        (profile.pinion_tooth < 0 or profile.pinion_tooth == pinion_tooth)
        and (profile.gear_tooth < 0 or profile.gear_tooth == gear_tooth)
        and profile.begin <= middle <= profile.end
    )


@kernel
def has_profile(p, clock, zone, profiles, ahead):
    """Return whether any profile row holds for the pair in this zone."""
    for i in range(profiles.size):
        if _applies(p, clock, zone, profiles[i], ahead):
            return True
    return False


@kernel
def _compose(coefficients, position, rate, ramp, factor, out):
    """Add factor times the polynomial in s = position + rate t + ramp t^2 to `out`, in t."""
    value = (coefficients[DEGREE], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for j in range(DEGREE - 1, -1, -1):
        value = (
            value[0] * position + coefficients[j],
            value[1] * position + value[0] * rate,
            value[2] * position + value[1] * rate + value[0] * ramp,
            value[3] * position + value[2] * rate + value[1] * ramp,
            value[4] * position + value[3] * rate + value[2] * ramp,
            value[5] * position + value[4] * rate + value[3] * ramp,
            value[6] * position + value[5] * rate + value[4] * ramp,
        )
    for j in range(_SPAN):
        out[j] += factor * value[j]


@kernel
def fill_profiled_pair(motion, zone, profiles, ahead, stiffness, damping, contact):
    """Fill the rows of the pair's own stiffness, damping, offset and flank error."""
    p, clock, segment = motion.constants, motion.clock, motion.segment
    position = (clock.phase + ahead) * p.pitch
    turn = p.pitch * p.z1 / (2 * math.pi)
    rate, ramp = turn * clock.speed, 0.5 * turn * clock.accel
    k, c, offset = segment[SEG_PAIR], segment[SEG_PAIR + 1], segment[SEG_PAIR + 2]
    error = segment[SEG_ERROR + ahead]
    error[:] = 0.0
    k[0], c[0] = stiffness, damping
    for i in range(profiles.size):
        profile = profiles[i]
        if _applies(p, clock, zone, profile, ahead):
            _compose(profile.stiffness, position, rate, ramp, stiffness, k)
            _compose(profile.damping, position, rate, ramp, damping, c)
            _compose(profile.error, position, rate, ramp, 1.0, error)
    for i in range(_SPAN):
        offset[i] -= k[i] * contact * p.b
        for j in range(_SPAN):
            offset[i + j] -= k[i] * error[j]
            if j > 0:
                offset[i + j - 1] -= c[i] * j * error[j]
