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
from gear_dynamics.integrator.motion import Motion, at_rest, empty_records
from gear_dynamics.machine.columns import SAMPLE_COLUMNS, SAMPLES
from gear_dynamics.model.gear_pair import GearPair, checked_pair
from gear_dynamics.model.mesh import intervals as mesh
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.run_settings import RunSettings
from gear_dynamics.simulation.simulator import IntegrationError, Simulator, why_stopped

_BLOCK = 1 << 16


class Batch(NamedTuple):
    """Gear pairs that run side by side: arrays with one row a pair.

    `motion.zones` is (n, longest) here, of which row i has `zone_counts[i]` zones.
    """

    motion: Motion
    zone_counts: np.ndarray


def gather(pairs: Sequence[GearPair], runs: Sequence[RunSettings], drive: bool = True) -> Batch:
    """Return gear pairs at the start of their runs, ready to advance together."""
    parts = [at_rest([pair], [run], drive=drive) for pair, run in zip(pairs, runs, strict=True)]
    counts = np.array([part.zones.size for part in parts])
    zones = np.zeros((len(parts), counts.max()), mesh.ZONES)
    for row, part in zip(zones, parts, strict=True):
        row[: part.zones.size] = part.zones
    records = empty_records(len(parts))
    for i, part in enumerate(parts):
        records[i] = part.records[0]
    return Batch(Motion(records, zones, mesh.healthy()), counts)


@kernel(parallel=True)
def _fill_all(records, zones, profiles, zone_counts, no_jumps, out, status):
    for i in numba.prange(status.size):
        filled = 0
        while filled < out.shape[1]:
            count, status[i] = stepper.fill_samples(
                records[i],
                borrowed(zones)[i][: zone_counts[i]],
                borrowed(profiles),
                borrowed(no_jumps),
                1,
                borrowed(out)[i, filled:],
            )
            filled += count
            if status[i] == stepper.EVENTS_FULL:
                records[i].clock.events = 0
            elif status[i] != stepper.DONE:
                break


def _fill_band_limited(
    pairs: Sequence[GearPair], runs: Sequence[RunSettings], samples: np.ndarray
) -> None:
    """Fill row i of samples with a run of pair i, in as many threads as Numba takes."""

    def fill(i: int) -> None:
        try:
            simulator = Simulator(pairs[i], **dataclasses.asdict(runs[i]))
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

    status, records : (n,) arrays of int64 and motion.MOTION
    """
    failed = np.flatnonzero(status != stepper.DONE)
    if failed.size:
        i = int(failed[0])
        clock, rtol = records[i]['clock'], float(records[i]['constants']['rtol'])
        raise IntegrationError(
            f'row {i} of the batch, at speed {clock["speed"]:g} rad/s: '
            f'{why_stopped(clock, int(status[i]), rtol)}'
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


def simulate_batch(
    pairs: Sequence[GearPair],
    speeds: float | Sequence[float] | np.ndarray = 104.72,
    load_torques: float | Sequence[float] | np.ndarray = 150.0,
    duration: float = 1.0,
    sample_rate: float = 51200.0,
    *,
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
    samples = np.zeros((n, runs[0].sample_count(duration, SAMPLES.itemsize, n)), SAMPLES)
    if anti_alias:
        _fill_band_limited(pairs, runs, samples)
        return samples
    batch = gather(pairs, runs)
    rows = samples.view(np.float64).reshape(n, -1, len(SAMPLE_COLUMNS))
    status = np.zeros(n, np.int64)
    no_jumps = np.zeros((0, ROWS_OF_JUMP, HIGH_RATE_COLUMNS))
    _fill_all(*batch.motion, batch.zone_counts, no_jumps, rows, status)
    refuse_failure(status, batch.motion.records)
    return samples
