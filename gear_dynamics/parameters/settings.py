"""The parameter lists of the nodes, beside that of the gear pair; no ROS is needed to read them."""

from __future__ import annotations

import dataclasses
import re

from gear_dynamics.parameters.parameter import ParameterError, ParameterSet, parameter
from gear_dynamics.parameters.run_settings import RunSettings


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
    noise_density: str = parameter(
        '',
        "white noise of channels, such as 'pinion_ay 0.01, mesh_force 2' [unit / sqrt(Hz)]; empty "
        'is none',
    )
    noise_seed: int = parameter(1, 'seed of the noise', minimum=0, maximum=2147483647)
    tacho: bool = parameter(
        False, 'whether samples has a column tacho: 1 for the first tenth of each revolution'
    )
    faults: str = parameter(
        '', 'YAML file with a list of faults, see docs/faults.md; empty is none', live=True
    )
    pair_file: str = parameter(
        '',
        'parameter file of another gear pair; setting it starts the model anew with that pair',
        live=True,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        ratio = self.sample_rate / self.monitor_rate
        if ratio < 1 or abs(ratio - round(ratio)) > 1e-9 * ratio:
            raise ParameterError(
                f'monitor_rate is {self.monitor_rate:g}: it must divide sample_rate '
                f'{self.sample_rate:g} into a whole number'
            )


@dataclasses.dataclass(frozen=True)
class AnalyzerSettings(ParameterSet):
    """What the `analyzer` node takes; of the rig it learns from `gear_pair/configuration`.

    Raises
    ------
    ParameterError
        If a value is out of its range, or an indicator is not named CHANNEL/NAME.
    """

    machine: str = parameter(
        '', 'machine file of a real machine, see docs/machines.md; empty is the simulated rig'
    )
    log: bool = parameter(True, 'whether the topics of the rig are logged to MCAP')
    log_directory: str = parameter('.', 'existing folder in which the folder of the log is made')
    log_compression: str = parameter(
        'zstd', 'compression of the log', choices=('none', 'lz4', 'zstd')
    )
    log_split_size: float = parameter(
        1e9, 'size after which a new file begins', unit='bytes', minimum=1e6, maximum=1e15
    )
    log_split_duration: float = parameter(
        3600.0, 'time after which a new file begins', unit='s', minimum=1.0, maximum=1e9
    )
    log_total_cap: float = parameter(
        20e9,
        'size of a log beyond which its oldest files are removed',
        unit='bytes',
        minimum=1e6,
        maximum=1e15,
    )
    log_free_floor: float = parameter(
        5e9,
        'free space of the disk below which logging stops',
        unit='bytes',
        minimum=0.0,
        maximum=1e15,
    )
    spectrum_length: int = parameter(
        8192, 'samples in a segment of the spectrum', minimum=64, maximum=1 << 20
    )
    spectrum_window: str = parameter(
        'hann',
        'window of spectrum and order spectrum; flattop reads any sine within 0.1 %',
        choices=('hann', 'hamming', 'blackman', 'blackmanharris', 'flattop', 'boxcar'),
    )
    spectrum_overlap: float = parameter(
        0.5, 'share of a segment that the next one has in common with it', minimum=0.0, maximum=0.9
    )
    spectrum_averaging: str = parameter(
        'linear', 'how segments are averaged', choices=('linear', 'exponential')
    )
    spectrum_averages: int = parameter(
        8, 'segments in an average, and from one result to the next', minimum=1, maximum=10000
    )
    spectrum_scale: str = parameter('peak', 'amplitude of a line', choices=('peak', 'rms'))
    order_revolutions: int = parameter(
        8, 'pinion revolutions in a segment of the order spectrum', minimum=1, maximum=1000
    )
    average_longest: float = parameter(
        20.0,
        'longest record of a synchronous average; cuts hunting-tooth periods that last longer',
        unit='s',
        minimum=0.1,
        maximum=3600.0,
    )
    average_duration: float = parameter(
        3.0,
        'record of a synchronous average: as many whole hunting-tooth periods as it holds, or one',
        unit='s',
        minimum=0.1,
        maximum=3600.0,
    )
    statistics_duration: float = parameter(
        1.0,
        'record of RMS, peak, kurtosis, envelope and contact',
        unit='s',
        minimum=0.02,
        maximum=60.0,
    )
    envelope_low: float = parameter(
        0.0, 'lower limit of the envelope band', unit='Hz', minimum=0.0, maximum=2e6
    )
    envelope_high: float = parameter(
        0.0,
        'upper limit of the envelope band; 0 takes the band of greatest kurtosis',
        unit='Hz',
        minimum=0.0,
        maximum=2e6,
    )
    section: str = parameter(
        'phase',
        'where poincare takes its points: at the section phase, or at the loss of contact',
        choices=('phase', 'contact_loss'),
    )
    regime_cycles: int = parameter(
        1024, 'mesh cycles by which the regime is judged', minimum=64, maximum=65536
    )
    recurrence_tolerance: float = parameter(
        0.01,
        'distance that counts as recurrence, in standard deviations of delta and delta_dot',
        minimum=1e-9,
        maximum=1.0,
    )
    steady_speed: float = parameter(
        0.005, 'fraction by which speed may change in steady operation', minimum=1e-6, maximum=1.0
    )
    steady_load: float = parameter(
        0.02, 'fraction by which load may change in steady operation', minimum=1e-6, maximum=1.0
    )
    settling_time: float = parameter(
        0.5,
        'time after a change of speed or load before results are judged again',
        unit='s',
        minimum=0.0,
        maximum=3600.0,
    )
    learn_spans: int = parameter(
        5, 'results in steady operation that make the baseline of a bin', minimum=2, maximum=1000
    )
    baseline: str = parameter('', 'file that keeps what is normal; empty keeps it in memory')
    thresholds: str = parameter('', "file of alarm limits; empty takes the package's own")
    indicators: list[str] = parameter(  # noqa: RUF009 (makes a default factory)
        ['mesh_force/rms', 'gear_ay/rms', 'gear_ay/kurtosis'],
        'indicators published as plain numbers, each CHANNEL/NAME',
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in self.indicators:
            if not re.fullmatch(r'[A-Za-z]\w*/[A-Za-z]\w*', name):
                raise ParameterError(f'indicators has {name!r}: each must be CHANNEL/NAME')
        if 0 < self.envelope_high <= self.envelope_low:
            raise ParameterError(
                f'envelope_high is {self.envelope_high:g}: it must be above envelope_low '
                f'{self.envelope_low:g}, or 0'
            )


@dataclasses.dataclass(frozen=True)
class ReplaySettings(ParameterSet):
    """What the `replay` node takes.

    Raises
    ------
    ParameterError
        If a value is out of its range, or no log is named.
    """

    log: str = parameter('', 'bag folder or MCAP file; several are joined by colons')
    rate: float = parameter(
        1.0,
        'speed of playing; 0 is as fast as listeners allow',
        minimum=0.0,
        maximum=1000.0,
    )
    loop: bool = parameter(False, 'whether it begins again at the end')
    start: float = parameter(
        0.0, 'where to begin, from the first message', unit='s', minimum=0.0, maximum=1e9
    )
    duration: float = parameter(
        0.0, 'how much to play; 0 is to the end', unit='s', minimum=0.0, maximum=1e9
    )
    topics: list[str] = parameter(  # noqa: RUF009 (copied for each set)
        [], 'topics to play, as they are named in the log; none is all'
    )
    paused: bool = parameter(False, 'whether it begins paused')
    listener_wait: float = parameter(
        5.0,
        'longest wait for listeners before playing; it begins when all that exist are connected',
        unit='s',
        minimum=0.0,
        maximum=1e6,
    )
    publish_clock: bool = parameter(False, 'whether /clock is published for use_sim_time')

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.log:
            raise ParameterError(
                "log is '': it must be a bag folder or an MCAP file, as in -p log:=PATH"
            )


@dataclasses.dataclass(frozen=True)
class DashboardSettings(ParameterSet):
    """What the `dashboard` takes.

    Raises
    ------
    ParameterError
        If a value is out of its range.
    """

    address: str = parameter('127.0.0.1', 'address to listen on; 0.0.0.0 lets other machines in')
    port: int = parameter(8765, 'port to listen on; 0 takes a free one', minimum=0, maximum=65535)


@dataclasses.dataclass(frozen=True)
class FoxgloveSettings(ParameterSet):
    """What the `foxglove` node takes.

    Raises
    ------
    ParameterError
        If a value is out of its range.
    """

    address: str = parameter('127.0.0.1', 'address to listen on; 0.0.0.0 lets other machines in')
    port: int = parameter(8766, 'port to listen on; 0 takes a free one', minimum=0, maximum=65535)
