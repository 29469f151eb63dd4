"""Symbols of what studies vary, for the axes of figures."""

from __future__ import annotations

from gear_dynamics.study.sweep import unit_of

SYMBOLS = {
    'w': r'$\omega_m / \omega_n$',
    'speed': r'$\Omega_1$',
    'load_torque': r'$T_2$',
    'friction_coefficient': r'$\mu$',
    'mesh_damping_ratio': r'$\zeta$',
    'support_damping_ratio': r'$\zeta_s$',
    'half_backlash': r'$b$',
    'transmission_error_amplitude': r'$e_a$',
    'transmission_error_phase': r'$\varphi_0$',
    'tooth_pair_stiffness': r'$k$',
    'stiffness_ratio': r'$k_2 / k$',
    'pinion_support_stiffness': r'$k_{s1}$',
    'gear_support_stiffness': r'$k_{s2}$',
    'pinion_mass': r'$m_1$',
    'gear_mass': r'$m_2$',
    'pinion_inertia': r'$I_1$',
    'gear_inertia': r'$I_2$',
    'pressure_angle_deg': r'$\alpha$',
    'module': r'$m$',
    'face_width': r'$B$',
    'density': r'$\rho$',
    'youngs_modulus': r'$E$',
    'poissons_ratio': r'$\nu$',
}
"""Symbols of docs/model.md, in Matplotlib's mathematical text."""


def axis_label(parameter: str) -> str:
    """Return the label of an axis for a parameter: its symbol, or its name without one, and unit.

    A pure number has no unit in brackets.
    """
    symbol = SYMBOLS.get(parameter, parameter.replace('_', ' '))
    unit = unit_of(parameter)
    return symbol if unit == '1' else f'{symbol} [{unit}]'
