"""The friction coefficient over the path of contact, from load, speed and lubricant.

Sources: G. H. Benedict, B. W. Kelley, Instantaneous coefficients of gear tooth friction, ASLE
Transactions 4 (1961) 59-70; H. Xu, A. Kahraman, N. E. Anderson, D. G. Maddock, Prediction of
mechanical efficiency of parallel-axis gear pairs, Journal of Mechanical Design 129 (2007) 58-68.
"""

from __future__ import annotations

import math
import warnings
from typing import NamedTuple

import numpy as np

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.model.mesh.piecewise import fit
from gear_dynamics.model.mesh.stiffness import pieces
from gear_dynamics.model.ports import HEALTHY, Ports, ToothDeviation

LOWEST, HIGHEST = 0.005, 0.2
"""Limits of the coefficient, before it fades at the pitch point."""

FADE = 0.05
"""Share of the path of contact, to each side of the pitch point, on which Benedict and Kelley's
coefficient fades to 0."""

SLOWEST = 1.0
"""Pinion speed below which the coefficient is that of this speed [rad/s]."""

TOLERANCE = 1e-3
"""Greatest error of the polynomials, relative to the greatest coefficient on the piece."""

XU_KAHRAMAN = (
    -8.916465,
    1.03303,
    1.036077,
    -0.354068,
    2.812084,
    -0.100601,
    0.752755,
    -0.390958,
    0.620305,
)
"""b1 to b9 of the regression."""


class ContactConditions(NamedTuple):
    """What a tooth pair does at places on the path of contact; arrays of one shape.

    sliding, rolling [m/s]: difference and sum of the flanks' speeds; radius: of the equivalent
    cylinder [m]; load: per face width [N/m]; pressure: the greatest one of Hertz [Pa].
    """

    sliding: np.ndarray
    rolling: np.ndarray
    radius: np.ndarray
    load: np.ndarray
    pressure: np.ndarray


def benedict_kelley(
    load: np.ndarray,
    sliding: np.ndarray,
    rolling: np.ndarray,
    viscosity: float,
    roughness: float,
) -> np.ndarray:
    """Return Benedict and Kelley's coefficient of friction, as the formula stands.

    It diverges without sliding, and turns negative at light load and high speed.

    Parameters
    ----------
    load : array
        Per face width [N/m].
    sliding, rolling : array
        Difference and sum of the flanks' speeds [m/s].
    viscosity : float
        [Pa s]
    roughness : float
        [m], below 1.13e-6.
    """
    thickness = (viscosity * 1e3) * np.abs(sliding) * rolling**2
    rough = 1.13 / (1.13 - roughness * 1e6)
    return 0.0127 * rough * np.log10(29660 * load / 1e3 / thickness)


def xu_kahraman(
    pressure: np.ndarray,
    slide_to_roll: np.ndarray,
    entraining: np.ndarray,
    radius: np.ndarray,
    viscosity: float,
    roughness: float,
) -> np.ndarray:
    """Return Xu and Kahraman's coefficient of friction.

    Parameters
    ----------
    pressure : array
        The greatest one of Hertz [Pa].
    slide_to_roll : array
        Sliding over entraining velocity.
    entraining : array
        Half the sum of the flanks' speeds [m/s].
    radius : array
        Of the equivalent cylinder [m].
    viscosity : float
        [Pa s]
    roughness : float
        [m]
    """
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = XU_KAHRAMAN
    p, nu, s = pressure / 1e9, viscosity * 1e3, roughness * 1e6
    ratio = np.abs(slide_to_roll)
    heat = ratio * p * math.log10(nu)
    exponent = b1 + b4 * heat + b5 * np.exp(-heat) + b9 * math.exp(s)
    return np.exp(exponent) * p**b2 * ratio**b3 * entraining**b6 * nu**b7 * radius**b8


def contact(pair: GearPair, s: np.ndarray, speed: float, load_torque: float) -> ContactConditions:
    """Return what the healthy pair does at s, with the load shared by stiffness.

    Parameters
    ----------
    pair : GearPair
    s : (n,) array
        [m]
    speed, load_torque : float
        Of the pinion [rad/s], on the gear [N m].
    """
    path, at = PathOfContact.of(pair), pieces(pair).at
    rho1 = path.pinion.base_radius * path.pinion_roll(s)
    rho2 = path.gear.base_radius * path.gear_roll(s)
    speed = max(abs(speed), SLOWEST)
    u1, u2 = speed * rho1, speed * pair.pinion_teeth / pair.gear_teeth * rho2
    other = path.other_pair(s)
    beside = np.where(np.isnan(other), 0.0, at(np.where(np.isnan(other), s, other)))
    own = at(s)
    width = pair.face_width
    force = max(abs(load_torque), 1e-3) / path.gear.base_radius
    load = force / width * own / (own + beside)
    # Where the path begins at a base circle the flank is a point there.
    radius = np.maximum(rho1 * rho2 / (rho1 + rho2), 1e-3 * pair.module)
    plane = pair.youngs_modulus / (2 * (1 - pair.poissons_ratio**2))
    return ContactConditions(
        u1 - u2, u1 + u2, radius, load, np.sqrt(load * plane / (math.pi * radius))
    )


