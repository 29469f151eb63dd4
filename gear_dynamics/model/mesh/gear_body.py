"""The compliance of a gear's body under one loaded tooth.

Source: P. Sainsot, P. Velex, O. Duverger, Contribution of gear body to tooth deflections - a new
bidimensional analytical formula, Journal of Mechanical Design 126 (2004) 748-752. The formula is a
polynomial fitted to the elastic ring on its bore, and holds in its range alone.
"""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.model.mesh.tooth import Tooth
from gear_dynamics.parameters.parameter import ParameterError

RATIOS = 1.4, 7.0
"""Range of the root radius over the bore's radius."""

ROOT_ANGLES = 0.01, 0.12
"""Range of the tooth's half angle on the root circle [rad]."""

_COEFFICIENTS = np.array(
    [
        # A          B          C           D          E       F
        [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],  # L*
        [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],  # M*
        [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],  # P*
        [-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904],  # Q*
    ]
)


def refuse_outside(wheel: str, tooth: Tooth, bore: float) -> None:
    """Refuse a wheel that the formula does not cover.

    Parameters
    ----------
    wheel : str
        'pinion' or 'gear', for the message.
    tooth : Tooth
    bore : float
        Diameter [m].

    Raises
    ------
    ParameterError
        With the range of bores, or of teeth, that it covers.
    """
    low, high = (2000 * tooth.root_radius / ratio for ratio in reversed(RATIOS))
    if not low <= 1000 * bore <= high:
        raise ParameterError(
            f'{wheel}_bore is {bore:g} m: the gear body formula of Sainsot holds for bores from '
            f'{math.ceil(low * 10) / 1e4:g} to {math.floor(high * 10) / 1e4:g} m; give one, or '
            'choose another mesh_stiffness'
        )
    if not ROOT_ANGLES[0] <= tooth.root_angle <= ROOT_ANGLES[1]:
        raise ParameterError(
            f'{wheel}_teeth is {tooth.teeth}: the gear body formula of Sainsot holds for root '
            f'angles from {ROOT_ANGLES[0]} to {ROOT_ANGLES[1]} rad, and this is '
            f'{tooth.root_angle:.3f}; choose another mesh_stiffness'
        )


def body_compliance(
    tooth: Tooth, roll: np.ndarray, bore: float, face_width: float, youngs_modulus: float
) -> np.ndarray:
    """Return the compliance of the gear body along the line of action.

    Parameters
    ----------
    tooth : Tooth
    roll : (n,) array
        tan of the pressure angle at the place of contact.
    bore, face_width : float
        Diameter and width [m].
    youngs_modulus : float
        [Pa]

    Returns
    -------
    (n,) array
        Displacement per force [m/N].
    """
    h, theta = 2 * tooth.root_radius / bore, tooth.root_angle
    terms = np.array([1 / theta**2, h**2, h / theta, 1 / theta, h, 1.0])
    l_star, m_star, p_star, q_star = _COEFFICIENTS @ terms
    tau, _, y, _ = tooth.involute(np.asarray(roll, float))
    # Measured at the place of contact, as the published potential-energy models do.
    lever = (y - tooth.root_radius) / (2 * theta * tooth.root_radius)
    shape = l_star * lever**2 + m_star * lever + p_star * (1 + q_star * np.tan(tau) ** 2)
    return np.cos(tau) ** 2 / (youngs_modulus * face_width) * shape
