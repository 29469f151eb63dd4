"""The gear pair's parameter list."""

from __future__ import annotations

import dataclasses

from gear_dynamics.parameters.parameter import ParameterSet, parameter

MESH_STIFFNESSES = (
    'rectangular',
    'constant',
    'potential_energy',
    'potential_energy_per_pair',
    'iso_6336',
    'harmonic',
    'table',
)
"""Ways to the stiffness of a tooth pair."""

FRICTION_MODELS = ('coulomb', 'benedict_kelley', 'xu_kahraman')
"""Laws of the friction coefficient."""


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
        'rectangular: of the one or two pairs in contact; constant: of one pair at all times; the '
        'others follow the place of contact, see docs/faults.md',
        choices=MESH_STIFFNESSES,
    )
    stiffness_ratio: float = parameter(
        2.0,
        'stiffness of two tooth pairs over that of one, for rectangular',
        minimum=1.0,
        maximum=2.0,
    )
    stiffness_harmonics: str = parameter(
        '',
        'for harmonic: amplitude over the mean and phase [rad] of each harmonic of the mesh, such '
        "as '0.3 0, 0.1 1.57'; the mean is tooth_pair_stiffness",
    )
    stiffness_table: str = parameter(
        '', 'for table: file with columns s [m] and stiffness of the tooth pair there [N/m]'
    )
    youngs_modulus: float = parameter(
        206e9, "Young's modulus of both wheels", unit='Pa', minimum=1e6, maximum=1e12
    )
    poissons_ratio: float = parameter(
        0.3, "Poisson's ratio of both wheels", minimum=0.0, maximum=0.49
    )
    pinion_bore: float = parameter(
        0.0, "diameter of the pinion's bore; 0 is solid", unit='m', minimum=0.0, maximum=10.0
    )
    gear_bore: float = parameter(
        0.0, "diameter of the gear's bore; 0 is solid", unit='m', minimum=0.0, maximum=10.0
    )
    tip_relief_amount: float = parameter(
        0.0, 'tip relief of both wheels, at the tip', unit='m', minimum=0.0, maximum=1e-3
    )
    tip_relief_length: float = parameter(
        0.0,
        'length of the tip relief along the path of contact',
        unit='m',
        minimum=0.0,
        maximum=0.1,
    )
    tip_relief_shape: str = parameter(
        'linear', 'shape of the tip relief', choices=('linear', 'parabolic')
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
    transmission_error_harmonics: str = parameter(
        '',
        'further harmonics of the transmission error: order of the mesh, amplitude [m] and phase '
        "[rad] of each, such as '2 3e-6 0, 3 1e-6 1.57'",
    )
    friction_model: str = parameter(
        'coulomb',
        'coulomb: friction_coefficient everywhere; the others give it over the path of contact '
        'from load and speed, see docs/faults.md',
        choices=FRICTION_MODELS,
    )
    friction_coefficient: float = parameter(
        0.03, 'Coulomb friction coefficient of the flanks', minimum=0.0, maximum=1.0, live=True
    )
    viscosity: float = parameter(
        0.05, 'dynamic viscosity of the oil', unit='Pa s', minimum=1e-4, maximum=10.0
    )
    roughness: float = parameter(
        0.4e-6, 'mean roughness Ra of both flanks', unit='m', minimum=1e-8, maximum=1e-5
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
    support_model: str = parameter(
        'elastic',
        'elastic: on springs and dampers in x and in y; rigid: the bodies only rotate',
        choices=('elastic', 'rigid'),
    )
    drive_frequency: float = parameter(
        5.0, 'natural frequency of the drive control', unit='Hz', minimum=0.01, maximum=1000.0
    )
    drive_damping_ratio: float = parameter(
        0.7, 'damping ratio of the drive control', minimum=0.05, maximum=10.0
    )
    drive_feed_forward: bool = parameter(
        False, 'whether the drive makes up the mean friction moment at once, by its static value'
    )
