"""The columns of samples and of events, shared by the API, the topics and the logs."""

from __future__ import annotations

import enum

import numpy as np

ABOUT_SAMPLES = {
    't': ('s', 'time since header.stamp'),
    'pinion_ax': ('m/s2', 'acceleration of the pinion body, across the line of action'),
    'pinion_ay': ('m/s2', 'the same along the line of action'),
    'gear_ax': ('m/s2', 'acceleration of the gear body, across the line of action'),
    'gear_ay': ('m/s2', 'the same along the line of action'),
    'mesh_force': ('N', 'normal force of all tooth pairs, along +y on the pinion'),
    'friction_force': ('N', 'friction force of all tooth pairs, along +x on the pinion'),
    'delta': (
        'm',
        'displacement of the teeth on the line of action; above half the backlash in drive contact',
    ),
    'delta_dot': ('m/s', 'rate of change of `delta`'),
    'pinion_angle': ('rad', 'angle of the pinion shaft from 0 to 2 pi, with its vibration'),
    'gear_angle': ('rad', 'the same of the gear shaft'),
    'speed': ('rad/s', 'speed of the pinion, with its vibration'),
    'load_torque': ('N m', 'load torque after its rate limit'),
}
"""Unit and meaning of each column of a sample."""

SAMPLE_COLUMNS = tuple(ABOUT_SAMPLES)

SAMPLES = np.dtype([(name, np.float64) for name in SAMPLE_COLUMNS])
"""A sample at full precision; topics and logs carry the same columns as float32."""

SHAFTS = np.dtype([('gear_speed', np.float64), ('drive_torque', np.float64)])
"""What the shafts do beside the columns of a sample: speed of the gear [rad/s], torque of the drive
on the pinion [N m]."""

CHANNELS = SAMPLE_COLUMNS[1:9]
"""The columns that vibrate."""

CHANNEL_UNITS = {name: ABOUT_SAMPLES[name][0] for name in CHANNELS}

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
