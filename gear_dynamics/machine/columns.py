"""The columns of samples and of events, shared by the API, the topics and the logs."""

from __future__ import annotations

import enum

import numpy as np

SAMPLE_COLUMNS = (
    't',
    'pinion_ax',
    'pinion_ay',
    'gear_ax',
    'gear_ay',
    'mesh_force',
    'friction_force',
    'delta',
    'delta_dot',
    'pinion_angle',
    'gear_angle',
    'speed',
    'load_torque',
)
"""Names of the sample columns: t [s], accelerations [m/s2], forces on the pinion [N],
delta [m], delta_dot [m/s], angles [rad, 0 to 2 pi], pinion speed [rad/s], load torque [N m]."""

SAMPLES = np.dtype([(name, np.float64) for name in SAMPLE_COLUMNS])
"""A sample at full precision; topics and logs carry the same columns as float32."""

SHAFTS = np.dtype([('gear_speed', np.float64), ('drive_torque', np.float64)])
"""What the shafts do beside the columns of a sample: speed of the gear [rad/s], torque of the drive
on the pinion [N m]."""

CHANNELS = SAMPLE_COLUMNS[1:9]
"""The columns that vibrate."""

ALONG = ('pinion_ay', 'gear_ay', 'mesh_force', 'delta_dot')
ACROSS = ('pinion_ax', 'gear_ax', 'friction_force')
"""Those along the line of action, and across it, where friction acts."""

FORCE = 'mesh_force'
"""That which the load makes."""

EVENTS = np.dtype(
    [
        ('t', np.float64),
        ('kind', np.uint32),
        ('tooth_pair', np.uint32),
        ('delta', np.float64),
        ('delta_dot', np.float64),
        ('cycle', np.float64),
    ]
)
"""An event: time [s], `EventKind`, number of the tooth pair in the order of engagement modulo
the hunting period (so pinion tooth = tooth_pair mod z1, gear tooth = tooth_pair mod z2),
delta [m], delta_dot [m/s], mesh phase in cycles since the start of the run."""


class EventKind(enum.IntEnum):
    """What happened: the section phase was passed, or a tooth pair lost or regained contact."""

    SECTION = 0
    DRIVE_LOST = 1
    DRIVE_REGAINED = 2
    BACK_LOST = 3
    BACK_REGAINED = 4
