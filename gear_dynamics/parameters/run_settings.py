"""The parameter list of a run: sampling, commands, tolerances."""

from __future__ import annotations

import dataclasses
import math
import os
from typing import Any

from gear_dynamics.parameters.parameter import Parameter, ParameterError, ParameterSet, parameter

_DURATION = Parameter('duration', 1.0, 'model time', unit='s', minimum=0.0, maximum=1e9)


def _memory() -> float:
    """Return the bytes of memory of this machine; without limit where the system does not say."""
    try:
        return float(os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES'))
    except (AttributeError, ValueError, OSError):
        return math.inf


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

    def sample_count(self, duration: Any, sample_size: int, runs: int = 1) -> int:
        """Return the number of samples that each of several runs has in a duration [s].

        sample_size : size of one sample [bytes].

        Raises
        ------
        ParameterError
            If the duration is no number, shorter than a sample, or so long that the samples of
            all runs do not fit into this machine's memory.
        """
        seconds = float(_DURATION.check(duration))  # type: ignore[arg-type]
        count = round(seconds * self.sample_rate)
        if count < 1:
            shortest = 1 / self.sample_rate
            raise ParameterError(
                f'duration is {duration!r}: it must be a sample or more, {shortest:.3g} s'
            )
        needed = count * runs * sample_size
        memory = _memory()
        if needed > memory:
            raise ParameterError(
                f'duration is {duration!r}: its samples need {needed / 1e9:.3g} GB and the machine '
                f'has {memory / 1e9:.3g} GB; advance a Simulator block by block'
            )
        return count
