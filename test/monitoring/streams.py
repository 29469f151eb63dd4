"""Streams of samples whose analysis is known, for tests of the online engine."""

import numpy as np

from gear_dynamics.machine.columns import CHANNELS, SAMPLES
from gear_dynamics.machine.configuration import Rig

RATE = 51200.0
BLOCK = 512
START_NS = 1_700_000_000_000_000_000

RIG = Rig(
    pinion_teeth=34,
    gear_teeth=59,
    wn=33844.0,
    half_backlash=150e-6,
    sample_rate=RATE,
    block_size=BLOCK,
    section_phase=0.5,
    pinion_inertia=6.3e-4,
    gear_inertia=5.7e-3,
)


def rotation(duration, start=104.72, end=None, turned=0.0):
    """Pinion angle [rad], unwrapped, from `start` to `end` rad/s."""
    t = np.arange(round(duration * RATE)) / RATE
    end = start if end is None else end
    return turned + start * t + (end - start) / duration * t**2 / 2


def samples(angle, **channels):
    """Samples of a pair turned by `angle`; channels not given are small cosines of the mesh."""
    rows = np.zeros(len(angle), SAMPLES)
    rows['t'] = np.arange(len(angle)) / RATE
    rows['pinion_angle'] = np.mod(angle, 2 * np.pi)
    rows['gear_angle'] = np.mod(angle * 34 / 59, 2 * np.pi)
    rows['speed'] = np.gradient(angle) * RATE
    for name in CHANNELS:
        rows[name] = channels.get(name, 1e-3 * np.cos(34 * angle))
    rows['delta_dot'] = channels.get('delta_dot', -34e-5 * rows['speed'] * np.sin(34 * angle))
    rows['delta'] = channels.get('delta', 2e-4 + 1e-5 * np.cos(34 * angle))
    return rows


def blocks(rows, size=BLOCK, start_ns=START_NS):
    """The samples as (stamp, float32 block with its own t)."""
    for first in range(0, len(rows) - size + 1, size):
        block = rows[first : first + size].copy()
        block['t'] -= block['t'][0]
        as_sent = block.astype([(name, np.float32) for name in block.dtype.names])
        yield start_ns + round(first * 1e9 / RATE), as_sent
