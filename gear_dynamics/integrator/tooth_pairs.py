"""The deviations of the tooth pairs in contact over one step."""

from __future__ import annotations

import math

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    PAIR_DAMPING,
    PAIR_ERROR,
    PAIR_LOSS,
    PAIR_ROWS,
    PAIR_STIFFNESS,
    ROWS,
)
from gear_dynamics.integrator.polynomial import add_product, add_scaled, compose
from gear_dynamics.integrator.signals import strength
from gear_dynamics.integrator.tables import unpack


@kernel
def look_up(motion, ports, pairs):
    """Sum up what holds for each tooth pair in contact; cut the step at the next change of it."""
    contact = motion.contact
    contact.active[0, :] = 0
    contact.flawed[0, :] = 0
    tables = unpack(ports)
    if tables.pieces.size == 0:
        return
    z1 = int(motion.constants.z1)
    z2 = int(motion.constants.z2)
    tooth1, tooth2 = motion.phase.tooth1, motion.phase.tooth2
    for ahead in range(pairs):
        for group in (0, 1 + tooth1, 1 + z1 + tooth2):
            # Most teeth have none: not even the call.
            if tables.teeth[group] < tables.teeth[group + 1]:
                _look_up_group(motion, ports, ahead, group)
        if contact.active[0, ahead] and motion.pair_degrees[ahead, PAIR_LOSS] >= 0:
            _lose(motion, ahead)
        # The pair before: the teeth before, without a division.
        tooth1 = tooth1 - 1 if tooth1 > 0 else z1 - 1
        tooth2 = tooth2 - 1 if tooth2 > 0 else z2 - 1


@kernel
def _look_up_group(motion, ports, ahead, group):
    """Add the pieces of all teeth or of one tooth that hold for a tooth pair."""
    tables, step = unpack(ports), motion.step
    at = motion.phase.phase + ahead
    for i in range(tables.teeth[group], tables.teeth[group + 1]):
        piece = tables.pieces[i]
        if at >= piece.end:
            continue
        edge = (piece.begin if at < piece.begin else piece.end) - ahead
        if edge < step.edge:
            step.edge = edge
        if at >= piece.begin:
            _add_piece(motion, piece, tables.ramps[piece.ramp], ahead)


@kernel
def _add_piece(motion, piece, ramp, ahead):
    """Add a piece, with the strength of its group, to what deviates at a tooth pair."""
    contact, rows, scratch = motion.contact, motion.pairs[ahead], motion.scratch[0]
    factor, slope = strength(motion, ramp)
    if factor == 0.0 and slope == 0.0:
        return
    if contact.active[0, ahead] == 0:
        contact.active[0, ahead] = 1
        for row in range(PAIR_ROWS):
            for k in range(motion.pair_degrees[ahead, row] + 1):
                rows[row, k] = 0.0
            motion.pair_degrees[ahead, row] = -1
    if piece.flawed:
        contact.flawed[0, ahead] = 1
    turn = motion.constants.z1 / (2 * math.pi)
    by_length = 1.0 / (piece.end - piece.begin)
    place = (motion.phase.phase + ahead - piece.begin) * by_length
    rate = turn * motion.commands.speed * by_length
    half_ramp = 0.5 * turn * motion.commands.accel * by_length
    degrees, grows = motion.pair_degrees[ahead], 1 if slope != 0.0 else 0
    if piece.loss != 0.0:
        degrees[PAIR_LOSS] = _multiply(
            rows[PAIR_LOSS], degrees[PAIR_LOSS], piece.loss * factor, piece.loss * slope
        )
    for row in range(PAIR_LOSS):
        if row == PAIR_ERROR and not piece.flawed:
            continue
        size = compose(piece.coefficients[row], place, rate, half_ramp, scratch)
        if size == 0 and scratch[0] == 0.0:
            continue
        # A row is zero beyond its terms.
        add_scaled(rows[row], ROWS - 1, scratch, size, factor, slope, ROWS)
        degrees[row] = max(degrees[row], min(size + grows, ROWS - 1))


@kernel
def _multiply(row, degree, loss, rate):
    """Multiply 1 + a polynomial by 1 - loss - rate t; return the degree of the polynomial left."""
    for k in range(max(degree, 0), -1, -1):
        present = row[k] + 1.0 if k == 0 else row[k]
        if rate != 0.0 and k + 1 < ROWS:
            row[k + 1] -= rate * present
        row[k] -= loss * present
    return min(max(degree, 0) + (1 if rate != 0.0 else 0), ROWS - 1)


@kernel
def _lose(motion, ahead):
    """Multiply stiffness and damping of a tooth pair by what the losses leave."""
    rows, degrees, scratch = motion.pairs[ahead], motion.pair_degrees[ahead], motion.scratch[0]
    loss, last = rows[PAIR_LOSS], degrees[PAIR_LOSS]
    for row in (PAIR_STIFFNESS, PAIR_DAMPING):
        own = rows[row]
        size = add_product(scratch, -1, own, degrees[row], loss, last, 1.0, ROWS)
        size = add_scaled(scratch, size, loss, last, 1.0, 0.0, ROWS)
        degrees[row] = add_scaled(own, degrees[row], scratch, size, 1.0, 0.0, ROWS)
