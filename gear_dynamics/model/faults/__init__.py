"""Faults of a gear pair, one file each: data for the ports of the model.

`KINDS` has every fault by its name in parameters and labels, such as 'root_crack'. A file in this
folder that defines a `Fault` is found by itself.
"""

from __future__ import annotations

import importlib
import pkgutil
from typing import Any

from gear_dynamics.model.faults.fault import Fault, SpeedAndLoad, WheelFault
from gear_dynamics.model.faults.faulty_pair import FaultyPair, faulty

_modules = [
    importlib.import_module(f'{__name__}.{each.name}') for each in pkgutil.iter_modules(__path__)
]

KINDS: dict[str, type[Fault]] = {
    each.kind(): each
    for module in _modules
    for each in vars(module).values()
    if isinstance(each, type) and issubclass(each, Fault) and each.__module__ == module.__name__
    if each not in (Fault, WheelFault)
}
"""The classes of faults by name."""

_CLASSES = {each.__name__: each for each in KINDS.values()}

__all__ = ['KINDS', 'Fault', 'FaultyPair', 'SpeedAndLoad', 'faulty', *_CLASSES]


def __getattr__(name: str) -> Any:
    if name not in _CLASSES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return _CLASSES[name]


def __dir__() -> list[str]:
    return sorted([*globals(), *_CLASSES])
