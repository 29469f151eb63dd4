"""Many independent gear pairs at once, over all cores."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numba
import numpy as np

from gear_dynamics.integrator import stepper
from gear_dynamics.integrator.jumps import ROWS_OF_JUMP
from gear_dynamics.integrator.kernel import borrowed, kernel
from gear_dynamics.integrator.layout import HIGH_RATE_COLUMNS
from gear_dynamics.integrator.motion import start
from gear_dynamics.integrator.records import empty_records
from gear_dynamics.machine.columns import SAMPLE_COLUMNS, SAMPLES
from gear_dynamics.model.faults import Fault, SpeedAndLoad
from gear_dynamics.model.faults.collection import checked_faults, fault_ports
from gear_dynamics.model.gear_pair import GearPair, checked_pair
from gear_dynamics.model.ports import HEALTHY, Ports, checked_ports
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.run_settings import RunSettings
from gear_dynamics.simulation.simulator import Simulator
from gear_dynamics.simulation.state import model_ports
from gear_dynamics.simulation.stepping import IntegrationError, why_stopped

_BLOCK = 1 << 16


class PairBatch(NamedTuple):
    """Gear pairs that run side by side.

    `records` is (n,) MOTION; mesh intervals of pair i are `zones[bounds[i, 0]:bounds[i + 1, 0]]`
    and its ports `ports[bounds[i, 1]:bounds[i + 1, 1]]`.
    """

    records: np.ndarray
    zones: np.ndarray
    ports: np.ndarray
    bounds: np.ndarray


def gather(
    pairs: Sequence[GearPair],
    runs: Sequence[RunSettings],
    drive: bool = True,
    ports: Sequence[Ports] | None = None,
) -> PairBatch:
    """Return gear pairs at the start of their runs, ready to advance together."""
    given = [HEALTHY] * len(pairs) if ports is None else ports
    parts = [
        start(pair, run, drive=drive, ports=model_ports(pair, run, more))
        for pair, run, more in zip(pairs, runs, given, strict=True)
    ]
    records = empty_records(len(parts))
    for i, part in enumerate(parts):
        records[i] = part.records[0]
    sizes = [(len(part.zones), len(part.ports)) for part in parts]
    return PairBatch(
        records,
        np.concatenate([part.zones for part in parts]),
        np.concatenate([part.ports for part in parts]),
        np.concatenate([np.zeros((1, 2), int), np.cumsum(sizes, axis=0)]),
    )


@kernel(parallel=True)
def _fill_all(records, zones, ports, bounds, no_jumps, out, status):
    for i in numba.prange(status.size):
        a, b, c, d = bounds[i, 0], bounds[i, 1], bounds[i + 1, 0], bounds[i + 1, 1]
        filled = 0
        while filled < out.shape[1]:
            count, status[i] = stepper.fill_samples(
                records[i],
                borrowed(zones)[a:c],
                borrowed(ports)[b:d],
                borrowed(no_jumps),
                1,
                borrowed(out)[i, filled:],
            )
            filled += count
            if status[i] == stepper.EVENTS_FULL:
                records[i].counts.events = 0
            elif status[i] != stepper.DONE:
                break


def _fill_band_limited(
    pairs: Sequence[GearPair],
    runs: Sequence[RunSettings],
    ports: Sequence[Ports],
    samples: np.ndarray,
) -> None:
    """Fill row i of samples with a run of pair i, in as many threads as Numba takes."""

    def fill(i: int) -> None:
        try:
            simulator = Simulator(pairs[i], ports=ports[i], **dataclasses.asdict(runs[i]))
            for begin in range(0, samples.shape[1], _BLOCK):
                part = samples[i, begin : begin + _BLOCK]
                part[:] = simulator.advance(len(part))
                simulator.take_events()
        except IntegrationError as error:
            raise IntegrationError(f'row {i} of the batch: {error}') from None

    with ThreadPoolExecutor(numba.get_num_threads()) as pool:
        for _ in pool.map(fill, range(len(pairs))):
            pass


def refuse_failure(status: np.ndarray, records: np.ndarray) -> None:
    """Raise IntegrationError if the integrator could not go on with one of the pairs.

    status, records : (n,) arrays of int64 and of MOTION
    """
    failed = np.flatnonzero(status != stepper.DONE)
    if failed.size:
        i = int(failed[0])
        record, rtol = records[i], float(records[i]['constants']['rtol'])
        raise IntegrationError(
            f'row {i} of the batch, at speed {record["commands"]["speed"]:g} rad/s: '
            f'{why_stopped(record, int(status[i]), rtol)}'
        )


def checked_pairs(pairs: Any) -> list[GearPair]:
    """Return what must be gear pairs.

    Raises
    ------
    ParameterError
        If there are none, or there is anything else.
    """
    if not isinstance(pairs, Iterable):
        raise ParameterError(f'pairs is {pairs!r}: it must be a list of GearPair')
    checked = [checked_pair(pair) for pair in pairs]
    if not checked:
        raise ParameterError('pairs is empty: give one gear pair or more')
    return checked


def spread(value: float | Sequence[float] | np.ndarray, n: int, name: str) -> np.ndarray:
    """Return n values of an argument that may be given once for all.

    Raises
    ------
    ParameterError
        If these are no numbers, or another number of them.
    """
    try:
        values = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ParameterError(
            f'{name} is {value!r}: give one number, or {n}, one a gear pair'
        ) from None
    if values.shape not in ((), (n,)):
        raise ParameterError(f'{name} has {values.size} values: give one, or {n}, one a gear pair')
    return np.broadcast_to(values, n)


def spread_ports(ports: Ports | Sequence[Ports], n: int) -> list[Ports]:
    """Return n ports of an argument that may be given once for all.

    Raises
    ------
    ParameterError
        If these are no ports, or another number of them.
    """
    if isinstance(ports, Ports):
        return [ports] * n
    if not isinstance(ports, Iterable):
        raise ParameterError(f'ports is {ports!r}: give Ports, or {n}, one a gear pair')
    given = [checked_ports(one) for one in ports]
    if len(given) != n:
        raise ParameterError(f'ports has {len(given)} values: give one, or {n}, one a gear pair')
    return given


def spread_faults(faults: Any, n: int) -> list[tuple[Fault, ...]]:
    """Return the faults of n machines, which may be given once for all.

    Raises
    ------
    ParameterError
        If these are no faults, or lists of another number.
    """
    given = faults if isinstance(faults, Fault) else list(faults)
    if isinstance(given, list) and given and not any(isinstance(each, Fault) for each in given):
        if len(given) != n:
            raise ParameterError(
                f'faults has {len(given)} lists: give one, or {n}, one a gear pair'
            )
        return [checked_faults(each) for each in given]
    return [checked_faults(given)] * n


def simulate_batch(
    pairs: Sequence[GearPair],
    speeds: float | Sequence[float] | np.ndarray = 104.72,
    load_torques: float | Sequence[float] | np.ndarray = 150.0,
    duration: float = 1.0,
    sample_rate: float = 51200.0,
    *,
    faults: Sequence[Fault] | Sequence[Sequence[Fault]] = (),
    ports: Ports | Sequence[Ports] = HEALTHY,
    anti_alias: bool = True,
    rtol: float = 1e-6,
    atol: float = 1e-9,
) -> np.ndarray:
    """Run many gear pairs at constant commands, over all cores.

    Each row is to the last bit what `simulate` gives for that pair. There are no events; those are
    of `simulate`. The cores are Numba's (NUMBA_NUM_THREADS).

    Parameters
    ----------
    pairs : sequence of n GearPair
    speeds : float or n floats
        Pinion speed [rad/s].
    load_torques : float or n floats
        On the gear [N m].
    duration : float
        Model time [s].
    sample_rate : float
        Samples per second [Hz].
    faults : sequence of Fault, or n of them
        What is wrong with the machines: the same with all, or a list for each.
    ports : Ports or n Ports
        How the machines depart from the healthy ones.
    anti_alias : bool
        Whether the samples are band-limited; False gives raw values.
    rtol, atol : float
        Tolerances of the integrator.

    Returns
    -------
    (n, round(duration * sample_rate)) array of SAMPLES

    Raises
    ------
    ParameterError
        If an argument is out of its range, or there are no pairs.
    IntegrationError
        If the integrator cannot go on with one of them.
    """
    pairs = checked_pairs(pairs)
    n = len(pairs)
    all_ports, all_faults = spread_ports(ports, n), spread_faults(faults, n)
    speeds, load_torques = spread(speeds, n, 'speeds'), spread(load_torques, n, 'load_torques')
    runs = [
        RunSettings(
            sample_rate=sample_rate,
            speed=float(speed),
            load_torque=float(torque),
            anti_alias=anti_alias,
            rtol=rtol,
            atol=atol,
        )
        for speed, torque in zip(speeds, load_torques, strict=True)
    ]
    for i, (pair, run) in enumerate(zip(pairs, runs, strict=True)):
        commanded = SpeedAndLoad(run.speed, run.load_torque)
        all_ports[i] = fault_ports(pair, all_faults[i], commanded) + all_ports[i]
    samples = np.zeros((n, runs[0].sample_count(duration, SAMPLES.itemsize, n)), SAMPLES)
    if anti_alias:
        _fill_band_limited(pairs, runs, all_ports, samples)
        return samples
    batch = gather(pairs, runs, ports=all_ports)
    rows = samples.view(np.float64).reshape(n, -1, len(SAMPLE_COLUMNS))
    status = np.zeros(n, np.int64)
    no_jumps = np.zeros((0, ROWS_OF_JUMP, HIGH_RATE_COLUMNS))
    _fill_all(*batch, no_jumps, rows, status)
    refuse_failure(status, batch.records)
    return samples
