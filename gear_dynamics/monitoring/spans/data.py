"""A span of a recording or of a stream, as the analysis takes it, and what it gives back."""

from __future__ import annotations

import dataclasses

import numpy as np

from gear_dynamics.signal.bearing import DefectLine, EnvelopeOrders
from gear_dynamics.signal.shaft_phase import ShaftPhase


@dataclasses.dataclass(frozen=True)
class Signal:
    """Samples of a channel, a tachometer, an angle or a speed.

    Attributes
    ----------
    values : ndarray, shape (n,)
        Of a channel in its SI unit, of others as recorded.
    rate : float
        [Hz]
    start : float
        Time of the first sample [s].
    """

    values: np.ndarray
    rate: float
    start: float

    @property
    def time(self) -> np.ndarray:
        """Instants of the samples [s]."""
        return self.start + np.arange(len(self.values)) / self.rate


@dataclasses.dataclass(frozen=True)
class Span:
    """All signals over the same stretch of time.

    Attributes
    ----------
    start, duration : float
        [s]
    channels : dict of str to Signal
        By the channel's name; one that is missing in this span is not in it.
    shafts : dict of str to Signal
        What tells the speed of a shaft, by the shaft's name.
    """

    start: float
    duration: float
    channels: dict[str, Signal]
    shafts: dict[str, Signal]


@dataclasses.dataclass(frozen=True)
class ShaftState:
    """A shaft in a span.

    Attributes
    ----------
    phase : ShaftPhase or None
        None if it could not be found; `note` says why.
    origin : str
        Where the angle comes from: tacho, angle, speed, fixed or tracked.
    uncertainty : float
        Standard deviation of a tracked mean speed [revolutions/s], otherwise NaN.
    at_limit : bool
        Whether a tracked speed stays at a limit of its range.
    note : str
    """

    phase: ShaftPhase | None
    origin: str
    uncertainty: float = float('nan')
    at_limit: bool = False
    note: str = ''


@dataclasses.dataclass(frozen=True)
class Average:
    """The synchronous average of a channel over a shaft's revolutions.

    Attributes
    ----------
    values : ndarray, shape (points,)
        One revolution, without the orders beyond the accurate band.
    revolutions : int
    highest_order : float
        Orders above it are left out.
    share : float
        Share of the channel's variance that is synchronous with the shaft, 0 to 1.
    """

    values: np.ndarray
    revolutions: int
    highest_order: float
    share: float


@dataclasses.dataclass(frozen=True)
class BearingState:
    """The lines of a bearing in a channel.

    Attributes
    ----------
    lines : dict of str to DefectLine
        By defect.
    named : str
        The defect that wins clearly, `undecided` where several do not let one win, or empty.
    spectrum : EnvelopeOrders
    band : tuple of float
        Limits of the band of the envelope [Hz].
    """

    lines: dict[str, DefectLine]
    named: str
    spectrum: EnvelopeOrders
    band: tuple[float, float]


@dataclasses.dataclass
class SpanResult:
    """What a span showed.

    Attributes
    ----------
    values : dict of str to float or bool
        A row of the table, by column.
    notes : list of str
        What must be known to read the row.
    shafts : dict of str to ShaftState
    averages : dict of (str, str) to Average
        By channel and shaft.
    bearings : dict of (str, str) to BearingState
        By channel and bearing.
    """

    values: dict[str, float | bool]
    notes: list[str]
    shafts: dict[str, ShaftState]
    averages: dict[tuple[str, str], Average]
    bearings: dict[tuple[str, str], BearingState]
