"""Edges of chaos along a parameter: finer sweeps with longer transients about them."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.dynamics.regimes import CHAOS
from gear_dynamics.study.exponent_tables import EXPONENT_UNITS
from gear_dynamics.study.operating_point import OperatingPoint
from gear_dynamics.study.outcome import Arrays
from gear_dynamics.study.sweep import DOWN, chain_along, follow, measure
from gear_dynamics.study.tasks import Runner

IN_A_ROW = 3
"""Neighbouring values that must be chaotic to count as lasting chaos, whose edges are refined."""

AROUND = 3
"""Grid steps to either side of an edge that the finer sweep covers."""

FINER = 10
"""Values of the finer grid in one grid step."""

MOVES = 3
"""Times that a finer sweep moves on where its own outermost value is still chaotic."""

EDGE_TRANSIENT, EDGE_RECORD = 1000, 800
"""Mesh cycles before and in the record at each value of the finer sweep. The record is shorter than
the 0-1 test needs: for chaos in narrow bands, as found near an edge, that test says regular."""

BEGIN, END = 0, 1
"""Sides of a range of chaos, in increasing order of the parameter."""

SIDES = ('begin', 'end')


def chaotic_stretches(kinds: np.ndarray, least: int = 1) -> list[tuple[int, int]]:
    """Return the first and last index of each stretch of `least` or more chaotic values."""
    chaotic = np.concatenate([[False], kinds == CHAOS, [False]]).astype(int)
    begins, ends = np.flatnonzero(np.diff(chaotic) == 1), np.flatnonzero(np.diff(chaotic) == -1)
    return [
        (int(begin), int(end) - 1)
        for begin, end in zip(begins, ends, strict=True)
        if end - begin >= least
    ]


def edge_indices(kinds: np.ndarray) -> dict[int, int]:
    """Return the first begin and the first end of lasting chaos that lie inside the range.

    Returns
    -------
    dict
        By side, the index of the chaotic value at the edge. A side without an edge is left out.
    """
    stretches = chaotic_stretches(kinds, IN_A_ROW)
    begins = [begin for begin, _ in stretches if begin > 0]
    ends = [end for _, end in stretches if end < len(kinds) - 1]
    return {side: found[0] for side, found in ((BEGIN, begins), (END, ends)) if found}


def edge_in(values: np.ndarray, kinds: np.ndarray, side: int) -> float:
    """Return the edge of lasting chaos that a finer sweep shows; NaN if it shows none."""
    stretches = chaotic_stretches(kinds, IN_A_ROW)
    if not stretches or _open_at(kinds, side):
        return math.nan
    return float(values[stretches[0][0] if side == BEGIN else stretches[-1][1]])


def _open_at(kinds: np.ndarray, side: int) -> bool:
    """Return whether lasting chaos reaches the outermost value on that side."""
    stretches = chaotic_stretches(kinds, IN_A_ROW)
    if not stretches:
        return False
    return stretches[0][0] == 0 if side == BEGIN else stretches[-1][1] == len(kinds) - 1


def refine(
    points: list[OperatingPoint],
    parameter: str,
    values: np.ndarray,
    kinds: np.ndarray,
    states: np.ndarray,
    runner: Runner,
) -> Arrays:
    """Return finer sweeps about the edges of chaos of each of a number of sweeps.

    A finer sweep that is chaotic at its outermost value moves on until it holds the edge, at most
    MOVES times.

    Parameters
    ----------
    points : list of n OperatingPoint
    parameter : str
        The swept parameter.
    values : (count,) array
        Increasing. Sweeps go up and down in turn.
    kinds : (n, count) array
        Along `values`.
    states : (n, count, STATES) array
        After the transients of the sweeps, along `values`.
    runner : Runner

    Returns
    -------
    dict
        `values` and `kind`, (n, 2, fine), by side; if there is an edge, what `EXPONENT_UNITS`
        names too, (n, 2, fine, ...). Along the values; NaN, empty or zero where a sweep has no
        edge on that side.
    """
    span = min(2 * AROUND, len(values) - 1)
    last = len(values) - 1 - span
    shape = (len(points), len(SIDES), span * FINER + 1)
    result: Arrays = {'values': np.full(shape, np.nan), 'kind': np.zeros(shape, 'U16')}
    windows = {
        (i, side): min(max(index - AROUND, 0), last)
        for i, kind in enumerate(kinds)
        for side, index in edge_indices(kind).items()
    }
    for _ in range(1 + MOVES):
        if not windows:
            break
        _sweep_windows(points, parameter, values, states, windows, runner, result)
        windows = {
            key: min(max(first + (-span if key[1] == BEGIN else span), 0), last)
            for key, first in windows.items()
            if _open_at(result['kind'][key], key[1]) and first != (0, last)[key[1]]
        }
    return result


def _sweep_windows(
    points: list[OperatingPoint],
    parameter: str,
    values: np.ndarray,
    states: np.ndarray,
    windows: dict[tuple[int, int], int],
    runner: Runner,
    result: Arrays,
) -> None:
    """Sweep finer grids, each from the index of `values` in `windows`; write into `result`."""
    shape = result['values'].shape
    span = (shape[-1] - 1) // FINER
    chains, starts = [], []
    for (i, side), first in windows.items():
        fine = np.linspace(values[first], values[first + span], shape[-1])
        result['values'][i, side] = fine
        down = i % 2 == DOWN
        chains.append(chain_along(points[i], parameter, fine[::-1] if down else fine))
        starts.append(states[i, first + span if down else first])
    measured = measure(
        chains, follow(chains, np.array(starts), EDGE_TRANSIENT, runner), EDGE_RECORD, runner
    )
    for name in ('kind', *EXPONENT_UNITS):
        swept = measured[name]
        if name not in result:
            empty = math.nan if swept.dtype.kind == 'f' else swept.dtype.type()
            result[name] = np.full((*shape, *swept.shape[2:]), empty, swept.dtype)
        for row, (i, side) in enumerate(windows):
            result[name][i, side] = swept[row, ::-1] if i % 2 == DOWN else swept[row]


def ranges_text(values: np.ndarray, kinds: np.ndarray) -> str:
    """Return all ranges of chaos on the grid of a sweep, single values included."""
    stretches = chaotic_stretches(kinds)
    if not stretches:
        return 'no chaotic value'
    ranges = [
        f'{values[a]:.4g} to {values[b]:.4g}' if b > a else f'{values[a]:.4g}' for a, b in stretches
    ]
    return f'chaos at {", ".join(ranges)}'


def edges_text(
    values: np.ndarray, kinds: np.ndarray, fine_values: np.ndarray, fine_kinds: np.ndarray
) -> str:
    """Return where chaos begins and ends in one sweep.

    Parameters
    ----------
    values, kinds : (count,) arrays
        On the grid of the sweep.
    fine_values, fine_kinds : (2, fine) arrays
        Of `refine`, by side.
    """
    stretches = chaotic_stretches(kinds, IN_A_ROW)
    if not stretches:
        return f'no chaos at {IN_A_ROW} or more neighbouring values'
    clauses, edges = [], edge_indices(kinds)
    if stretches[0][0] == 0:
        clauses.append('chaos from the first value on')
    for side in (BEGIN, END):
        if not math.isnan(fine_values[side, 0]):
            clause = _edge_text(fine_values[side], fine_kinds[side], side)
            place, coarse = edge_in(fine_values[side], fine_kinds[side], side), values[edges[side]]
            # Chaos may be a transient that outlasts those of the grid, but not the longer ones.
            if abs(place - coarse) > 1.001 * (values[1] - values[0]):
                clause += f' after longer transients, at {coarse:.6g} on the grid'
            clauses.append(clause)
    if stretches[-1][1] == len(kinds) - 1:
        clauses.append('chaos up to the last value')
    return '; '.join(clauses)


def _edge_text(values: np.ndarray, kinds: np.ndarray, side: int) -> str:
    verb = f'chaos first {SIDES[side]}s'
    place = edge_in(values, kinds, side)
    if not math.isnan(place):
        return f'{verb} at {place:.6g}'
    if _open_at(kinds, side):
        beyond = f'below {values[0]:.6g}' if side == BEGIN else f'above {values[-1]:.6g}'
        return f'{verb} {beyond}'
    return f'no lasting chaos from {values[0]:.6g} to {values[-1]:.6g} after longer transients'
