"""What the stepper keeps of one gear pair: one NumPy record, split by subject."""

from __future__ import annotations

import numpy as np

from gear_dynamics.integrator.constants import CONSTANTS
from gear_dynamics.integrator.contact import PARTS
from gear_dynamics.integrator.layout import (
    COLUMNS,
    PAIR_ROWS,
    ROWS,
    SEGMENT,
    SIGNAL_ROWS,
    STATES,
    VALUES,
    WIDTH,
)
from gear_dynamics.integrator.vector import LANES
from gear_dynamics.machine.columns import EVENTS

MESHES, TOOTH_PAIRS = 1, 2
"""Meshes, and tooth pairs that a mesh may have in contact at once."""


def _fields(numbers: str, integers: str) -> list[tuple]:
    return [(name, np.float64) for name in numbers.split()] + [
        (name, np.int64) for name in integers.split()
    ]


COMMANDS = np.dtype(
    _fields(
        'speed accel torque torque_rate speed_target torque_target speed_limit torque_limit '
        'speed_reached torque_reached ports_reached',
        '',
    )
)
"""Pinion speed [rad/s] and acceleration, load torque [N m] and its rate, where the step begins;
their targets and rate limits, and when the targets and the ports' strengths are reached."""

PHASE = np.dtype(
    _fields('phase anchor anchor_phase anchor_speed', 'cycle zone tooth1 tooth2 anchor_cycle')
)
"""Mesh phase within the present cycle where the step begins, the cycle and its mesh interval, the
pinion and the gear tooth of tooth pair A. anchor: where speed and acceleration last changed, from
which the phase follows."""

CONTACT = np.dtype(
    [
        ('state', np.int64, (MESHES, TOOTH_PAIRS)),
        ('after', np.int64, (MESHES, TOOTH_PAIRS)),
        ('active', np.int64, (MESHES, TOOTH_PAIRS)),
        ('flawed', np.int64, (MESHES, TOOTH_PAIRS)),
    ]
)
"""Contact states of the leading pair A (0) and the pair B before it (1), those after the step, and
whether deviations act on the pair in this step, flank errors among them."""

STEP = np.dtype(
    _fields(
        'begin length edge travel smallest',
        'ending degree stiffness_degree pushed push_degree rated unsettled tiny_steps ported jumpy',
    )
)
"""The present step: begin [s since the origin of time], length [s], the mesh phase that may end it,
how fast the arms grow [m/s], the shortest step so far; why it ends, the degree of its segment, that
of stiffness and damping in it, whether signals push the bodies and the degree of that, whether the
rates of its samples are there. unsettled: contact states may have jumped where it begins. ported:
whether there are ports; jumpy: whether flank errors, transmission error or backlash may jump at an
event."""

SAMPLING = np.dtype(_fields('sample_rate section_phase', 'sample origin section_cycle'))
"""origin: the sample at the origin of time, which moves on once a second, so that times keep their
precision however long the run. sample: the next one."""

BEFORE = np.dtype(
    [
        ('force', np.float64, (3,)),
        ('friction', np.float64, (3,)),
        ('torque1', np.float64),
        ('curvature', np.float64),
        ('third', np.float64),
        ('jumped', np.int64),
    ]
)
"""Before the last event: forces with their first two derivatives, the moment, and the second and
third derivative of delta; jumped: the jump is still to be noted."""

COUNTS = np.dtype(
    _fields('', 'events jumps steps rejected_steps contact_losses back_flank_impacts')
)
"""events, jumps: those that wait to be taken out."""

EVENT_ROOM = 128
"""Events that a motion can hold until they are taken out."""

_CACHE_LINE = 64


def _in_cache_lines(fields: dict[str, tuple]) -> np.dtype:
    """Return a record of fields (dtype, shape), each of which begins a cache line.

    A vector that lies in two of them takes twice as long to load and to store.
    """
    offsets, end = [], 0
    for kind in fields.values():
        offsets.append(end)
        end += -(-np.dtype(kind).itemsize // _CACHE_LINE) * _CACHE_LINE
    formats = [np.dtype(kind) for kind in fields.values()]
    return np.dtype(
        {'names': list(fields), 'formats': formats, 'offsets': offsets, 'itemsize': end}
    )


TANGENT = _in_cache_lines(
    {
        'state': (np.float64, (STATES + 1,)),
        'series': (np.float64, (ROWS, COLUMNS)),
        'error': (np.float64, (1, ROWS)),
        'segment': (np.float64, (SEGMENT, WIDTH)),
        'supports': (np.float64, (4, ROWS)),
    }
)
"""What the series of a tangent vector is made of: as of the motion, without loads."""


MOTION = _in_cache_lines(
    {
        'constants': (CONSTANTS, ()),
        'commands': (COMMANDS, ()),
        'phase': (PHASE, ()),
        'contact': (CONTACT, ()),
        'step': (STEP, ()),
        'sampling': (SAMPLING, ()),
        'before': (BEFORE, ()),
        'counts': (COUNTS, ()),
        'state': (np.float64, (STATES,)),
        'series': (np.float64, (ROWS, COLUMNS)),
        # the transmission error; and, while contact is looked at, what is held against b and -b
        'error': (np.float64, (3, ROWS)),
        'segment': (np.float64, (SEGMENT, WIDTH)),
        'parts': (np.float64, (4, PARTS)),
        'point': (np.float64, (2, COLUMNS)),
        # of samples: series of derivatives, times in the step, values at them
        'rates': (np.float64, (ROWS, COLUMNS)),
        'times': (np.float64, (LANES,)),
        'values': (np.float64, (VALUES, LANES)),
        'forced': (np.float64, (4,)),
        # of ports: series of the signals and their degrees, -1 where a signal is not used;
        # accelerations; changes of the supports; what deviates at the tooth pairs; scratch
        'signals': (np.float64, (SIGNAL_ROWS, ROWS)),
        'degrees': (np.int64, (SIGNAL_ROWS,)),
        'push': (np.float64, (ROWS, COLUMNS)),
        'supports': (np.float64, (4, ROWS)),
        'tangent': (TANGENT, ()),
        'pairs': (np.float64, (TOOTH_PAIRS, PAIR_ROWS, ROWS)),
        'pair_degrees': (np.int64, (TOOTH_PAIRS, PAIR_ROWS)),
        'scratch': (np.float64, (7, 2 * ROWS)),
        'events': (EVENTS, (EVENT_ROOM,)),
    }
)
"""Everything that the stepper keeps of one gear pair."""


def empty_records(n: int) -> np.ndarray:
    """Return n records of MOTION that begin at a cache line."""
    memory = np.zeros(n * MOTION.itemsize + _CACHE_LINE, np.uint8)
    skip = -memory.ctypes.data % _CACHE_LINE
    return memory[skip : skip + n * MOTION.itemsize].view(MOTION)
