"""When a recording was made: from its time column, its header, or the name of its file."""

from __future__ import annotations

import datetime
import re

import numpy as np

from gear_dynamics.machine.source import Time
from gear_dynamics.machine.units import factor
from gear_dynamics.recordings.table import RecordingError, RecordingTable

_STAMP = re.compile(
    r'(\d{4})[-._]?(\d{2})[-._]?(\d{2})[-._ T]?(\d{2})[-.:_h]?(\d{2})(?:[-.:_m]?(\d{2}))?'
)
"""Year, month, day, hour, minute and perhaps second in the name of a file."""


def recording_time(table: RecordingTable, time: Time | None) -> float | None:
    """Return the time of a recording's first sample [s], since 1970 or midnight, if it states one.

    Parameters
    ----------
    table : RecordingTable
    time : Time, optional
        Columns with the time; those of the time since the start of each recording say nothing.
    """
    if time is not None and len(time.columns) > 1:
        try:
            columns = [table.resolve(column) for column in time.columns]
        except RecordingError:
            return None
        opened = table.open(columns)
        first = [float(next(opened[column], np.array([np.nan]))[0]) for column in columns]
        return sum(factor(u, 's') * v for u, v in zip(time.units, first, strict=True))
    start = table.start_ns()
    if start is not None:
        return start / 1e9
    found = _STAMP.search(table.name)
    if found is None:
        return None
    numbers = [int(each or 0) for each in found.groups()]
    try:
        stamp = datetime.datetime(*numbers, tzinfo=datetime.timezone.utc)  # type: ignore[misc,arg-type]
    except ValueError:
        return None
    return stamp.timestamp()
