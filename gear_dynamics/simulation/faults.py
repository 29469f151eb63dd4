"""Faults by parameters and by file, as the `sim` node takes them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gear_dynamics.model.faults import KINDS, Fault
from gear_dynamics.model.faults.collection import fault_of
from gear_dynamics.parameters.parameter import (
    Parameter,
    ParameterError,
    ParameterSet,
    Value,
    refuse_unknown_name,
)
from gear_dynamics.parameters.yaml_text import YamlError, read_yaml

PREFIX = 'fault.'
"""Before the names of all parameters of faults."""


@dataclasses.dataclass(frozen=True)
class FaultSettings(ParameterSet):
    """One fault of each kind, by parameters such as fault.root_crack.severity.

    Raises
    ------
    ParameterError
        If a name is unknown or a value is not allowed.
    """

    values: Mapping[str, Value] = dataclasses.field(default_factory=dict)

    def __post_init__(self) -> None:
        about = {each.name: each for each in self.parameters()}
        for name in self.values:
            refuse_unknown_name(name, about)
        checked = {
            name: each.check(self.values.get(name, each.default)) for name, each in about.items()
        }
        object.__setattr__(self, 'values', checked)
        self.faults()

    @classmethod
    def parameters(cls) -> tuple[Parameter, ...]:
        """Return the fields of every kind of fault, healthy by default."""
        return tuple(
            dataclasses.replace(
                about,
                name=f'{PREFIX}{kind}.{about.name}',
                default=0.0 if about.name == 'severity' else about.default,
                description=f'{kind}: {about.description}',
            )
            for kind, each in KINDS.items()
            for about in each.parameters()
        )

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> FaultSettings:
        """Make the set from a mapping, taking the names that begin with `fault.`."""
        return cls({name: value for name, value in values.items() if name.startswith(PREFIX)})

    def to_mapping(self) -> dict[str, Value]:
        """Return names and values."""
        return dict(self.values)

    def faults(self) -> tuple[Fault, ...]:
        """Return the faults of a severity above 0."""
        found = []
        for kind, each in KINDS.items():
            begin = f'{PREFIX}{kind}.'
            given = {
                name.removeprefix(begin): value
                for name, value in self.values.items()
                if name.startswith(begin)
            }
            found.append(each(**given))
        return tuple(fault for fault in found if fault.severity > 0)


def fault_values(kind: str, values: Mapping[str, Any]) -> dict[str, Value]:
    """Return the parameters of a fault by name, as far as its kind has them; -1 is all teeth."""
    tooth = values.get('tooth')
    given = {**values, 'tooth': -1 if tooth is None else int(tooth)}
    names = {f'{PREFIX}{kind}.{name}': value for name, value in given.items()}
    known = {about.name for about in FaultSettings.parameters()}
    return {name: value for name, value in names.items() if name in known}


def read_faults(path: str | Path) -> list[Fault]:
    """Read a list of faults.

    Parameters
    ----------
    path : str or Path
        YAML file such as `- {fault: root_crack, wheel: pinion, tooth: 5, severity: 0.4}`.

    Raises
    ------
    ParameterError
        If the file cannot be read, or has anything but faults.
    """
    try:
        content = read_yaml(path)
    except YamlError as error:
        raise ParameterError(f'{path}: {error}') from None
    if not isinstance(content, list) or not all(isinstance(each, Mapping) for each in content):
        raise ParameterError(
            f'{path}: must be a list of faults, such as - {{fault: root_crack, severity: 0.4}}'
        )
    try:
        return [fault_of(each) for each in content]
    except ParameterError as error:
        raise ParameterError(f'{path}: {error}') from None
