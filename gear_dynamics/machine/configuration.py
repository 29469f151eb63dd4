"""What a listener must know of the rig, read from the text of `gear_pair/configuration`."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.rig import rig_machine
from gear_dynamics.parameters.yaml_text import YamlError, parse_yaml


@dataclasses.dataclass(frozen=True)
class Rig:
    """What the analysis must know of the rig that it listens to.

    Attributes
    ----------
    pinion_teeth, gear_teeth : int
    wn : float
        Scale of dimensionless time [rad/s].
    half_backlash : float
        Scale of lengths [m].
    sample_rate : float
        Samples per second of model time [Hz].
    block_size : int
        Samples in one message.
    section_phase : float
        Mesh phase at which the exact section states are taken [cycles].
    pinion_inertia, gear_inertia : float
        Polar inertias, by which the angles of both wheels give the rotation of the rigid pair
        [kg m2].
    real_time_factor : float
        Pace of the sim; 0 is as fast as its listeners allow.
    replay_pass : int
        How often the log is being played, if the stream is a log in a loop: stamps begin anew with
        each pass.
    described : Machine or None
        The machine that the text describes; None in logs of before it did.
    """

    pinion_teeth: int
    gear_teeth: int
    wn: float
    half_backlash: float
    sample_rate: float
    block_size: int
    section_phase: float
    pinion_inertia: float
    gear_inertia: float
    real_time_factor: float = 1.0
    replay_pass: int = 1
    described: Machine | None = None

    @property
    def machine(self) -> Machine:
        """The rig as a machine: as it is described, or as every rig was that is not."""
        if self.described is not None:
            return self.described
        return rig_machine(
            self.pinion_teeth,
            self.gear_teeth,
            self.pinion_inertia,
            self.gear_inertia,
            self.half_backlash,
            self.wn,
        )

    @classmethod
    def from_text(cls, text: str) -> Rig:
        """Read the rig from the text of `gear_pair/configuration`.

        Raises
        ------
        ValueError
            With one line, if the text is no such configuration.
        """
        try:
            content = parse_yaml(text)
        except YamlError as error:
            raise ValueError(f'the configuration: {error}') from None
        parameters = _part(content, 'parameters')
        derived = _part(content, 'derived')
        return cls(
            pinion_teeth=_count(parameters, 'pinion_teeth'),
            gear_teeth=_count(parameters, 'gear_teeth'),
            wn=_positive(derived, 'wn'),
            half_backlash=_positive(parameters, 'half_backlash'),
            sample_rate=_positive(parameters, 'sample_rate'),
            block_size=_count(parameters, 'block_size'),
            section_phase=_number(parameters, 'section_phase'),
            pinion_inertia=_positive(derived, 'pinion_inertia'),
            gear_inertia=_positive(derived, 'gear_inertia'),
            real_time_factor=_number({'real_time_factor': 1.0, **parameters}, 'real_time_factor'),
            replay_pass=_count({'pass': 1, **_replay(content)}, 'pass'),
            described=_machine(content),
        )


def _part(content: Any, name: str) -> Mapping[str, Any]:
    part = content.get(name) if isinstance(content, Mapping) else None
    if not isinstance(part, Mapping):
        raise ValueError(f'the configuration has no mapping {name}')
    return part


def _replay(content: Mapping[str, Any]) -> Mapping[str, Any]:
    return _part(content, 'replay') if 'replay' in content else {}


def _machine(content: Mapping[str, Any]) -> Machine | None:
    if 'machine' not in content:
        return None
    try:
        return Machine.from_mapping(_part(content, 'machine'))
    except ValueError as error:
        raise ValueError(f'machine of the configuration: {error}') from None


def _number(values: Mapping[str, Any], name: str) -> float:
    value = values.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f'{name} of the configuration is {value!r}: it must be a finite number')
    return float(value)


def _positive(values: Mapping[str, Any], name: str) -> float:
    number = _number(values, name)
    if number <= 0:
        raise ValueError(f'{name} of the configuration is {number:g}: it must be above 0')
    return number


def _count(values: Mapping[str, Any], name: str) -> int:
    number = _positive(values, name)
    if not number.is_integer():
        raise ValueError(f'{name} of the configuration is {number:g}: it must be an integer')
    return int(number)
