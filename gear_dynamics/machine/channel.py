"""A channel: what is measured, where it stands in a recording, and in what unit."""

from __future__ import annotations

import dataclasses

from gear_dynamics.machine.source import Source
from gear_dynamics.machine.units import UNKNOWN, unit


@dataclasses.dataclass(frozen=True)
class Channel:
    """A measured signal.

    Attributes
    ----------
    name : str
    source : Source
    recorded_unit : str
        Of the values in the recording; `unknown` where nobody stated it.
    quantity : str
        Unit of what the sensor measures; `recorded_unit` without a sensor in between.
    sensitivity : float, optional
        Of the sensor, in recorded units per unit of the quantity.
    full_scale : float, optional
        Value of full scale in the recorded unit, for files that hold shares of it (WAV).
    """

    name: str
    source: Source = dataclasses.field(default_factory=Source)
    recorded_unit: str = UNKNOWN
    quantity: str = ''
    sensitivity: float | None = None
    full_scale: float | None = None

    @property
    def unit(self) -> str:
        """The SI unit of the values after `scale`."""
        return unit(self.quantity or self.recorded_unit).si

    @property
    def scale(self) -> float:
        """Factor from a recorded value to the SI unit."""
        factor = self.full_scale or 1.0
        if self.sensitivity is None:
            return factor * unit(self.recorded_unit).factor
        return factor / self.sensitivity * unit(self.quantity).factor
