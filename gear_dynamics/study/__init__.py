"""Experiments on the model, with their data and figures; each is a sub-command of `study` too.

The function of each study has the name of its module in `experiments`.
"""

from __future__ import annotations

import pkgutil
from typing import Any

from gear_dynamics.lazy import load
from gear_dynamics.study import experiments as _experiments

_HOMES = {
    'OperatingPoint': 'operating_point',
    'Runner': 'tasks',
    'default_operating_point': 'operating_point',
    'friction_chaos': 'operating_point',
    'read_operating_point': 'operating_point',
} | {name: f'experiments.{name}' for _, name, _ in pkgutil.iter_modules(_experiments.__path__)}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    # Imported when first used: the command line must not wait for the compiler to load.
    return load(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
