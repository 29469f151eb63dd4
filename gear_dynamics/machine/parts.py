"""Wheels, meshes and bearings, and the orders in which they show."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

DEFECTS = ('outer', 'inner', 'element', 'cage')
"""The parts of a rolling bearing that can be damaged, as in the names of indicators."""


@dataclasses.dataclass(frozen=True)
class Wheel:
    """A gear wheel: the name of its shaft, and its number of teeth."""

    name: str
    shaft: str
    teeth: int


@dataclasses.dataclass(frozen=True)
class Mesh:
    """Two wheels that mesh.

    Attributes
    ----------
    name : str
    driver, driven : str
        Names of the wheels.
    displacement, velocity : str, optional
        Columns with the relative displacement on the line of action [m] and its rate [m/s], of a
        simulated mesh.
    half_backlash : float, optional
        Scale of the displacement [m].
    natural_frequency : float, optional
        Scale of time [rad/s].
    """

    name: str
    driver: str
    driven: str
    displacement: str | None = None
    velocity: str | None = None
    half_backlash: float | None = None
    natural_frequency: float | None = None


@dataclasses.dataclass(frozen=True)
class Bearing:
    """A rolling bearing whose outer race stands still.

    Attributes
    ----------
    name : str
    shaft : str
        That its inner race turns with.
    orders : mapping of str to float
        Of DEFECTS, those that are watched: events a revolution of the shaft by a damage there. A
        damaged element meets both races, so that its order is twice its spin.
    channels : tuple of str
        The channels near it; all that measure vibration, if empty.
    slip : float
        Greatest relative difference of the measured orders from these.
    """

    name: str
    shaft: str
    orders: Mapping[str, float]
    channels: tuple[str, ...] = ()
    slip: float = 0.02

    @property
    def impacts(self) -> tuple[float, ...]:
        """Orders of the races, or of what is watched where these are not."""
        races = [self.orders[each] for each in ('outer', 'inner') if each in self.orders]
        return tuple(races or self.orders.values())


def bearing_orders(
    elements: int,
    element_diameter: float,
    pitch_diameter: float,
    contact_angle_deg: float = 0.0,
) -> dict[str, float]:
    """Return the orders of the defects of a bearing without slip, by name.

    Randall and Antoni 2011, Rolling element bearing diagnostics - a tutorial, equations 1 to 4.

    Parameters
    ----------
    elements : int
        Balls or rollers.
    element_diameter, pitch_diameter : float
        In the same unit.
    contact_angle_deg : float
        [deg]

    Raises
    ------
    ValueError
        If there is no such bearing.
    """
    if elements < 3:
        raise ValueError(f'elements is {elements}: a bearing has at least 3')
    if not 0 < element_diameter < pitch_diameter:
        raise ValueError(
            f'element_diameter is {element_diameter:g} and pitch_diameter {pitch_diameter:g}: '
            'both must be above 0, and the pitch diameter the greater'
        )
    if not 0 <= contact_angle_deg < 90:
        raise ValueError(f'contact_angle_deg is {contact_angle_deg:g}: it must be from 0 to 90')
    ratio = element_diameter / pitch_diameter * math.cos(math.radians(contact_angle_deg))
    return {
        'outer': elements / 2 * (1 - ratio),
        'inner': elements / 2 * (1 + ratio),
        'element': pitch_diameter / element_diameter * (1 - ratio**2),
        'cage': (1 - ratio) / 2,
    }
