"""Where a window of the oscilloscope begins: at a revolution, at a tooth, or anywhere."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.web.samples import SampleRing

TRIGGERS = ('none', 'pinion', 'gear', 'tooth')
"""What a window begins with: any sample, a revolution of a wheel, or a mesh cycle."""


def begin_of_window(ring: SampleRing, trigger: str, length: int, pinion_teeth: int) -> int:
    """Return how many samples before the end the last full window of `length` samples ends.

    A window begins where the trigger's angle passes 0; without such a place in the ring it is the
    last one there is.

    Parameters
    ----------
    ring : SampleRing
    trigger : str
        One of TRIGGERS.
    length : int
        Samples in the window.
    pinion_teeth : int
        Mesh cycles in a revolution of the pinion.
    """
    column = 'gear_angle' if trigger == 'gear' else 'pinion_angle'
    if trigger == 'none' or column not in ring.names:
        return 0
    angle = ring.last(column, ring.held).astype(np.float64)
    if trigger == 'tooth':
        angle = np.mod(angle * pinion_teeth, 2 * math.pi)
    wraps = np.flatnonzero(np.diff(angle) < -math.pi) + 1
    fitting = wraps[wraps + length <= len(angle)]
    return len(angle) - int(fitting[-1]) - length if len(fitting) else 0


def mesh_cycle(
    ring: SampleRing, columns: tuple[str, ...], pinion_teeth: int, points: int
) -> np.ndarray:
    """Return columns over the last full mesh cycle at equal steps of phase.

    Returns
    -------
    (len(columns), points) float32 array
        Empty in its second axis where no full cycle is at hand.
    """
    angle = ring.last('pinion_angle', min(ring.held, 1 << 15)).astype(np.float64)
    phase = np.unwrap(angle) * pinion_teeth / (2 * math.pi)
    if len(phase) < 4 or math.floor(phase[-1]) - math.ceil(phase[0]) < 1:
        return np.zeros((len(columns), 0), np.float32)
    end = math.floor(phase[-1])
    places = np.interp(end - 1 + np.arange(points) / points, phase, np.arange(len(phase)))
    nearest = np.round(places).astype(int)
    return np.stack([ring.last(name, len(phase))[nearest] for name in columns])
