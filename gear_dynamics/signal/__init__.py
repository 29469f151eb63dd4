"""Signal processing: plain functions over arrays.

Arrays hold one row a sample and one column a channel unless `axis` says otherwise. Lists and
integer arrays are taken as float64. A value that is not finite is refused with its place.
"""

from __future__ import annotations

from typing import Any

from gear_dynamics.lazy import load

_EXPORTS = {
    'bearing': ('envelope_orders', 'find_defect'),
    'decimation': ('Decimator', 'lowpass_taps'),
    'demodulation': (
        *('Band', 'envelope', 'envelope_spectrum', 'kurtogram', 'most_impulsive_band'),
        'spectral_kurtosis',
    ),
    'indicators': (
        *('RunningKurtosis', 'energy_ratio', 'first_sidebands', 'fm0', 'fm4', 'has_difference'),
        *('m6a', 'm8a', 'mesh_amplitudes', 'mesh_envelope', 'sideband_index'),
        *('sideband_level_factor', 'strongest_harmonic', 'variance_ratio_kurtosis'),
    ),
    'interpolation': ('interpolate',),
    'order_tracking': (
        *('mesh_phase', 'order_spectrum', 'pinion_inertia_share', 'resample_by_phase'),
    ),
    'segments': ('SegmentBuffer', 'hop_of'),
    'shaft_phase': (
        *('ShaftPhase', 'phase_from_angle', 'phase_from_constant', 'phase_from_pulses'),
        'phase_from_speed',
    ),
    'spectrum': ('PowerAverage', 'amplitude_spectrum', 'window_samples'),
    'speed_tracking': ('track_speed',),
    'statistics': (
        *('Moments', 'crest_factor', 'kurtosis', 'normalised_moment', 'peak', 'rms', 'skewness'),
        'std',
    ),
    'synchronous': (
        *('Parts', 'below_order', 'hunting_revolutions', 'other_wheel_leakage', 'separate'),
        'synchronous_average',
    ),
    'tacho': ('even_pulses', 'repair_pulses', 'rising_edges', 'trigger_level'),
    'teeth': ('ToothEnergy', 'tooth_energy'),
}
_HOMES = {name: module for module, names in _EXPORTS.items() for name in names}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    # Loaded when first used: SciPy and the compiled interpolation take a while.
    return load(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
