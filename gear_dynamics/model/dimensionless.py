"""Parameter files of published models, by their dimensionless numbers."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gear_dynamics.parameters.files import read_dimensionless, read_parameters
from gear_dynamics.parameters.parameter import ParameterError, refuse_unknown_name

if TYPE_CHECKING:
    from gear_dynamics.model.gear_pair import GearPair

OPERATION = ('frequency_ratio', 'mean_load')
"""What belongs to the operating point: w, and the mesh force of the load over k b."""

NUMBERS = (*OPERATION, 'damping_ratio', 'error_amplitude', 'error_phase', 'half_backlash')
"""What must be a number."""


def read_rig(path: str | Path, node: str = '/gear_sim') -> dict[str, Any]:
    """Return the parameters of a pair, and what else a parameter file has for a node.

    A file with `dimensionless` alone at its top gives the arguments of
    `GearPair.from_dimensionless` with `frequency_ratio` and `mean_load`; they are returned as the
    parameters, `speed` and `load_torque` that follow.

    Raises
    ------
    ParameterError
        As `read_parameters`, or if a number is missing or not allowed.
    """
    numbers = read_dimensionless(path)
    if numbers is None:
        return read_parameters(path, node)
    try:
        return rig_of(numbers)
    except ParameterError as error:
        raise ParameterError(f'{path}: {error}') from None


def rig_of(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters, speed and load torque of a model given by dimensionless numbers.

    Raises
    ------
    ParameterError
        If a number is missing, unknown or not allowed.
    """
    from gear_dynamics.model.gear_pair import GearPair

    needed = ('damping_ratio', 'error_amplitude', *OPERATION)
    missing = [name for name in needed if name not in numbers]
    if missing:
        raise ParameterError(f'dimensionless has no {missing[0]}: give {", ".join(needed)}')
    numbers = {name: _plain(name, value) for name, value in numbers.items()}
    arguments = inspect.signature(GearPair.from_dimensionless).parameters
    known = {*arguments, *OPERATION, *(about.name for about in GearPair.parameters())} - {'others'}
    for name in numbers:
        refuse_unknown_name(name, known)
    pair = GearPair.from_dimensionless(
        **{name: value for name, value in numbers.items() if name not in OPERATION}
    )
    ratio, load = (numbers[name] for name in OPERATION)
    return pair.to_mapping() | {
        'speed': ratio * pair.derived.wn / pair.pinion_teeth,
        'load_torque': torque_of(pair, load),
    }


def torque_of(pair: GearPair, mean_load: float) -> float:
    """Return the load torque [N m] of a mesh force over k b."""
    d = pair.derived
    return mean_load * d.single_stiffness * pair.half_backlash * d.gear_base_radius


def _plain(name: str, value: Any) -> Any:
    """Return a number as a float, as YAML reads 1e-3 as text; leave anything else as it is."""
    if isinstance(value, bool):
        return value
    try:
        return float(value)
    except (TypeError, ValueError):
        if name in NUMBERS:
            raise ParameterError(f'{name} is {value!r}: it must be a number') from None
        return value
