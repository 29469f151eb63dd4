"""Sizes and places in the integrator's arrays."""

ORDER = 28
"""Order of the positions' series."""

ROWS = ORDER + 1
"""Rows of a series: the coefficients of t^0 to t^ORDER."""

# Columns of a series.
X1, Y1, X2, Y2, PSI, Q, DELTA, Q_SUM = range(8)
COLUMNS = 8
"""Positions, delta, and the integral of q."""

# Rows of the values that samples are made of: those named by the columns X1 to DELTA are of the
# rates, second derivatives for X1 to Y2 and first ones for PSI, Q and DELTA, and these:
PSI_VALUE, Q_VALUE, DELTA_VALUE, Q_SUM_VALUE = range(7, 11)
VALUES = 11

STATES = 13
"""States: six positions (x1, y1, x2, y2, psi, q), their velocities, and the integral of q.

psi = rb1 th1 - rb2 th2 and q, the rigid rotation, stand for th1 and th2: at mu = 0 the drive then
never touches the vibration, to the last bit.
"""

WIDTH = 13
"""Coefficients of a segment's polynomials in time: s is quadratic in time while the speed ramps,
profiles are cubic in s, and the offset is a product of two of them."""

# Rows of a segment: what multiplies delta and delta', and the offset, in the mesh force F, the
# friction force Ff and the moment sum of Ff_i times the arm at the beginning of the step.
SEG_FORCE, SEG_FRICTION, SEG_MOMENT = 0, 3, 6
# Flank errors of pairs A and B.
SEG_ERROR = 9
# One pair's own stiffness, damping and offset, while its profile is added to the sums.
SEG_PAIR = 11
SEGMENT = 14

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
