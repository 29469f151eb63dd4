"""The gear pair: its parameters, checked, and what follows from them."""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path
from typing import Any

from gear_dynamics.model.derived import Derived, derive
from gear_dynamics.model.mesh.healthy import healthy_ports
from gear_dynamics.model.ports import Ports
from gear_dynamics.parameters.gear_pair import GearPairParameters
from gear_dynamics.parameters.parameter import ParameterError


@dataclasses.dataclass(frozen=True)
class GearPair(GearPairParameters):
    """A spur gear pair on elastic supports; values are SI except where the name says otherwise.

    Frozen: change a value with `dataclasses.replace(pair, friction_coefficient=0.0)`.

    Raises
    ------
    ParameterError
        If a value is out of its range, or the geometry has no continuous, undisturbed contact.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        self.derived  # noqa: B018  (geometry without continuous contact is refused here)
        self.healthy_ports  # noqa: B018  (and so are malformed texts)

    @functools.cached_property
    def derived(self) -> Derived:
        """Geometry, masses, damping and scales that follow from the parameters."""
        return derive(self)

    @functools.cached_property
    def healthy_ports(self) -> Ports:
        """How the healthy pair departs from the nominal rectangle and sine."""
        return healthy_ports(self)

    # The model knows no YAML: what does is loaded only by those who ask for it.

    @classmethod
    def from_yaml(cls, path: str | Path, node: str = '/gear_sim') -> GearPair:
        """Read the gear pair that a node would have with this parameter file.

        Parameters
        ----------
        path : str or Path
            ROS parameter file; names that it does not give keep their defaults.
        node : str
            The node's full name, such as '/rig1/gear_sim', to tell the file's sections apart.

        Raises
        ------
        ParameterError
            If the file cannot be read, has nothing for the node, or has an unknown name or a
            value that is not allowed.
        """
        from gear_dynamics.parameters.files import read_parameters

        values = read_parameters(path, node)
        try:
            return cls.from_mapping(values)
        except ParameterError as error:
            raise ParameterError(f'{path}: {error}') from None

    def to_yaml(self, path: str | Path) -> None:
        """Write every parameter, with unit and meaning, as a ROS parameter file for any node.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        from gear_dynamics.parameters.files import write_parameters

        write_parameters(path, self)


def checked_pair(pair: Any) -> GearPair:
    """Return what must be a gear pair.

    Raises
    ------
    ParameterError
        If it is anything else.
    """
    if not isinstance(pair, GearPair):
        raise ParameterError(f'pair is {pair!r}: it must be a GearPair, such as GearPair()')
    return pair
