"""Real-time vibration of a simulated spur gear pair; no ROS is needed for this API.

Names are imported when they are first used: `import gear_dynamics` alone loads no compiler.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gear_dynamics import dynamics, signal, study
    from gear_dynamics.bag.reader import read_log
    from gear_dynamics.bag.write_log import write_log
    from gear_dynamics.machine.columns import EventKind
    from gear_dynamics.machine.machine import Machine
    from gear_dynamics.model import faults
    from gear_dynamics.model.gear_pair import GearPair
    from gear_dynamics.parameters.parameter import ParameterError
    from gear_dynamics.recordings.analyse import analyse
    from gear_dynamics.run_figure import plot
    from gear_dynamics.simulation.batch import simulate_batch
    from gear_dynamics.simulation.run import Run
    from gear_dynamics.simulation.simulate import simulate
    from gear_dynamics.simulation.simulator import Simulator
    from gear_dynamics.simulation.stepping import IntegrationError

    __version__: str

__all__ = [
    'EventKind',
    'GearPair',
    'IntegrationError',
    'Machine',
    'ParameterError',
    'Run',
    'Simulator',
    '__version__',
    'analyse',
    'dynamics',
    'faults',
    'plot',
    'read_log',
    'signal',
    'simulate',
    'simulate_batch',
    'study',
    'write_log',
]

_MODULES = {
    'EventKind': 'machine.columns',
    'GearPair': 'model.gear_pair',
    'IntegrationError': 'simulation.stepping',
    'Machine': 'machine.machine',
    'ParameterError': 'parameters.parameter',
    'Run': 'simulation.run',
    'Simulator': 'simulation.simulator',
    '__version__': 'versions',
    'analyse': 'recordings.analyse',
    'plot': 'run_figure',
    'read_log': 'bag.reader',
    'simulate': 'simulation.simulate',
    'simulate_batch': 'simulation.batch',
    'write_log': 'bag.write_log',
}
"""The module that each name comes from."""

_PACKAGES = {'dynamics': 'dynamics', 'faults': 'model.faults', 'signal': 'signal', 'study': 'study'}
"""Packages of functions."""


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        found: Any = importlib.import_module(f'{__name__}.{_PACKAGES[name]}')
    elif name in _MODULES:
        found = getattr(importlib.import_module(f'{__name__}.{_MODULES[name]}'), name)
    else:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
