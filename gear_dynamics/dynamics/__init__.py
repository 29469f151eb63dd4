"""Algorithms on motions: stroboscopic map, tangent space, exponents, regimes, attractors."""

from __future__ import annotations

from typing import Any

from gear_dynamics.lazy import load

_EXPORTS = {
    'arclength': ('Curve', 'CurvePoint'),
    'attractors': ('Attractor', 'assign', 'reached', 'same_cloud', 'same_orbit'),
    'basin_measures': ('basin_entropy', 'uncertainty_exponent', 'wilson_interval'),
    'branches': ('Bifurcation', 'Branch', 'continuation', 'doubled_guess'),
    'cycles': ('Cycles', 'run_cycles'),
    'embedding': ('cao_dimension', 'embed', 'mean_period', 'mutual_information_lag'),
    'exponents': (
        *('Exponents', 'halves_agree', 'lyapunov_spectrum', 'standard_error', 'sum_error'),
        'transient',
    ),
    'initial': ('states_at', 'static_state'),
    'lyapunov': ('Lyapunov', 'lyapunov_exponent'),
    'nearby': ('nearby_growth',),
    'regimes': ('Regime', 'recurrence_period', 'regime'),
    'shooting': ('LONGEST', 'OrbitError', 'PeriodicOrbit', 'periodic_orbit'),
    'stroboscopic': ('GearMap', 'OrbitContact', 'StroboscopicMap'),
    'tangent': ('first_tangent_vectors', 'free_coordinates'),
    'zero_one': ('zero_one_test',),
}
_HOMES = {name: module for module, names in _EXPORTS.items() for name in names}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    # Loaded when first used: the help of the studies must not wait for the compiler.
    return load(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
