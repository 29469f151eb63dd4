"""The shape of one tooth cut by a standard rack, and its compliance as a cantilever.

The tooth stands on the root circle. x is its half thickness, y the distance from the centre of the
wheel along the tooth's centre line. The flank is an involute, the fillet is the trochoid that the
rounded tip of the rack cuts (basic rack of ISO 53: addendum m, dedendum 1.25 m, tip radius
0.25 m / (1 - sin a)).

Sources: H. Ma, R. Song, X. Pang, B. Wen, Time-varying mesh stiffness calculation of cracked spur
gears, Engineering Failure Analysis 44 (2014) 179-194, for the shape; D. Yang, J. Lin, Hertzian
damping, tooth friction and bending elasticity in gear impact dynamics, Journal of Mechanisms,
Transmissions, and Automation in Design 109 (1987) 189-196, for the potential energy.
"""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np

CLEARANCE = 0.25
"""Dedendum less addendum, in modules (ISO 53, profile A)."""

_FILLET_NODES, _FLANK_NODES = 96, 48
_PANELS = 4
"""Gauss-Legendre nodes in all; the fillet is cut into panels, since its thickness bends sharply."""


@dataclasses.dataclass(frozen=True)
class Tooth:
    """One tooth of a standard wheel: lengths in metres, angles in radians.

    Attributes
    ----------
    teeth : int
    module, pressure_angle : float
    """

    teeth: int
    module: float
    pressure_angle: float

    @functools.cached_property
    def pitch_radius(self) -> float:
        """Pitch radius, m z / 2 [m]."""
        return self.module * self.teeth / 2

    @functools.cached_property
    def base_radius(self) -> float:
        """Base radius, r cos a [m]."""
        return self.pitch_radius * math.cos(self.pressure_angle)

    @functools.cached_property
    def tip_radius(self) -> float:
        """Tip radius, r + m [m]."""
        return self.pitch_radius + self.module

    @functools.cached_property
    def root_radius(self) -> float:
        """Root radius, r - 1.25 m [m]."""
        return self.pitch_radius - (1 + CLEARANCE) * self.module

    @functools.cached_property
    def fillet_radius(self) -> float:
        """Radius of the rack's rounded tip [m]."""
        return CLEARANCE * self.module / (1 - math.sin(self.pressure_angle))

    @functools.cached_property
    def half_base_angle(self) -> float:
        """Half the angle that the tooth takes on the base circle [rad]."""
        return math.pi / (2 * self.teeth) + math.tan(self.pressure_angle) - self.pressure_angle

    @functools.cached_property
    def root_angle(self) -> float:
        """Half the angle that the tooth takes on the root circle, theta_f of Sainsot [rad]."""
        corner = self.fillet_radius / self.module
        a = self.pressure_angle
        width = math.pi / 2 + 2 * math.tan(a) * (1 - corner) + 2 * corner / math.cos(a)
        return width / self.teeth

    @functools.cached_property
    def start_of_involute(self) -> float:
        """Roll angle, tan of the pressure angle, at which the involute leaves the fillet."""
        a = self.pressure_angle
        return max(math.tan(a) - self.module / (self.base_radius * math.sin(a)), 0.0)

    @property
    def undercut(self) -> bool:
        """Whether the rack cuts into the involute: fewer than 2 / sin2 a teeth, 17 at 20 deg."""
        return self.teeth < math.floor(2 / math.sin(self.pressure_angle) ** 2)

    def involute(self, roll: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the flank at roll angles tan(pressure angle): tau, x, y, dy/droll.

        tau is the angle between the force, along the flank's normal, and the direction across the
        tooth.
        """
        tau = roll - self.half_base_angle
        rb = self.base_radius
        x = rb * (roll * np.cos(tau) - np.sin(tau))
        y = rb * (roll * np.sin(tau) + np.cos(tau))
        return tau, x, y, rb * roll * np.cos(tau)

    def fillet(self, gamma: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the fillet, x, y, -dy/dgamma, at rack angles from pi / 2 at the root to a."""
        below = (1 + CLEARANCE) * self.module - self.fillet_radius
        aside = (
            math.pi * self.module / 4
            + self.module * math.tan(self.pressure_angle)
            + self.fillet_radius * math.cos(self.pressure_angle)
        )
        r = self.pitch_radius
        turned = (below / np.tan(gamma) + aside) / r
        reach = below / np.sin(gamma) + self.fillet_radius
        x = r * np.sin(turned) - reach * np.cos(gamma - turned)
        y = r * np.cos(turned) - reach * np.sin(gamma - turned)
        slope = (
            below * np.sin(turned) / np.sin(gamma) ** 2
            + below * np.cos(gamma) / np.sin(gamma) ** 2 * np.sin(gamma - turned)
            - reach * np.cos(gamma - turned) * (1 + below / (r * np.sin(gamma) ** 2))
        )
        return x, y, -slope

    def compliance(
        self,
        roll: np.ndarray,
        face_width: float,
        youngs_modulus: float,
        poissons_ratio: float,
        uncracked_half: float | None = None,
    ) -> np.ndarray:
        """Return the compliance of the tooth by bending, shear and compression.

        Parameters
        ----------
        roll : (n,) array
            tan of the pressure angle at the place of contact.
        face_width, youngs_modulus, poissons_ratio : float
            [m], [Pa], none.
        uncracked_half : float, optional
            Distance of a crack's tip from the tooth's centre line [m]: the half of each section
            that the crack comes from is cut down to it. None leaves the tooth whole.

        Returns
        -------
        (n,) array
            Displacement along the line of action per force [m/N].
        """
        roll = np.atleast_1d(np.asarray(roll, float))
        tau, x_load, y_load, _ = self.involute(roll)
        cos, sin = np.cos(tau)[:, None], np.sin(tau)[:, None]
        shear_modulus = youngs_modulus / (2 * (1 + poissons_ratio))
        total = np.zeros(roll.size)
        for x, y, dy in self._sections(roll, uncracked_half):
            thickness = 2 * x if uncracked_half is None else x + np.minimum(x, uncracked_half)
            moment = cos * (y_load[:, None] - y) - sin * x_load[:, None]
            inertia = face_width * thickness**3 / 12
            area = face_width * thickness
            energy = (
                moment**2 / (youngs_modulus * inertia)
                + 1.2 * cos**2 / (shear_modulus * area)
                + sin**2 / (youngs_modulus * area)
            )
            total += (energy * dy).sum(axis=1)
        return total

    def _sections(self, roll: np.ndarray, half: float | None) -> list[tuple[np.ndarray, ...]]:
        """Return x, y and the weights of dy, from the root to the load; cut where x is `half`."""
        nodes, weights = _panelled(_FILLET_NODES // _PANELS, _PANELS)
        gamma = np.linspace(math.pi / 2, self.pressure_angle, 400)
        at = self._where(half, gamma, self.fillet(gamma)[0])
        parts: list[tuple[np.ndarray, ...]] = []
        for begin, end in ((math.pi / 2, at), (at, self.pressure_angle)):
            x, y, slope = self.fillet(end + (begin - end) * nodes)
            parts.append((x, y, slope * (begin - end) * weights))
        nodes, weights = _panelled(_FLANK_NODES // _PANELS, _PANELS)
        first = self.start_of_involute
        rolls = np.linspace(first, math.tan(math.acos(self.base_radius / self.tip_radius)), 400)
        cut = np.minimum(self._where(half, rolls, self.involute(rolls)[1]), roll)
        for low, high in ((np.full(roll.shape, first), cut), (cut, roll)):
            width = (high - low)[:, None]
            _, x, y, slope = self.involute(low[:, None] + width * nodes)
            parts.append((x, y, slope * width * weights))
        return parts

    @staticmethod
    def _where(half: float | None, places: np.ndarray, x: np.ndarray) -> float:
        """Return at which of the places x, which falls, has come down to `half`."""
        return float(places[0] if half is None else np.interp(-half, -x, places))


@functools.lru_cache
def _panelled(nodes: int, panels: int) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and weights of Gauss-Legendre panels on 0 to 1."""
    place, weight = np.polynomial.legendre.leggauss(nodes)
    begin = np.arange(panels)[:, None] / panels
    return (begin + (place + 1) / (2 * panels)).ravel(), np.tile(weight / (2 * panels), panels)
