"""A gear pair from a parameter file, with the operating point that the file gives."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from gear_dynamics.model.dimensionless import read_rig
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.parameter import ParameterError, Value
from gear_dynamics.parameters.settings import SimSettings

OPERATION = ('speed', 'load_torque')
"""Settings that are taken over with the pair, where the file has them."""


class PairFile(NamedTuple):
    """What a parameter file says of a gear pair."""

    pair: GearPair
    operation: dict[str, Value]


def read_pair(path: str | Path, node: str = '/gear_sim') -> PairFile:
    """Read a gear pair, and the commands of its file.

    Parameters
    ----------
    path : str or Path
        ROS parameter file.
    node : str
        Full name of the node, to tell the file's sections apart.

    Raises
    ------
    ParameterError
        In one line, if the file cannot be read or has a value that is not allowed.
    """
    pair, values = GearPair.from_yaml(path, node), read_rig(path, node)
    about = {each.name: each for each in SimSettings.parameters()}
    try:
        given = {name: about[name].check(values[name]) for name in OPERATION if name in values}
    except ParameterError as error:
        raise ParameterError(f'{path}: {error}') from None
    return PairFile(pair, given)
