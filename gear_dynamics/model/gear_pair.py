"""The gear pair's parameter list."""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path
from typing import Any

from gear_dynamics.model.derived import Derived, derive
from gear_dynamics.model.parameter import ParameterError, ParameterSet, parameter


@dataclasses.dataclass(frozen=True)
class GearPair(ParameterSet):
    """A spur gear pair on elastic supports; values are SI except where the name says otherwise.

    Frozen: change a value with `dataclasses.replace(pair, friction_coefficient=0.0)`.

    Raises
    ------
    ParameterError
        If a value is out of its range, or the geometry has no continuous, undisturbed contact.
    """

    pinion_teeth: int = parameter(34, 'teeth of the driving pinion', minimum=4, maximum=1000)
    gear_teeth: int = parameter(59, 'teeth of the driven gear', minimum=4, maximum=1000)
    module: float = parameter(0.002, 'module', unit='m', minimum=1e-4, maximum=0.1)
    pressure_angle_deg: float = parameter(
        20.0, 'pressure angle', unit='deg', minimum=10.0, maximum=35.0
    )
    face_width: float = parameter(0.0384, 'face width', unit='m', minimum=1e-4, maximum=2.0)
    density: float = parameter(
        7850.0, 'density of both wheels', unit='kg/m3', minimum=100.0, maximum=30000.0
    )
    pinion_mass: float = parameter(
        0.0, 'mass of the pinion; 0 derives the solid disc', unit='kg', minimum=0.0, maximum=1e5
    )
    gear_mass: float = parameter(
        0.0, 'mass of the gear; 0 derives the solid disc', unit='kg', minimum=0.0, maximum=1e5
    )
    pinion_inertia: float = parameter(
        0.0,
        'polar inertia of the pinion; 0 derives the solid disc of its mass',
        unit='kg m2',
        minimum=0.0,
        maximum=1e6,
    )
    gear_inertia: float = parameter(
        0.0,
        'polar inertia of the gear; 0 derives the solid disc of its mass',
        unit='kg m2',
        minimum=0.0,
        maximum=1e6,
    )
    tooth_pair_stiffness: float = parameter(
        5.33e8, 'stiffness of one tooth pair in contact', unit='N/m', minimum=1e3, maximum=1e12
    )
    mesh_stiffness: str = parameter(
        'rectangular',
        'rectangular: of the one or two pairs in contact; constant: of one pair at all times',
        choices=('rectangular', 'constant'),
    )
    mesh_damping_ratio: float = parameter(
        0.03, 'damping ratio of one tooth pair', minimum=0.0, maximum=1.0, live=True
    )
    damping_in_gap: bool = parameter(
        False, 'whether the mesh damping acts out of contact too', live=True
    )
    half_backlash: float = parameter(
        150e-6, 'half of the backlash', unit='m', minimum=1e-9, maximum=0.01, live=True
    )
    transmission_error_amplitude: float = parameter(
        15e-6,
        'amplitude of the static transmission error',
        unit='m',
        minimum=0.0,
        maximum=1e-3,
        live=True,
    )
    transmission_error_phase: float = parameter(
        0.0,
        'phase of the static transmission error at mesh phase 0',
        unit='rad',
        minimum=-6.283185307179586,
        maximum=6.283185307179586,
        live=True,
    )
    friction_coefficient: float = parameter(
        0.03, 'Coulomb friction coefficient of the flanks', minimum=0.0, maximum=1.0, live=True
    )
    pinion_support_stiffness: float = parameter(
        5e8, 'support stiffness of the pinion, in x and in y', unit='N/m', minimum=1e3, maximum=1e15
    )
    gear_support_stiffness: float = parameter(
        5e8, 'support stiffness of the gear, in x and in y', unit='N/m', minimum=1e3, maximum=1e15
    )
    support_damping_ratio: float = parameter(
        0.03, 'damping ratio of the supports', minimum=0.0, maximum=1.0
    )
    drive_frequency: float = parameter(
        5.0, 'natural frequency of the drive control', unit='Hz', minimum=0.01, maximum=1000.0
    )
    drive_damping_ratio: float = parameter(
        0.7, 'damping ratio of the drive control', minimum=0.05, maximum=10.0
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        self.derived  # noqa: B018  (geometry without continuous contact is refused here)

    @functools.cached_property
    def derived(self) -> Derived:
        """Geometry, masses, damping and scales that follow from the parameters."""
        return derive(self)

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
        from gear_dynamics.parameter_files import read_parameters

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
        from gear_dynamics.parameter_files import write_parameters

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
