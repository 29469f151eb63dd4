"""The messages that a page is sent: what its view shows, as far as it is new."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

from gear_dynamics.web.decimation import extremes
from gear_dynamics.web.live_rig import LiveRig
from gear_dynamics.web.messages import binary_frame, json_text
from gear_dynamics.web.view import View

TABLES = ('spectrum', 'envelope_spectrum', 'order_spectrum')
"""Tables that a page draws as lines."""

CYCLE_POINTS = 96
"""Phases of a mesh cycle at which the forces on the wheels are drawn."""

STATE_PERIOD = 0.25
"""Time between two state messages [s]."""


class Frames:
    """Make the messages for one page, and remember what it has."""

    def __init__(self) -> None:
        self._rig: LiveRig | None = None
        self._tables: dict[str, int] = {}
        self._points = 0
        self._state_due = 0.0

    def next(self, rig: LiveRig, rigs: list[str], view: View) -> Iterator[bytes | str]:
        """Yield the messages that are due for a view of a rig."""
        if rig is not self._rig:
            self._rig, self._tables, self._points, self._state_due = rig, {}, 0, 0.0
        now = time.monotonic()
        if now >= self._state_due:
            self._state_due = now + STATE_PERIOD
            yield json_text({'type': 'state', 'rigs': rigs, **rig.state()})
        for name in TABLES:
            table = rig.table(name)
            if table is not None and self._tables.get(name) != table.number:
                self._tables[name] = table.number
                yield table_frame(name, table.rows)
        total, points = rig.points_since(self._points)
        if total != self._points:
            cleared = total < self._points
            self._points = total
            header = {'type': 'points', 'total': total, 'cleared': cleared}
            yield binary_frame(header, {'x': points[:, 0], 'y': points[:, 1]})
        yield self._scope(rig, view)  # the last: the page asks for more when it is drawn

    def _scope(self, rig: LiveRig, view: View) -> bytes:
        rate, window = rig.window(view.channels, view.window, view.trigger)
        arrays: dict[str, np.ndarray] = {}
        for name, values in window.items():
            places, drawn = extremes(values, view.pixels)
            arrays.setdefault('t', places / rate)
            arrays[name] = drawn
        cycle = rig.cycle(CYCLE_POINTS)
        arrays['cycle_mesh_force'], arrays['cycle_friction_force'] = cycle
        return binary_frame({'type': 'scope', 'channels': list(window)}, arrays)


def table_frame(name: str, rows: np.ndarray) -> bytes:
    """Return a table as a frame, its first column the axis."""
    names = rows.dtype.names or ()
    header = {'type': 'table', 'name': name, 'axis': names[0] if names else ''}
    return binary_frame(header, {each: rows[each] for each in names})
