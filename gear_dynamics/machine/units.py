"""Units of recordings, and their factors to SI."""

from __future__ import annotations

import difflib
import math
from typing import NamedTuple

UNKNOWN = 'unknown'
"""The unit of a channel whose unit nobody stated; its values stay as recorded."""

RPM = 2 * math.pi / 60
"""A revolution a minute [rad/s]."""

GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s2] (CGPM 1901)."""


class Unit(NamedTuple):
    """The SI unit that a unit is converted to, and the factor to it."""

    si: str
    factor: float


_FACTORS = {
    'm/s2': {'m/s2': 1.0, 'mm/s2': 1e-3, 'g': GRAVITY, 'mg': 1e-3 * GRAVITY, 'in/s2': 0.0254},
    'm/s': {'m/s': 1.0, 'mm/s': 1e-3, 'in/s': 0.0254},
    'm': {'m': 1.0, 'mm': 1e-3, 'um': 1e-6, 'mil': 2.54e-5},
    'V': {'V': 1.0, 'mV': 1e-3, 'uV': 1e-6},
    'A': {'A': 1.0, 'mA': 1e-3},
    'N': {'N': 1.0, 'kN': 1e3},
    'N m': {'N m': 1.0, 'Nm': 1.0, 'kNm': 1e3},
    'Pa': {'Pa': 1.0, 'kPa': 1e3, 'MPa': 1e6, 'bar': 1e5},
    'W': {'W': 1.0, 'kW': 1e3},
    'rad/s': {'rad/s': 1.0, 'rpm': RPM, 'Hz': 2 * math.pi, 'deg/s': math.pi / 180},
    'rad': {'rad': 1.0, 'deg': math.pi / 180, 'rev': 2 * math.pi},
    's': {'s': 1.0, 'ms': 1e-3, 'us': 1e-6, 'ns': 1e-9, 'min': 60.0, 'h': 3600.0, 'day': 86400.0},
    'degC': {'degC': 1.0},
    'counts': {'counts': 1.0},
    '1': {'1': 1.0, '%': 0.01},
    UNKNOWN: {UNKNOWN: 1.0},
}

UNITS = {name: Unit(si, factor) for si, group in _FACTORS.items() for name, factor in group.items()}
"""Every known unit by its name."""

_SPELLINGS = {'²': '2', '^': '', '**': '', 'µ': 'u', 'μ': 'u', '°': 'deg', '·': ' '}


def unit(name: str) -> Unit:
    """Return a unit by its name; `m/s^2`, `m/s²` and `µm` are understood as well.

    Raises
    ------
    ValueError
        If the unit is not known; the message names the nearest that is.
    """
    plain = name.strip()
    for spelling, replacement in _SPELLINGS.items():
        plain = plain.replace(spelling, replacement)
    if plain in UNITS:
        return UNITS[plain]
    nearest = difflib.get_close_matches(plain, UNITS, 1, 0)[0]
    raise ValueError(f'unit {name!r} is not known: the nearest that is is {nearest!r}')


def factor(name: str, si: str) -> float:
    """Return the factor from a unit to the SI unit that it must belong to.

    Raises
    ------
    ValueError
        If the unit is not known or measures something else.
    """
    found = unit(name)
    if found.si != si:
        raise ValueError(f'unit {name!r} is no unit of this quantity: it must convert to {si}')
    return found.factor
