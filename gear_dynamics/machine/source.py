"""Where the values of a channel, a tacho or a speed stand in a recording."""

from __future__ import annotations

import dataclasses


@dataclasses.dataclass(frozen=True)
class Time:
    """The columns that hold the time of each sample.

    Attributes
    ----------
    columns : tuple of str or int
        One column, or several that are added (hours, minutes, seconds, microseconds).
    units : tuple of str
        Unit of each column.
    """

    columns: tuple[str | int, ...]
    units: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Source:
    """Where values stand in a recording.

    Attributes
    ----------
    column : str or int, optional
        A name, a path (`bearing.gs`), a wildcard (`*_DE_time`) that must match one column, or a
        number counted from 1; None where the file holds one column.
    file : str, optional
        Wildcard that matches the name of a given recording.
    topic : str, optional
        Topic of an MCAP log.
    sample_rate : float or str, optional
        [Hz], or the column that holds it; that of the machine file by default.
    time : Time, optional
        That of the machine file by default.
    """

    column: str | int | None = None
    file: str | None = None
    topic: str | None = None
    sample_rate: float | str | None = None
    time: Time | None = None
