"""Where in a log the rows of a time range are, so that the rest need not be read."""

from __future__ import annotations

import numpy as np

from gear_dynamics.bag.log import Log, message_time
from gear_dynamics.bag.rows import RowReader

PROBES = 16
"""Messages, evenly spread, by which the stamps are compared with the log times."""

STEADY = 1_000_000_000
"""How much arrivals may differ in lateness, for the log times to be of use [ns]."""

MARGIN = 60_000_000_000
"""Log time that is read beyond the range on either side [ns]."""


def log_time_range(
    log: Log, name: str, reader: RowReader, low: float, high: float
) -> tuple[int | None, int | None]:
    """Return the log times [ns] between which the rows of a topic in low <= t < high [s] are.

    The index knows log times only. They bound the range where the messages' lateness is steady;
    otherwise, as when stamps run faster than the clock, the bounds are None.
    """
    if not log.indexed or not (np.isfinite(low) or np.isfinite(high)):
        return None, None
    filled = [count for count in log.contents().values() if count.messages]
    first = min((count.start for count in filled), default=0)
    last = max((count.end for count in filled), default=0)
    if last - first < MARGIN:
        return None, None
    late, lengths = [], []
    for at in np.linspace(first, last, PROBES).tolist():
        for _, message in log.messages([name], int(at)):
            late.append(message.log_time - message_time(message))
            try:
                rows = reader.read(message.data, 0.0, -np.inf, np.inf)
            except ValueError:
                return None, None
            lengths.append(float(rows['t'].max()) if len(rows) else 0.0)
            break
    if not late or max(late) - min(late) > STEADY:
        return None, None
    origin, length = log.origin(), max(lengths)
    start = origin + round((low - length) * 1e9) + min(late) - MARGIN if np.isfinite(low) else None
    end = origin + round(high * 1e9) + max(late) + MARGIN if np.isfinite(high) else None
    return start, end
