"""Sizes and places in the integrator's arrays."""

from gear_dynamics.model.ports import SIGNALS

ORDER = 28
"""Order of the positions' series."""

ROWS = ORDER + 1
"""Rows of a series: the coefficients of t^0 to t^ORDER."""

# Columns of a series: the coordinates of model.system, delta, and the integral of q.
X1, Y1, X2, Y2, PSI, Q, DELTA, Q_SUM = range(8)
COLUMNS = 8
COORDINATES = 6
SUPPORTED = 4
"""Columns from X1 on that rest on a support."""

# Rows of the values that samples are made of: those named by the columns X1 to DELTA are of the
# rates, second derivatives for X1 to Y2 and first ones for PSI, Q and DELTA, and these:
PSI_VALUE, Q_VALUE, DELTA_VALUE, Q_SUM_VALUE = range(7, 11)
VALUES = 11

# Rows of `constants.answers`: what the second derivative of each coordinate is made of.
TO_FORCE, TO_FRICTION, TO_MOMENT, TO_LOAD, STIFFNESS, DAMPING, TO_Q, TO_Q_DOT, TO_Q_SUM = range(9)
ANSWERS = 9
"""Per unit of mesh force, friction force, moment and load side torque, of the coordinate itself and
its derivative (by its support), and of q, its derivative and its integral (by the drive)."""

STATES = 13
"""Numbers in a state: the coordinates of model.system, from VELOCITY on their velocities, and the
integral of q."""
VELOCITY = COORDINATES
STATE_Q_SUM = 2 * COORDINATES

WIDTH = ROWS - 2
"""Coefficients of a segment's polynomials in time: those that the series can use."""

# Rows of a segment: what multiplies delta and delta', and the offset, in the mesh force F, the
# friction force Ff and the moment sum of Ff_i times the arm at the beginning of the step.
SEG_FORCE, SEG_FRICTION, SEG_MOMENT = 0, 3, 6
SEGMENT = 9

# Rows of the polynomials in time of a tooth pair with deviations: relative changes of stiffness and
# damping, flank error, what is added to mu, and prod(1 - loss) - 1.
PAIR_STIFFNESS, PAIR_DAMPING, PAIR_ERROR, PAIR_FRICTION, PAIR_LOSS = range(5)
PAIR_ROWS = 5

# Signals that terms of ports add to, in the order of model.ports.SIGNALS.
SIGNAL = {name: i for i, name in enumerate(SIGNALS)}
ERROR, GAP, MU, REST = (
    SIGNAL[name] for name in ('transmission_error', 'half_backlash', 'friction', 'pinion_rest_x')
)
PUSH, DRIVE_SIGNAL, LOAD_SIGNAL, SUPPORT_K, SUPPORT_C = (
    SIGNAL[name]
    for name in (
        'pinion_force_x',
        'drive_torque',
        'load_torque',
        'pinion_support_stiffness',
        'pinion_support_damping',
    )
)
SIGNAL_ROWS = len(SIGNALS)

SUPPORTS_CHANGE = 2
"""What `step.pushed` is where stiffness or damping of a support changes."""

LONGEST_STEP = 0.05
"""The longest step [s]; only a soft pair at rest comes near it."""

MOST_RADIANS = 16.0
"""Longest step, in radians of the fastest mode: a sixteenth of it then spans one radian at most, in
which a motion of that mode alone has room for one extremum."""

# Columns of the integrator's samples: those that are handed out, what the shafts do besides, and
# padding to two vector registers.
T, AX1, AY1, AX2, AY2, FORCE, FRICTION = range(7)
SAMPLE_DELTA, SAMPLE_DELTA_DOT, ANGLE1, ANGLE2, SPEED, LOAD = range(7, 13)
GEAR_SPEED, DRIVE_TORQUE = 13, 14
HIGH_RATE_COLUMNS = 16


DELAY = 24
"""Samples by which the band-limiting filter looks ahead of the sample that it makes."""

OVERSAMPLING = 4
"""Samples at the high rate that make one band-limited sample."""

TAPS = 2 * DELAY * OVERSAMPLING + 1
"""Length of the band-limiting filter."""

PADDED_TAPS = -(-TAPS // 8) * 8
"""That, with zeros at its end to whole vectors."""

REACH = 4
"""Samples at the high rate, to each side, that a band-limited jump changes."""

AHEAD = DELAY + 2 * REACH // OVERSAMPLING
"""Samples by which a band-limited stream is integrated ahead of what it hands out."""
