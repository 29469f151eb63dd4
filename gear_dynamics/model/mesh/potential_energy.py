"""Stiffness of a tooth pair by the potential energy of teeth, contact and gear bodies.

Sources: D. Yang, J. Lin (1987) and H. Ma et al. (2014) for the teeth, see `mesh.tooth`; P. Sainsot
et al. (2004) for the gear bodies, see `mesh.gear_body`. The Hertzian contact has the stiffness
pi E b / (4 (1 - nu2)). The teeth are cantilevers and the bodies plane rings, which makes this an
approximation; docs/faults.md compares it with finite elements.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gear_dynamics.model.mesh.gear_body import body_compliance, refuse_outside
from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.parameters.gear_pair import GearPairParameters
from gear_dynamics.parameters.parameter import ParameterError


@dataclasses.dataclass(frozen=True)
class PotentialEnergy:
    """Stiffness of the tooth pairs on a path of contact.

    Attributes
    ----------
    path : PathOfContact
    face_width, pinion_bore, gear_bore : float
        [m]
    youngs_modulus, poissons_ratio : float
        [Pa], none.
    body_once : bool
        Two pairs share each gear body, whose compliance is that at their mean; otherwise each pair
        has a body of its own, as the older formulation has it.
    """

    path: PathOfContact
    face_width: float
    pinion_bore: float
    gear_bore: float
    youngs_modulus: float
    poissons_ratio: float
    body_once: bool

    @classmethod
    def of(cls, pair: GearPairParameters, body_once: bool) -> PotentialEnergy:
        """Return the stiffness of a gear pair.

        Raises
        ------
        ParameterError
            If a wheel is undercut, or a bore is outside the range of Sainsot's formula.
        """
        path = PathOfContact.of(pair)
        for wheel, tooth, bore in (
            ('pinion', path.pinion, pair.pinion_bore),
            ('gear', path.gear, pair.gear_bore),
        ):
            if tooth.undercut:
                raise ParameterError(
                    f'{wheel}_teeth is {tooth.teeth}: mesh_stiffness {pair.mesh_stiffness} covers '
                    'teeth without undercut, '
                    f'{math.floor(2 / math.sin(tooth.pressure_angle) ** 2)} or more'
                )
            refuse_outside(wheel, tooth, bore)
        return cls(
            path,
            pair.face_width,
            pair.pinion_bore,
            pair.gear_bore,
            pair.youngs_modulus,
            pair.poissons_ratio,
            body_once,
        )

    @property
    def contact_stiffness(self) -> float:
        """Return the Hertzian stiffness [N/m]."""
        plane = 4 * (1 - self.poissons_ratio**2)
        return math.pi * self.youngs_modulus * self.face_width / plane

    def teeth(self, s: np.ndarray) -> np.ndarray:
        """Return the compliance of both teeth and their contact at s [m/N]."""
        material = self.face_width, self.youngs_modulus, self.poissons_ratio
        return (
            1 / self.contact_stiffness
            + self.path.pinion.compliance(self.path.pinion_roll(s), *material)
            + self.path.gear.compliance(self.path.gear_roll(s), *material)
        )

    def bodies(self, s: np.ndarray) -> np.ndarray:
        """Return the compliance of both gear bodies at s [m/N]."""
        material = self.face_width, self.youngs_modulus
        path = self.path
        return body_compliance(
            path.pinion, path.pinion_roll(s), self.pinion_bore, *material
        ) + body_compliance(path.gear, path.gear_roll(s), self.gear_bore, *material)

    def single(self, s: np.ndarray) -> np.ndarray:
        """Return the stiffness of a pair that is alone in contact at s [N/m]."""
        return 1 / (self.teeth(s) + self.bodies(s))

    def of_pair(self, s: np.ndarray, softened: np.ndarray | float = 0.0) -> np.ndarray:
        """Return what the pair at s adds to the stiffness of the mesh [N/m].

        Parameters
        ----------
        s : (n,) array
            [m]
        softened : float or (n,) array
            Compliance that this pair has besides, such as that of a crack [m/N]. With shared
            bodies, what it takes from the whole mesh is taken from this pair.
        """
        s = np.asarray(s, float)
        if not self.body_once:
            return 1 / (self.teeth(s) + self.bodies(s) + softened)
        other = self.path.other_pair(s)
        alone = np.isnan(other)
        other = np.where(alone, s, other)
        body = (self.bodies(s) + self.bodies(other)) / 2
        teeth = self.teeth(s)
        beside = np.where(alone, 0.0, 1 / self.teeth(other))
        whole = 1 / (body + 1 / (1 / (teeth + softened) + beside))
        return whole - beside / (1 + body * (1 / teeth + beside))
