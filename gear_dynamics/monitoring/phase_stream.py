"""Mesh phase and angular resampling of a stream, block by block."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gear_dynamics.monitoring.layout import AngleTrack
from gear_dynamics.signal.interpolation import HALF_WIDTH, interpolate_rows


class PhaseStream:
    """Unwraps the angles of a mesh into its phase.

    With two angles the phase is that of the rigid pair, as `order_tracking.mesh_phase` defines it.

    Parameters
    ----------
    tracks : sequence of AngleTrack
        One or two.
    weight : float
        Weight of the first track's phase against the second's.
    """

    def __init__(self, tracks: Sequence[AngleTrack], weight: float) -> None:
        self._revolution = np.array([track.revolution for track in tracks])
        self._cycles = np.array([track.cycles for track in tracks])
        self._weights = np.array([weight, 1 - weight]) if len(tracks) == 2 else np.ones(1)
        self._last: np.ndarray | None = None
        self._turned = np.zeros(len(tracks))
        self.lead = 0

    def push(self, angles: np.ndarray) -> np.ndarray:
        """Take the next angles, one column a track; return the phase [cycles].

        The phase counts from the zero of the first angle. `lead` is the number of complete cycles
        by which the second angle's own count is ahead.
        """
        angles = angles / self._revolution
        if self._last is None:
            self._last = self._turned = angles[0]
            counts = angles[0] * self._cycles
            self.lead = round(float(counts[-1] - counts[0]))
        steps = np.diff(angles, axis=0, prepend=self._last[np.newaxis])
        steps -= np.round(steps)
        turned = self._turned + np.cumsum(steps, axis=0)
        self._last, self._turned = angles[-1], turned[-1]
        phases = turned * self._cycles
        phases[:, 1:] -= self.lead
        return phases @ self._weights


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
            All that are complete so far, once each.
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
        values = interpolate_rows(rows, np.interp(ticks, phase, np.arange(len(rows))))
        kept = 2 * HALF_WIDTH + 1
        self._rows, self._phase = rows[-kept:], phase[-kept:]
        return first, values
