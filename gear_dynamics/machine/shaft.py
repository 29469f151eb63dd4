"""A shaft, and the ways in which its speed or its angle is known."""

from __future__ import annotations

import dataclasses

from gear_dynamics.machine.source import Source


@dataclasses.dataclass(frozen=True)
class Tacho:
    """Pulses of a tachometer.

    Attributes
    ----------
    source : Source
    pulses : float
        Pulses in a revolution.
    level : float, optional
        Value at which a rising edge counts, in the recording's unit; half-way between the lowest
        and the highest values by default.
    """

    source: Source
    pulses: float = 1.0
    level: float | None = None


@dataclasses.dataclass(frozen=True)
class Angle:
    """An angle, wrapped or not.

    Attributes
    ----------
    source : Source
    revolution : float
        Values in a revolution: the counts of an encoder, 2 pi, or 360.
    """

    source: Source
    revolution: float


@dataclasses.dataclass(frozen=True)
class SpeedColumn:
    """A recorded speed: a column, or one number for the whole recording.

    Attributes
    ----------
    source : Source
    unit : str
        Of speed, such as rpm or Hz.
    """

    source: Source
    unit: str = 'rpm'


@dataclasses.dataclass(frozen=True)
class FixedSpeed:
    """A speed that is known and constant [rad/s]."""

    speed: float


@dataclasses.dataclass(frozen=True)
class TrackedSpeed:
    """A speed found from lines of the vibration itself.

    Attributes
    ----------
    lowest, highest : float
        Range that it is looked for in [rad/s].
    channel : str, optional
        That holds the line; any by default.
    order : float, optional
        Of the line, in events a revolution; by default the lines of the shaft, its meshes and
        its bearings are tried together.
    """

    lowest: float
    highest: float
    channel: str | None = None
    order: float | None = None


@dataclasses.dataclass(frozen=True)
class DrivenBy:
    """A speed that follows from the other wheel of a mesh, by name."""

    mesh: str


SpeedSource = Tacho | Angle | SpeedColumn | FixedSpeed | TrackedSpeed | DrivenBy


@dataclasses.dataclass(frozen=True)
class Shaft:
    """A shaft.

    Attributes
    ----------
    name : str
    speed : SpeedSource, optional
        None: unknown, so that nothing of this shaft is counted in revolutions.
    inertia : float, optional
        Polar inertia with all that turns with it [kg m2], where it is known.
    """

    name: str
    speed: SpeedSource | None = None
    inertia: float | None = None
