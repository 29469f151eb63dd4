"""What follows from the parameters of a gear pair: geometry, masses, damping, scales."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

from gear_dynamics.model.mesh.stiffness import single_stiffnesses, stiffness
from gear_dynamics.parameters.parameter import ParameterError

if TYPE_CHECKING:
    from gear_dynamics.model.gear_pair import GearPair


@dataclasses.dataclass(frozen=True)
class Derived:
    """Derived quantities of a gear pair, SI.

    Attributes
    ----------
    pinion_pitch_radius, gear_pitch_radius : float
        r = m z / 2 [m].
    pinion_base_radius, gear_base_radius : float
        rb = r cos a [m].
    pinion_tip_radius, gear_tip_radius : float
        ra = r + m, standard addendum [m].
    base_pitch : float
        pb = pi m cos a [m].
    approach_length, recess_length, path_length : float
        Path of contact before and after the pitch point, and whole [m].
    contact_ratio : float
        path_length / base_pitch.
    pinion_mass, gear_mass : float
        As given, or of the disc of the pitch diameter with its bore [kg].
    pinion_inertia, gear_inertia : float
        As given, or of that disc with that mass [kg m2].
    equivalent_mass : float
        1 / (rb1^2 / I1 + rb2^2 / I2) [kg].
    single_stiffness : float
        k of one tooth pair alone in contact at the pitch point, by the method that
        `mesh_stiffness` names [N/m].
    potential_energy_stiffness, iso_6336_stiffness : float
        The same by these methods, for comparison; 0 where a method does not cover the pair [N/m].
    wn : float
        sqrt(k / equivalent mass) on `single_stiffness` [rad/s]: the scale of dimensionless time,
        not a mode.
    tooth_pair_damping : float
        2 zeta sqrt(k me) [N s/m].
    pinion_support_damping, gear_support_damping : float
        2 zeta_s sqrt(k_s m) [N s/m].
    """

    pinion_pitch_radius: float
    gear_pitch_radius: float
    pinion_base_radius: float
    gear_base_radius: float
    pinion_tip_radius: float
    gear_tip_radius: float
    base_pitch: float
    approach_length: float
    recess_length: float
    path_length: float
    contact_ratio: float
    pinion_mass: float
    gear_mass: float
    pinion_inertia: float
    gear_inertia: float
    equivalent_mass: float
    single_stiffness: float
    potential_energy_stiffness: float
    iso_6336_stiffness: float
    wn: float
    tooth_pair_damping: float
    pinion_support_damping: float
    gear_support_damping: float


def derive(pair: GearPair) -> Derived:
    """Return the derived quantities of a gear pair (geometry of the standard involute spur pair).

    Raises
    ------
    ParameterError
        If the contact ratio is outside [1, 2), the tips would interfere, a bore leaves no rim, or
        the method of `mesh_stiffness` does not cover the pair.
    """
    angle = math.radians(pair.pressure_angle_deg)
    r1, r2 = pair.module * pair.pinion_teeth / 2, pair.module * pair.gear_teeth / 2
    rb1, rb2 = r1 * math.cos(angle), r2 * math.cos(angle)
    ra1, ra2 = r1 + pair.module, r2 + pair.module
    base_pitch = math.pi * pair.module * math.cos(angle)
    approach = math.sqrt(ra2**2 - rb2**2) - r2 * math.sin(angle)
    recess = math.sqrt(ra1**2 - rb1**2) - r1 * math.sin(angle)
    contact_ratio = (approach + recess) / base_pitch
    _refuse_bad_contact(pair, contact_ratio, approach, recess, r1, r2, angle)

    _refuse_bad_bores(pair, r1, r2)
    bore1, bore2 = pair.pinion_bore / 2, pair.gear_bore / 2
    per_area = pair.density * math.pi
    mass1 = pair.pinion_mass or per_area * (r1**2 - bore1**2) * pair.face_width
    mass2 = pair.gear_mass or per_area * (r2**2 - bore2**2) * pair.face_width
    inertia1 = pair.pinion_inertia or mass1 * (r1**2 + bore1**2) / 2
    inertia2 = pair.gear_inertia or mass2 * (r2**2 + bore2**2) / 2
    equivalent_mass = 1 / (rb1**2 / inertia1 + rb2**2 / inertia2)
    k = stiffness(pair).single
    by_method = single_stiffnesses(pair)
    return Derived(
        pinion_pitch_radius=r1,
        gear_pitch_radius=r2,
        pinion_base_radius=rb1,
        gear_base_radius=rb2,
        pinion_tip_radius=ra1,
        gear_tip_radius=ra2,
        base_pitch=base_pitch,
        approach_length=approach,
        recess_length=recess,
        path_length=approach + recess,
        contact_ratio=contact_ratio,
        pinion_mass=mass1,
        gear_mass=mass2,
        pinion_inertia=inertia1,
        gear_inertia=inertia2,
        equivalent_mass=equivalent_mass,
        single_stiffness=k,
        potential_energy_stiffness=by_method['potential_energy'],
        iso_6336_stiffness=by_method['iso_6336'],
        wn=math.sqrt(k / equivalent_mass),
        tooth_pair_damping=2 * pair.mesh_damping_ratio * math.sqrt(k * equivalent_mass),
        pinion_support_damping=(
            2 * pair.support_damping_ratio * math.sqrt(pair.pinion_support_stiffness * mass1)
        ),
        gear_support_damping=(
            2 * pair.support_damping_ratio * math.sqrt(pair.gear_support_stiffness * mass2)
        ),
    )


def _refuse_bad_bores(pair: GearPair, r1: float, r2: float) -> None:
    for name, radius in (('pinion_bore', r1), ('gear_bore', r2)):
        root = 2 * (radius - 1.25 * pair.module)
        if getattr(pair, name) >= root:
            raise ParameterError(
                f'{name} is {getattr(pair, name):g} m: it must be smaller than the root circle, '
                f'{root:g} m'
            )


def _refuse_bad_contact(
    pair: GearPair,
    contact_ratio: float,
    approach: float,
    recess: float,
    r1: float,
    r2: float,
    angle: float,
) -> None:
    teeth = (
        f'{pair.pinion_teeth}/{pair.gear_teeth} teeth at pressure_angle_deg '
        f'{pair.pressure_angle_deg:g}'
    )
    if not 1 <= contact_ratio < 2:
        raise ParameterError(
            f'{teeth} have a contact ratio of {contact_ratio:.4f}: it must be at least 1 and '
            'below 2; change the teeth or the pressure angle'
        )
    if approach > r1 * math.sin(angle):
        raise ParameterError(
            f"{teeth}: the gear's tip would interfere with the pinion's root; give the pinion more "
            'teeth or raise the pressure angle'
        )
    if recess > r2 * math.sin(angle):
        raise ParameterError(
            f"{teeth}: the pinion's tip would interfere with the gear's root; give the gear more "
            'teeth or raise the pressure angle'
        )
