"""Experiments on the model, with their data and figures; each is a sub-command of `study` too."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gear_dynamics.study.attractor_portrait import attractor
    from gear_dynamics.study.basin_map import basins
    from gear_dynamics.study.frequency_response import response
    from gear_dynamics.study.friction_spectrum import spectrum
    from gear_dynamics.study.lyapunov_table import lyapunov
    from gear_dynamics.study.operation import (
        Operation,
        default_operation,
        friction_chaos,
        read_operation,
    )
    from gear_dynamics.study.orbit_diagram import bifurcation
    from gear_dynamics.study.tasks import Runner

_HOMES = {
    'Operation': 'operation',
    'Runner': 'tasks',
    'attractor': 'attractor_portrait',
    'basins': 'basin_map',
    'bifurcation': 'orbit_diagram',
    'default_operation': 'operation',
    'friction_chaos': 'operation',
    'lyapunov': 'lyapunov_table',
    'read_operation': 'operation',
    'response': 'frequency_response',
    'spectrum': 'friction_spectrum',
}

__all__ = [
    'Operation',
    'Runner',
    'attractor',
    'basins',
    'bifurcation',
    'default_operation',
    'friction_chaos',
    'lyapunov',
    'read_operation',
    'response',
    'spectrum',
]


def __getattr__(name: str) -> Any:
    # Imported when first used: the command line must not wait for the compiler to load.
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(importlib.import_module(f'{__name__}.{_HOMES[name]}'), name)
