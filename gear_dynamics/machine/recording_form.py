"""How recordings of a machine are laid out, and the limits of their severity."""

from __future__ import annotations

import dataclasses

from gear_dynamics.machine.source import Time

FILES = ('joined', 'channels', 'series')
"""Several files are one recording end to end, channels side by side, or recordings with pauses."""

_LARGE_RIGID = (2.3, 4.5, 7.1)
ISO_10816_3 = {
    (1, 'rigid'): _LARGE_RIGID,
    (1, 'flexible'): (3.5, 7.1, 11.0),
    (2, 'rigid'): (1.4, 2.8, 4.5),
    (2, 'flexible'): _LARGE_RIGID,
}
"""Zone limits A/B, B/C, C/D of the velocity RMS [mm/s], by group (1: large, 2: medium machines)
and support: ISO 10816-3:2009, tables A.1 and A.2."""

ZONES = ('A', 'B', 'C', 'D')


@dataclasses.dataclass(frozen=True)
class Rows:
    """Names of the columns of a table with one channel a row.

    Attributes
    ----------
    name, samples : str
        Columns with the channel's name, and with all of its samples.
    rate, unit : str, optional
        Columns with its sample rate [Hz], and its unit.
    """

    name: str
    samples: str
    rate: str | None = None
    unit: str | None = None


@dataclasses.dataclass(frozen=True)
class RecordingForm:
    """What holds for all channels of a recording, unless a channel says otherwise.

    Attributes
    ----------
    sample_rate : float or str, optional
        [Hz], or the column that holds it; None: it stands in the file.
    time : Time, optional
        Columns from which the rate follows.
    span : float, optional
        Seconds in a row of the result; None: the whole recording.
    files : str
        One of FILES.
    rows : Rows, optional
        For tables with one channel a row.
    """

    sample_rate: float | str | None = None
    time: Time | None = None
    span: float | None = 1.0
    files: str = 'joined'
    rows: Rows | None = None


@dataclasses.dataclass(frozen=True)
class Severity:
    """Zone limits of the velocity RMS from 10 to 1000 Hz [m/s], and where they come from."""

    limits: tuple[float, float, float]
    origin: str = 'machine file'

    def zone(self, velocity_rms: float) -> str:
        """Return the zone, A to D, of a velocity RMS [m/s]."""
        return ZONES[sum(velocity_rms > limit for limit in self.limits)]
