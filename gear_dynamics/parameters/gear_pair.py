"""The gear pair's parameter list."""

from __future__ import annotations

import dataclasses

from gear_dynamics.parameters.parameter import ParameterSet, parameter


@dataclasses.dataclass(frozen=True)
class GearPairParameters(ParameterSet):
    """A spur gear pair on elastic supports; values are SI except where the name says otherwise."""

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
