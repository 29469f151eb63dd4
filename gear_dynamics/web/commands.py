"""Commands of the page: checked by the same parameter lists as those of the node."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, Protocol

from gear_dynamics.parameters.gear_pair import GearPairParameters
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.web.messages import MessageRefusedError, number_of, text_of
from gear_dynamics.web.presets import PRESETS

SETTABLE = ('speed', 'load_torque', 'friction_coefficient')
"""Parameters of the sim that the page sets."""


@dataclasses.dataclass(frozen=True)
class SetValue:
    """Set one of SETTABLE."""

    name: str
    value: float


@dataclasses.dataclass(frozen=True)
class SetFault:
    """Set the severity of a fault; 0 removes it. `tooth` is None for all teeth."""

    kind: str
    severity: float
    wheel: str
    tooth: int | None


@dataclasses.dataclass(frozen=True)
class Pause:
    """Hold the machine, or let it go on."""

    held: bool


@dataclasses.dataclass(frozen=True)
class Reset:
    """Begin again at t = 0."""


@dataclasses.dataclass(frozen=True)
class UsePreset:
    """Run one of presets.PRESETS."""

    name: str


Command = SetValue | SetFault | Pause | Reset | UsePreset


class Controls(Protocol):
    """What carries out commands: a simulator in this process, or a node by topics and services."""

    def carry_out(self, command: Command) -> None:
        """Begin to carry out a command; what comes of it is said in the rig's notices."""


def read_command(content: Mapping[str, Any], fault_kinds: tuple[str, ...]) -> Command:
    """Return the command that a message of the page holds.

    Parameters
    ----------
    content : mapping
    fault_kinds : tuple of str
        Faults that the rig knows, such as 'root_crack'.

    Raises
    ------
    MessageRefusedError
        If it is unknown, or a value is out of its range.
    """
    kind = text_of(content, 'command')
    if kind == 'set':
        name = text_of(content, 'name')
        if name not in SETTABLE:
            raise MessageRefusedError(f'name is {name!r}: it must be one of {", ".join(SETTABLE)}')
        return SetValue(name, number_of({name: content.get('value')}, name, *_range_of(name)))
    if kind == 'fault':
        return _read_fault(content, fault_kinds)
    if kind == 'pause':
        held = content.get('held')
        if not isinstance(held, bool):
            raise MessageRefusedError('held must be true or false')
        return Pause(held)
    if kind == 'reset':
        return Reset()
    if kind == 'preset':
        name = text_of(content, 'name')
        if name not in {preset.name for preset in PRESETS}:
            raise MessageRefusedError(f'there is no preset {name!r}')
        return UsePreset(name)
    raise MessageRefusedError(
        f'command is {kind!r}: it must be one of set, fault, pause, reset, preset'
    )


def _read_fault(content: Mapping[str, Any], fault_kinds: tuple[str, ...]) -> SetFault:
    kind, wheel = text_of(content, 'kind'), text_of(content, 'wheel')
    if kind not in fault_kinds:
        raise MessageRefusedError(f'there is no fault {kind!r}')
    if wheel not in ('pinion', 'gear'):
        raise MessageRefusedError(f'wheel is {wheel!r}: it must be pinion or gear')
    tooth = None
    if content.get('tooth') is not None:
        tooth = int(number_of(content, 'tooth', 0, 999))
    return SetFault(kind, number_of(content, 'severity', 0, 1), wheel, tooth)


def _range_of(name: str) -> tuple[float, float]:
    for about in (*SimSettings.parameters(), *GearPairParameters.parameters()):
        if about.name == name and about.minimum is not None and about.maximum is not None:
            return about.minimum, about.maximum
    raise KeyError(name)