def _benedict_kelley_over_path(
    pair: GearPair, s: np.ndarray, speed: float, torque: float
) -> np.ndarray:
    path = PathOfContact.of(pair)
    reach = FADE * path.length
    away = s - path.approach
    side = np.where(away < 0, -1.0, 1.0)
    outside = path.approach + side * np.maximum(abs(away), reach)
    at = contact(pair, outside, speed, torque)
    mu = benedict_kelley(at.load, at.sliding, at.rolling, pair.viscosity, pair.roughness)
    return np.clip(mu, LOWEST, HIGHEST) * np.minimum(abs(away) / reach, 1.0)


def _xu_kahraman_over_path(
    pair: GearPair, s: np.ndarray, speed: float, torque: float
) -> np.ndarray:
    at = contact(pair, s, speed, torque)
    ratio, entraining = 2 * at.sliding / at.rolling, at.rolling / 2
    mu = xu_kahraman(at.pressure, ratio, entraining, at.radius, pair.viscosity, pair.roughness)
    return np.minimum(mu, HIGHEST)


_LAWS = {'benedict_kelley': _benedict_kelley_over_path, 'xu_kahraman': _xu_kahraman_over_path}


def coefficient(pair: GearPair, s: np.ndarray, speed: float, load_torque: float) -> np.ndarray:
    """Return the coefficient of friction at s, within its limits.

    Parameters
    ----------
    pair : GearPair
        With a `friction_model`.
    s : (n,) array
        [m]
    speed, load_torque : float
        Of the pinion [rad/s], on the gear [N m].
    """
    s = np.asarray(s, float)
    if pair.friction_model == 'coulomb':
        return np.full(s.shape, pair.friction_coefficient)
    return _LAWS[pair.friction_model](pair, s, speed, load_torque)


def friction_ports(pair: GearPair, speed: float, load_torque: float) -> Ports:
    """Return what the friction model adds to `friction_coefficient` at an operating point.

    Parameters
    ----------
    pair : GearPair
    speed, load_torque : float
        Of the pinion [rad/s], on the gear [N m].

    Warns
    -----
    UserWarning
        If the operating point is outside the range of the model, which it names.
    """
    if pair.friction_model == 'coulomb':
        return HEALTHY
    path, reach = PathOfContact.of(pair), 0.0
    reach = FADE * path.length if pair.friction_model == 'benedict_kelley' else 0.0
    cuts = {*path.edges, path.approach - reach, path.approach, path.approach + reach}
    inside = sorted(cut for cut in cuts if 0 <= cut <= path.length)

    def added(s: np.ndarray) -> np.ndarray:
        return coefficient(pair, s, speed, load_torque) - pair.friction_coefficient

    found = fit(added, inside, TOLERANCE, scale=0.01)
    _warn_outside(pair, speed, load_torque)
    return Ports([ToothDeviation(None, None, found.edges, friction=found.coefficients)])


def _warn_outside(pair: GearPair, speed: float, load_torque: float) -> None:
    path = PathOfContact.of(pair)
    at = contact(pair, np.linspace(0.02, 0.98, 25) * path.length, speed, load_torque)
    values = {
        'viscosity [mPa s]': np.array([pair.viscosity * 1e3]),
        'roughness [um]': np.array([pair.roughness * 1e6]),
        'load [N/mm]': at.load / 1e3,
        'pressure [GPa]': at.pressure / 1e9,
        'entraining velocity [m/s]': at.rolling / 2,
        'equivalent radius [mm]': at.radius * 1e3,
    }
    for name, (low, high) in RANGES[pair.friction_model].items():
        least, greatest = float(values[name].min()), float(values[name].max())
        if least < low or greatest > high:
            found = f'{least:.3g}' if least == greatest else f'{least:.3g} to {greatest:.3g}'
            warnings.warn(
                f'friction_model {pair.friction_model} covers {name} from {low:g} to {high:g}: '
                f'this pair has {found} at {speed:g} rad/s and {load_torque:g} N m',
                stacklevel=4,
            )
            return


RANGES: dict[str, dict[str, tuple[float, float]]] = {
    'benedict_kelley': {'roughness [um]': (0.0, 0.9), 'load [N/mm]': (50.0, 2000.0)},
    'xu_kahraman': {
        'viscosity [mPa s]': (1.0, 100.0),
        'roughness [um]': (0.1, 0.8),
        'pressure [GPa]': (0.25, 2.5),
        'entraining velocity [m/s]': (0.5, 25.0),
        'equivalent radius [mm]': (1.0, 80.0),
    },
}
"""Where each model is used with confidence: the ranges of the tests and regressions behind it, made
a little wider."""
