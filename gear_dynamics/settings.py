"""The parameter lists of the nodes, beside that of the gear pair; no ROS is needed to read them."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.parameter import ParameterError, ParameterSet, parameter


@dataclasses.dataclass(frozen=True)
class SimSettings(ParameterSet):
    """What the `sim` node takes beside the gear pair.

    Raises
    ------
    ParameterError
        If a value is out of its range, or monitor_rate does not divide sample_rate.
    """

    sample_rate: float = parameter(
        51200.0, 'samples per second of model time', unit='Hz', minimum=100.0, maximum=4e6
    )
    block_size: int = parameter(512, 'samples in one message', minimum=1, maximum=65536)
    monitor_rate: float = parameter(
        2560.0,
        'rate of the monitor topics; divides sample_rate',
        unit='Hz',
        minimum=1.0,
        maximum=1e5,
    )
    anti_alias: bool = parameter(True, 'whether the samples are band-limited')
    real_time_factor: float = parameter(
        1.0,
        'pace against the wall clock; 0 is as fast as listeners allow',
        minimum=0.0,
        maximum=1000.0,
    )
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
    publish_clock: bool = parameter(False, 'whether /clock is published for use_sim_time')

    def __post_init__(self) -> None:
        super().__post_init__()
        ratio = self.sample_rate / self.monitor_rate
        if ratio < 1 or abs(ratio - round(ratio)) > 1e-9 * ratio:
            raise ParameterError(
                f'monitor_rate is {self.monitor_rate:g}: it must divide sample_rate '
                f'{self.sample_rate:g} into a whole number'
            )
