"""The parameter list of a run: sampling, commands, tolerances."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.parameter import ParameterSet, parameter


@dataclasses.dataclass(frozen=True)
class RunSettings(ParameterSet):
    """How a gear pair is run and sampled.

    Raises
    ------
    ParameterError
        If a value is out of its range.
    """

    sample_rate: float = parameter(
        51200.0, 'samples per second of model time', unit='Hz', minimum=100.0, maximum=4e6
    )
    anti_alias: bool = parameter(True, 'whether the samples are band-limited')
    speed: float = parameter(
        104.72, 'commanded pinion speed', unit='rad/s', minimum=0.0, maximum=5000.0, live=True
    )
    load_torque: float = parameter(
        150.0,
        'commanded load torque on the gear',
        unit='N m',
        minimum=-5000.0,
        maximum=5000.0,
        live=True,
    )
    speed_rate_limit: float = parameter(
        200.0,
        'greatest rate of change of the speed',
        unit='rad/s2',
        minimum=1e-3,
        maximum=1e6,
        live=True,
    )
    torque_rate_limit: float = parameter(
        1000.0,
        'greatest rate of change of the load torque',
        unit='N m/s',
        minimum=1e-3,
        maximum=1e7,
        live=True,
    )
    rtol: float = parameter(
        1e-6, 'relative tolerance of the integrator', minimum=1e-13, maximum=1e-2
    )
    atol: float = parameter(
        1e-9, 'absolute tolerance of the integrator, scaled', minimum=1e-15, maximum=1e-2
    )
    section_phase: float = parameter(
        0.5, 'mesh phase of the section', unit='cycles', minimum=0.0, maximum=0.999999
    )
