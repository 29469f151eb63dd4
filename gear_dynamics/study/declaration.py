"""How a study declares itself to the command line: what it does, and its options."""

from __future__ import annotations

import importlib
import inspect
import math
import pkgutil
from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

from gear_dynamics.study import experiments
from gear_dynamics.study.operating_point import (
    OperatingPoint,
    default_operating_point,
    friction_chaos,
)


class Option(NamedTuple):
    """An option of a study: the argument of the same name of its function, and its help.

    Attributes
    ----------
    text : str
        For the help.
    least : float
        Least value allowed; any number must be finite.
    default : int, float, str, tuple or list, optional
        What the help shows where the function's own default is None. Its type is the option's.
    several : bool
        Whether any number of values may be given, not just as many as the default has.
    """

    text: str
    least: float = -math.inf
    default: Any = None
    several: bool = False

    def check(self, name: str, value: Any) -> None:
        """Refuse a number that is not allowed.

        Raises
        ------
        ValueError
            With the option's name, the value, and what is allowed.
        """
        if isinstance(value, str):
            return
        least = f', {self.least:g} or more' if math.isfinite(self.least) else ''
        kind = 'an integer' if isinstance(value, int) else 'a finite number'
        if not (math.isfinite(value) and value >= self.least):
            option = name.replace('_', '-')
            raise ValueError(f'--{option} is {value:g}: it must be {kind}{least}')


class Study(NamedTuple):
    """What a study says of itself.

    Attributes
    ----------
    summary : str
    preset : callable
        Gives the operating point that is studied without --params.
    options : dict of str to Option
        By the names of the function's arguments.
    sweeps : str
        What is swept, if anything is; an option `parameter` may name another.
    """

    summary: str
    preset: Callable[[], OperatingPoint]
    options: dict[str, Option]
    sweeps: str = ''


TRANSIENT_OPTION = Option('mesh cycles before each record', 0)
CYCLES_OPTION = Option('mesh cycles in each record', 100)
COUNT_OPTION = Option('values in the range', 2)

PRESETS = {
    friction_chaos: 'config/friction_chaos.yaml',
    default_operating_point: 'the default pair',
}
"""Operating points by what the help calls them."""


def study_names() -> list[str]:
    """Return the names of all studies: those of the modules of `experiments`."""
    return sorted(module.name for module in pkgutil.iter_modules(experiments.__path__))


def study_module(name: str) -> ModuleType:
    """Return the module of a study: its `STUDY`, the function of its name, and `draw`."""
    return importlib.import_module(f'{experiments.__name__}.{name}')


def defaults(name: str) -> dict[str, Any]:
    """Return the default of each option of a study."""
    module = study_module(name)
    taken = inspect.signature(getattr(module, name)).parameters
    return {
        option: taken[option].default if what.default is None else what.default
        for option, what in module.STUDY.options.items()
    }
