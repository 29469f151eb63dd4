"""Where chaos begins along a parameter: a finer sweep with longer transients about that place."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.study.exponents import EXPONENT_UNITS
from gear_dynamics.study.kind import CHAOS
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.sweep import DOWN, chain_along, follow, measure
from gear_dynamics.study.tasks import Arrays, Runner

IN_A_ROW = 3
"""Neighbouring values that must be chaotic to count as a range of chaos."""

AROUND = 3
"""Steps of the grid to either side of the onset that the finer sweep covers."""

FINER = 10
"""Values of the finer grid in a step of the other."""

TRANSIENT, RECORD = 1000, 800
"""Mesh cycles before and in the record at each value of the finer sweep. The record stays below
what the 0-1 test wants: of chaos in narrow bands, such as is found there, that says regular."""


def chaotic_ranges(values: np.ndarray, kinds: np.ndarray) -> list[tuple[float, float]]:
    """Return the first and last of the values in each stretch of IN_A_ROW or more with chaos."""
    return [(float(values[begin]), float(values[end])) for begin, end in _stretches(kinds)]


def _stretches(kinds: np.ndarray) -> list[tuple[int, int]]:
    chaotic = np.concatenate([[False], kinds == CHAOS, [False]]).astype(int)
    begins, ends = np.flatnonzero(np.diff(chaotic) == 1), np.flatnonzero(np.diff(chaotic) == -1)
    return [
        (int(begin), int(end) - 1)
        for begin, end in zip(begins, ends, strict=True)
        if end - begin >= IN_A_ROW
    ]


def onset(values: np.ndarray, kinds: np.ndarray) -> float:
    """Return the least value of chaos, NaN if there is none or it begins before the range."""
    stretches = _stretches(kinds)
    if not stretches or stretches[0][0] == 0:
        return math.nan
    return float(values[stretches[0][0]])


def refine(
    operations: list[Operation],
    parameter: str,
    values: np.ndarray,
    kinds: np.ndarray,
    states: np.ndarray,
    runner: Runner,
) -> Arrays:
    """Return finer sweeps about the onset of each of a number of sweeps.

    Swept down, the onset is the least value down to which chaos lasts.

    Parameters
    ----------
    operations : list of n Operation
    parameter : str
        What is swept.
    values : (count,) array
        Increasing. Chains go up and down in turn.
    kinds : (n, count) array
        Along `values`.
    states : (n, count, STATES) array
        After the transients of the sweeps, along `values`.
    runner : Runner

    Returns
    -------
    dict
        `values` and `kind`, (n, fine); if there is an onset, what `EXPONENT_UNITS` names too,
        (n, fine, ...). Along the values; NaN, empty or zero for sweeps without onset.
    """
    span = min(2 * AROUND, len(values) - 1)
    fine = np.full((len(operations), span * FINER + 1), np.nan)
    result = {'values': fine, 'kind': np.zeros(fine.shape, 'U16')}
    found = [i for i, kind in enumerate(kinds) if math.isfinite(onset(values, kind))]
    if not found:
        return result
    chains, starts = [], []
    for i in found:
        first = min(max(_stretches(kinds[i])[0][0] - AROUND, 0), len(values) - 1 - span)
        fine[i] = np.linspace(values[first], values[first + span], fine.shape[1])
        down = i % 2 == DOWN
        chains.append(chain_along(operations[i], parameter, fine[i, ::-1] if down else fine[i]))
        starts.append(states[i, first + span if down else first])
    measured = measure(chains, follow(chains, np.array(starts), TRANSIENT, runner), RECORD, runner)
    for name in ('kind', *EXPONENT_UNITS):
        swept = measured[name]
        empty = math.nan if swept.dtype.kind == 'f' else swept.dtype.type()
        result[name] = np.full((*fine.shape, *swept.shape[2:]), empty, swept.dtype)
        for row, i in enumerate(found):
            result[name][i] = swept[row, ::-1] if i % 2 == DOWN else swept[row]
    return result


def onset_words(values: np.ndarray, kinds: np.ndarray, does: str) -> str:
    """Return in words where a finer sweep, (fine,), shows the onset of chaos.

    does : str
        What chaos does there in the direction of the sweep.
    """
    if math.isnan(values[0]):
        return 'the range has no onset of chaos'
    if not math.isnan(onset(values, kinds)):
        return f'chaos {does} {onset(values, kinds):.6g}'
    if _stretches(kinds):
        return f'chaos {does} less than {values[0]:.6g}'
    return f'no lasting chaos between {values[0]:.6g} and {values[-1]:.6g}'
