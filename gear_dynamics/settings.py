"""The parameter lists of the nodes, beside that of the gear pair; no ROS is needed to read them."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.parameter import ParameterError, parameter
from gear_dynamics.model.run_settings import RunSettings


@dataclasses.dataclass(frozen=True)
class SimSettings(RunSettings):
    """What the `sim` node takes beside the gear pair.

    Raises
    ------
    ParameterError
        If a value is out of its range, or monitor_rate does not divide sample_rate.
    """

    block_size: int = parameter(512, 'samples in one message', minimum=1, maximum=65536)
    monitor_rate: float = parameter(
        2560.0,
        'rate of the monitor topics; divides sample_rate',
        unit='Hz',
        minimum=1.0,
        maximum=1e5,
    )
    real_time_factor: float = parameter(
        1.0,
        'pace against the wall clock; 0 is as fast as listeners allow',
        minimum=0.0,
        maximum=1000.0,
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
