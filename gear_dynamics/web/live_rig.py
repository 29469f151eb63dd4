"""What is known of one rig at present: the data of every panel."""

from __future__ import annotations

import dataclasses
import math
import threading
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from gear_dynamics.web.samples import SampleRing
from gear_dynamics.web.windows import begin_of_window, mesh_cycle

HELD_SECONDS = 4.2
"""Length of the samples that are kept, which bounds the oscilloscope's window [s]."""

HELD_SAMPLES = 1 << 22
"""Most samples kept, whatever the rate."""

HELD_POINTS = 20_000
"""Points of the Poincaré section that a page which comes late is given."""

NOTICES = 20
"""Lines about commands that are kept."""


@dataclasses.dataclass(frozen=True)
class LiveTable:
    """The latest rows of a table, numbered so that a page takes each once."""

    number: int
    rows: np.ndarray


class LiveRig:
    """Hold the latest data of a rig; fed by one thread, read by the server's.

    Parameters
    ----------
    name : str
        The rig's name, such as its namespace.
    controllable : bool
        False for a log that is replayed: then there are no controls.
    """

    def __init__(self, name: str, controllable: bool = True) -> None:
        self.name = name
        self.controllable = controllable
        self._lock = threading.Lock()
        self._ring: SampleRing | None = None
        self._tables: dict[str, LiveTable] = {}
        self._points = np.zeros((HELD_POINTS, 2), np.float32)
        self._point_count = 0
        self._conditions: dict[str, dict[str, Any]] = {}
        self._health: dict[str, dict[str, Any]] = {}
        self._faults: list[dict[str, Any]] = []
        self._configuration: dict[str, Any] = {}
        self._notices: list[str] = []
        self._block_at = -math.inf
        self._latest: dict[str, float] = {}

    # -- fed by the source -------------------------------------------------------------------

    def configure(self, content: Mapping[str, Any]) -> None:
        """Take what `gear_pair/configuration` says, as a mapping."""
        with self._lock:
            self._configuration = dict(content)

    def add_block(self, rows: np.ndarray, rate: float) -> None:
        """Take a block of samples: a structured array of any columns, at `rate` [Hz]."""
        names = tuple(name for name in rows.dtype.names or () if name != 't')
        capacity = int(min(max(rate * HELD_SECONDS, 1024), HELD_SAMPLES))
        with self._lock:
            ring = self._ring
            if ring is None or ring.names != names or ring.capacity != capacity:
                ring = self._ring = SampleRing(names, capacity)
                self._rate = rate
            ring.add(rows)
            self._block_at = time.monotonic()
            self._latest = {name: float(np.mean(rows[name])) for name in names if len(rows)}

    def add_table(self, name: str, rows: np.ndarray) -> None:
        """Take the rows of a table, named as its topic; those of `poincare` add up."""
        with self._lock:
            if name == 'poincare':
                self._add_points(rows)
                return
            before = self._tables.get(name)
            self._tables[name] = LiveTable(before.number + 1 if before else 1, rows)

    def _add_points(self, rows: np.ndarray) -> None:
        for row in rows[-HELD_POINTS:]:
            self._points[self._point_count % HELD_POINTS] = row['x'], row['y']
            self._point_count += 1

    def set_condition(
        self, subject: str, level: int, message: str, values: Mapping[str, Any]
    ) -> None:
        """Take the latest indicators of a subject; values of other names are kept."""
        with self._lock:
            kept = self._conditions.get(subject, {}).get('values', {})
            entry = {'level': level, 'message': message, 'values': {**kept, **values}}
            self._conditions[subject] = entry

    def set_health(self, name: str, level: int, message: str, values: Mapping[str, Any]) -> None:
        """Take what a node says of itself."""
        with self._lock:
            self._health[name] = {'level': level, 'message': message, 'values': dict(values)}

    def set_faults(self, faults: list[dict[str, Any]]) -> None:
        """Take the faults that the machine has in truth."""
        with self._lock:
            self._faults = faults

    def notice(self, line: str) -> None:
        """Keep a line about a command for the page to show."""
        with self._lock:
            self._notices = [*self._notices, line][-NOTICES:]

    # -- read by the server ------------------------------------------------------------------

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the sample columns."""
        with self._lock:
            return self._ring.names if self._ring is not None else ()

    def pinion_teeth(self) -> int:
        """Return the mesh cycles in a revolution of the pinion, 1 if not known."""
        value = self._configuration.get('parameters', {}).get('pinion_teeth', 1)
        return int(value) if isinstance(value, int | float) and value >= 1 else 1

    def window(
        self, channels: tuple[str, ...], seconds: float, trigger: str
    ) -> tuple[float, dict[str, np.ndarray]]:
        """Return the sample rate [Hz] and the oscilloscope's window of each channel there is."""
        with self._lock:
            ring = self._ring
            if ring is None:
                return 0.0, {}
            length = min(max(round(seconds * self._rate), 2), ring.held)
            before = begin_of_window(ring, trigger, length, self.pinion_teeth())
            there = [name for name in channels if name in ring.names]
            return self._rate, {name: ring.last(name, length, before) for name in there}

    def cycle(self, points: int) -> np.ndarray:
        """Return mesh and friction force over the last full mesh cycle, a (2, points) array."""
        with self._lock:
            columns = ('mesh_force', 'friction_force')
            ring = self._ring
            if ring is None or not {'pinion_angle', *columns} <= set(ring.names):
                return np.zeros((2, 0), np.float32)
            return mesh_cycle(ring, columns, self.pinion_teeth(), points)

    def table(self, name: str) -> LiveTable | None:
        """Return the latest table of a name, or None."""
        with self._lock:
            return self._tables.get(name)

    def points_since(self, count: int) -> tuple[int, np.ndarray]:
        """Return the number of section points ever, and those after the first `count`."""
        with self._lock:
            total = self._point_count
            fresh = min(max(total - count, 0), HELD_POINTS)
            places = np.arange(total - fresh, total) % HELD_POINTS
            return total, self._points[places]

    def clear_points(self) -> None:
        """Forget the section points, as after a change of the pair."""
        with self._lock:
            self._point_count = 0

    def state(self) -> dict[str, Any]:
        """Return all that is shown as text, as plain values."""
        with self._lock:
            age = time.monotonic() - self._block_at
            return {
                'rig': self.name,
                'controllable': self.controllable,
                'age': age,
                'channels': list(self._ring.names) if self._ring is not None else [],
                'latest': dict(self._latest),
                'conditions': dict(self._conditions),
                'health': dict(self._health),
                'faults': list(self._faults),
                'configuration': self._configuration,
                'notices': list(self._notices),
            }
