"""Mesh phase and angular resampling of a stream, block by block."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.signal.interpolation import HALF_WIDTH, interpolate


class PhaseStream:
    """Unwraps the angles of a stream into the mesh phase of the rigid pair.

    Parameters
    ----------
    pinion_teeth, gear_teeth : int
    pinion_weight : float
        As `order_tracking.mesh_phase` takes it.
    """

    def __init__(self, pinion_teeth: int, gear_teeth: int, pinion_weight: float) -> None:
        self._teeth = np.array([pinion_teeth, gear_teeth], dtype=float)
        self._weight = pinion_weight
        self._last: np.ndarray | None = None
        self._turned = np.zeros(2)
        self.gear_lead = 0

    def push(self, pinion_angle: np.ndarray, gear_angle: np.ndarray) -> np.ndarray:
        """Take the next angles [rad]; return the phase [cycles], counted from the pinion's zero.

        `gear_lead` is the whole number of cycles by which the gear's own count is ahead.
        """
        angles = np.stack([pinion_angle, gear_angle], axis=1)
        if self._last is None:
            self._last = angles[0]
            self._turned = angles[0]
            lead = angles[0] / (2 * math.pi) * self._teeth
            self.gear_lead = round(float(lead[1] - lead[0]))
        steps = np.diff(angles, axis=0, prepend=self._last[np.newaxis])
        steps -= 2 * math.pi * np.round(steps / (2 * math.pi))
        turned = self._turned + np.cumsum(steps, axis=0)
        self._last, self._turned = angles[-1], turned[-1]
        phases = turned / (2 * math.pi) * self._teeth
        return (phases[:, 0] * self._weight) + (phases[:, 1] - self.gear_lead) * (1 - self._weight)


class AngularResampler:
    """Gives the rows of a stream at equal steps of its phase; see `resample_by_phase`.

    Parameters
    ----------
    points : int
        Points in a cycle.
    """

    def __init__(self, points: int) -> None:
        self.points = points
        self._rows: np.ndarray | None = None
        self._phase = np.empty(0)
        self._next: int | None = None

    def push(self, rows: np.ndarray, phase: np.ndarray) -> tuple[int, np.ndarray]:
        """Take rows, shape (n, columns), with their rising phase.

        Returns
        -------
        first : int
            The first of the rows returned is at phase first / points.
        rows : ndarray, shape (m, columns)
            All that can be told so far, once each.
        """
        if self._rows is not None:
            rows = np.concatenate([self._rows, rows])
            phase = np.concatenate([self._phase, phase])
        self._rows, self._phase = rows, phase
        if len(rows) <= 2 * HALF_WIDTH:
            return 0, rows[:0]
        if self._next is None:
            self._next = math.ceil(phase[HALF_WIDTH] * self.points)
        first = self._next
        self._next = max(first, math.floor(phase[-HALF_WIDTH - 1] * self.points) + 1)
        ticks = np.arange(first, self._next) / self.points
        values = interpolate(rows, np.interp(ticks, phase, np.arange(len(rows))))
        kept = 2 * HALF_WIDTH + 1
        self._rows, self._phase = rows[-kept:], phase[-kept:]
        return first, values
