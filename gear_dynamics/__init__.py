"""Real-time vibration of a simulated spur gear pair; no ROS is needed for this API."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gear_dynamics.bag.reader import read_log
    from gear_dynamics.machine.columns import EventKind
    from gear_dynamics.model.gear_pair import GearPair
    from gear_dynamics.parameters.parameter import ParameterError
    from gear_dynamics.simulation.batch import simulate_batch
    from gear_dynamics.simulation.simulator import IntegrationError, Simulator, simulate

_HOMES = {
    'EventKind': 'gear_dynamics.machine.columns',
    'GearPair': 'gear_dynamics.model.gear_pair',
    'IntegrationError': 'gear_dynamics.simulation.simulator',
    'ParameterError': 'gear_dynamics.parameters.parameter',
    'Simulator': 'gear_dynamics.simulation.simulator',
    'read_log': 'gear_dynamics.bag.reader',
    'simulate': 'gear_dynamics.simulation.simulator',
    'simulate_batch': 'gear_dynamics.simulation.batch',
}

__all__ = [
    'EventKind',
    'GearPair',
    'IntegrationError',
    'ParameterError',
    'Simulator',
    'read_log',
    'simulate',
    'simulate_batch',
]


def __getattr__(name: str) -> Any:
    # Imported when first used: the command line must not wait for the compiler to load.
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
