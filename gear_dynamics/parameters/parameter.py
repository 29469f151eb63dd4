"""One described, range-checked parameter: the building block of every parameter list.

A list of parameters is a frozen dataclass whose fields are made by `parameter`. The dataclass,
the YAML files, the ROS descriptors, `--help` and the README's table all follow from it.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
from collections.abc import Collection, Mapping
from typing import Any, TypeVar

Value = bool | int | float | str | list[str]
_Set = TypeVar('_Set', bound='ParameterSet')


class ParameterError(ValueError):
    """A parameter has a value that is not allowed; the message names both and the remedy."""


@dataclasses.dataclass(frozen=True)
class Parameter:
    """What is known of one parameter besides its value.

    Attributes
    ----------
    name : str
        Dataclass field, YAML key and ROS parameter alike.
    default : bool, int, float, str or list of str
        Its type is the parameter's type.
    description : str
        One line without a full stop.
    unit : str
        SI unit, or that which the name carries; empty for a pure number.
    minimum, maximum : float or None
        Inclusive range of a number.
    choices : tuple of str
        The words allowed, for a text; empty means any.
    live : bool
        Whether it may change while a node runs.
    """

    name: str
    default: Value
    description: str
    unit: str = ''
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()
    live: bool = False

    def allowed(self) -> str:
        """Return in words what values are allowed, for messages and tables."""
        if self.choices:
            return ' or '.join(repr(choice) for choice in self.choices)
        if isinstance(self.default, bool):
            return 'true or false'
        if isinstance(self.default, list):
            return 'a list of texts'
        if isinstance(self.default, str):
            return 'a text'
        kind = 'an integer' if isinstance(self.default, int) else 'a finite number'
        if self.minimum is None or self.maximum is None:
            return kind
        unit = f' {self.unit}' if self.unit else ''
        form = '.0f' if isinstance(self.default, int) else 'g'
        return f'{kind} from {self.minimum:{form}} to {self.maximum:{form}}{unit}'

    def check(self, value: Any) -> Value:
        """Return `value` in the parameter's own type.

        A number may come as an integer or as text such as '5.33e8', which is what PyYAML makes
        of a number without a decimal point.

        Raises
        ------
        ParameterError
            If the value has the wrong type or is out of range.
        """
        converted = self._convert(value)
        if converted is None or not self._in_range(converted):
            raise ParameterError(f'{self.name} is {value!r}: it must be {self.allowed()}')
        return converted

    def _convert(self, value: Any) -> Value | None:
        if isinstance(self.default, bool):
            return value if isinstance(value, bool) else None
        if isinstance(self.default, list):
            if not isinstance(value, list | tuple):
                return None
            return list(value) if all(isinstance(item, str) for item in value) else None
        if isinstance(self.default, str):
            return value if isinstance(value, str) else None
        if isinstance(value, bool):
            return None
        try:
            number = float(value)
        except (TypeError, ValueError, OverflowError):
            return None
        if not math.isfinite(number):
            return None
        if isinstance(self.default, int):
            return int(number) if number.is_integer() else None
        return number

    def _in_range(self, value: Value) -> bool:
        if self.choices:
            return value in self.choices
        if isinstance(value, bool | str | list):
            return True
        above = self.minimum is None or value >= self.minimum
        below = self.maximum is None or value <= self.maximum
        return above and below


def parameter(
    default: Any,
    description: str,
    *,
    unit: str = '',
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
    live: bool = False,
) -> Any:
    """Declare a field of a `ParameterSet`; the arguments are those of `Parameter`."""
    about = {
        'description': description,
        'unit': unit,
        'minimum': minimum,
        'maximum': maximum,
        'choices': choices,
        'live': live,
    }
    if isinstance(default, list):
        return dataclasses.field(default_factory=lambda: list(default), metadata=about)
    return dataclasses.field(default=default, metadata=about)


@dataclasses.dataclass(frozen=True)
class ParameterSet:
    """Base of the frozen dataclasses that are parameter lists; checks every value when made."""

    def __post_init__(self) -> None:
        for about in self.parameters():
            object.__setattr__(self, about.name, about.check(getattr(self, about.name)))

    @classmethod
    def parameters(cls) -> tuple[Parameter, ...]:
        """Return the list, in the order of declaration."""
        return tuple(
            Parameter(name=field.name, default=_default(field), **field.metadata)
            for field in dataclasses.fields(cls)
            if field.metadata
        )

    @classmethod
    def from_mapping(cls: type[_Set], values: Mapping[str, Any]) -> _Set:
        """Make the set from a mapping, taking its own names and leaving others alone."""
        names = {field.name for field in dataclasses.fields(cls)}
        return cls(**{name: value for name, value in values.items() if name in names})

    def to_mapping(self) -> dict[str, Value]:
        """Return names and values of the parameters, in the order of declaration."""
        return {about.name: getattr(self, about.name) for about in self.parameters()}


def refuse_unknown_name(name: str, known: Collection[str]) -> None:
    """Refuse a name that is not known.

    Raises
    ------
    ParameterError
        With the nearest known name.
    """
    if name not in known:
        near = difflib.get_close_matches(name, sorted(known), n=1, cutoff=0.0)[0]
        raise ParameterError(f'{name} is not a parameter; the nearest name is {near}')


def _default(field: dataclasses.Field[Any]) -> Any:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default
