"""Tasks of the regime map: the attractors that several starts reach at each operating point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.attractors import same_cloud, same_orbit
from gear_dynamics.dynamics.regimes import LONGEST_STUDIED, RECURS
from gear_dynamics.study.assessment import assess
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import OperatingPoint, unzip
from gear_dynamics.study.outcome import Arrays

SECTION = 0.0
"""Mesh phase of the section: a motion goes on from it."""

SAMPLES = 64
"""Samples of delta in a mesh cycle, for the RMS, the peaks and the share out of contact."""

SAMPLED = 2 * LONGEST_STUDIED
"""Mesh cycles that are sampled at least; whole periods of a periodic motion."""

JOIN = ' + '
"""Between the attractors in the name of a set."""

CELL_UNITS = {
    'kind': '-',
    'period': 'cycles',
    'exponent': '1/tau',
    'standard_error': '1/tau',
    'settled': '1',
    'rms': 'b',
    'least': 'b',
    'greatest': 'b',
    'out_of_contact': '1',
    'share': '1',
    'mean': 'b',
}
"""What is told of each attractor; `mean` is that of delta on the section."""


def cells_task(
    points: list[OperatingPoint], starts: int, transient: int, cycles: int, section_phase: float
) -> Arrays:
    """Return the attractors at each operating point, by the names of CELL_UNITS.

    `cell` (n,) is the index of the operating point of each attractor. The starts are the static
    state and others from a fixed seed; `share` is the part of them that reached the attractor.
    Motions that share a periodic orbit after the transient are assessed once.
    """
    motions = [point for point in points for _ in range(starts)]
    states = np.concatenate([scattered_states(point, starts) for point in points])
    if transient:
        states = dynamics.run_cycles(*unzip(motions), transient, states=states).states
    record = dynamics.run_cycles(
        *unzip(motions), 4 * LONGEST_STUDIED, states=states, section_phase=section_phase
    )
    sections = [e.scaled(section) for e, section in zip(motions, record.sections, strict=True)]
    groups = _groups(sections, starts)
    first = [group[0] for group in groups]
    chosen = [motions[i] for i in first]
    assessed = assess(chosen, record.states[first], cycles, k=1, section_phase=section_phase)
    kept = _merged(groups, assessed, starts)
    sampled = _sampled([chosen[i] for i in kept], assessed, list(kept))
    arrays = {
        'cell': np.array([first[i] // starts for i in kept]),
        'kind': assessed['kind'][[*kept]],
        'period': assessed['period'][[*kept]],
        'exponent': assessed['exponents'][[*kept], 0],
        'standard_error': assessed['standard_errors'][[*kept], 0],
        'settled': assessed['settled'][[*kept], 0],
        'share': np.array([count / starts for count in kept.values()]),
        'mean': np.array([assessed['sections'][i, :, 0].mean() for i in kept]),
    }
    return arrays | sampled


def _groups(sections: Sequence[np.ndarray], starts: int) -> list[list[int]]:
    """Return the motions of each cell that share a periodic orbit; others stand alone."""
    groups: list[list[int]] = []
    orbits: list[np.ndarray] = []
    for i, section in enumerate(sections):
        period = dynamics.recurrence_period(section, RECURS, LONGEST_STUDIED)[0]
        orbit = section[-period:] if period else np.empty((0, 2))
        for group, other in zip(groups, orbits, strict=True):
            if period and group[0] // starts == i // starts and same_orbit(orbit, other):
                group.append(i)
                break
        else:
            groups.append([i])
            orbits.append(orbit)
    return groups


def _merged(groups: list[list[int]], assessed: Arrays, starts: int) -> dict[int, int]:
    """Return the groups that are attractors of their own, with how many motions reached each."""
    kept: dict[int, int] = {}
    for i, group in enumerate(groups):
        for j in kept:
            if groups[j][0] // starts == group[0] // starts and _one_attractor(assessed, i, j):
                kept[j] += len(group)
                break
        else:
            kept[i] = len(group)
    return kept


def _one_attractor(assessed: Arrays, i: int, j: int) -> bool:
    """Return whether two assessed motions are on one attractor."""
    if assessed['kind'][i] != assessed['kind'][j]:
        return False
    period = int(assessed['period'][i])
    first, second = assessed['sections'][i], assessed['sections'][j]
    if period:
        return same_orbit(first[-period:], second[-period:])
    return same_cloud(first, second)


def _sampled(points: list[OperatingPoint], assessed: Arrays, kept: list[int]) -> Arrays:
    """Return RMS, extremes and share out of contact of delta / b over whole periods."""
    run = dynamics.run_cycles(
        *unzip(points), SAMPLED, states=assessed['states'][kept], samples_per_cycle=SAMPLES
    )
    rows = []
    for point, samples, i in zip(points, run.samples, kept, strict=True):
        period = int(assessed['period'][i]) or SAMPLED
        whole = SAMPLED // period * period * SAMPLES
        delta = samples['delta'][:whole] / point.pair.half_backlash
        rows.append((delta.std(), delta.min(), delta.max(), np.mean(np.abs(delta) < 1)))
    names = ('rms', 'least', 'greatest', 'out_of_contact')
    return dict(zip(names, np.array(rows).T, strict=True))


class RegimeGrid(NamedTuple):
    """Values of two parameters, and which pairs of them are computed in which pass.

    Attributes
    ----------
    values, across : arrays
        Of the finest grid.
    stride : int
        Of the first pass; each pass halves it.
    """

    values: np.ndarray
    across: np.ndarray
    stride: int

    @classmethod
    def over(
        cls,
        ends: tuple[float, float],
        count: int,
        others: tuple[float, float],
        rows: int,
        fine: int,
    ) -> RegimeGrid:
        """Return a grid of `count` times `rows` that can be halved `fine` times."""
        stride = 2**fine
        return cls(
            np.linspace(*ends, (count - 1) * stride + 1),
            np.linspace(*others, (rows - 1) * stride + 1),
            stride,
        )

    def first(self) -> list[tuple[int, int]]:
        """Return the places of the first pass, (row, column)."""
        rows = range(0, len(self.across), self.stride)
        return [(i, j) for i in rows for j in range(0, len(self.values), self.stride)]

    def between(self, stride: int) -> list[tuple[tuple[int, int], list[tuple[int, int]]]]:
        """Return the places between those of a stride, each with its neighbours among them."""
        half, found = stride // 2, []
        for i in range(0, len(self.across), half):
            for j in range(0, len(self.values), half):
                rows = (i,) if i % stride == 0 else (i - half, i + half)
                columns = (j,) if j % stride == 0 else (j - half, j + half)
                if len(rows) + len(columns) > 2:
                    found.append(((i, j), [(row, column) for row in rows for column in columns]))
        return found


def set_name(kinds: Sequence[str]) -> str:
    """Return the name of a set of attractors, such as `period-1 + chaotic`: periods first."""

    def order(kind: str) -> tuple[int, int, str]:
        digits = kind.rpartition('-')[2]
        return (0, int(digits), kind) if digits.isdigit() else (1, 0, kind)

    return JOIN.join(sorted(kinds, key=order))
