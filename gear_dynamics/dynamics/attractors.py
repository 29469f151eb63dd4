"""Attractors told apart by their points on the section."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

SAME = 0.01
"""Distance, in the scale of the section, within which two periodic orbits are one."""

NEAR = 0.05
"""Distance of a point from the points of an attractor without a period at which it lies on it."""

MOST = 0.95
"""Share of the points of a motion that must lie on an attractor without a period."""

SPREAD = 2.0
"""Factor between distances of nearest points within which two clouds of points are one."""


class Attractor(NamedTuple):
    """An attractor on the section.

    Attributes
    ----------
    kind : str
        Such as `period-3` or `chaotic`.
    period : int
        In mesh cycles; 0 without one.
    points : (period or n, 2) array
        The orbit in its order, or points that cover the attractor.
    """

    kind: str
    period: int
    points: np.ndarray


def same_orbit(first: np.ndarray, second: np.ndarray, tolerance: float = SAME) -> bool:
    """Return whether two periodic orbits are one, whatever point each begins at.

    first, second : (period, 2) arrays
        Scaled points of the section in their order.
    """
    if first.shape != second.shape:
        return False
    shifted = (np.roll(second, shift, axis=0) for shift in range(len(second)))
    return any(float(np.abs(first - each).max()) <= tolerance for each in shifted)


def same_cloud(first: np.ndarray, second: np.ndarray) -> bool:
    """Return whether the points of two motions without a period cover one attractor.

    They do if the points of each lie about as near to those of the other as to their own: medians
    of the distances to the nearest other point, within a factor of SPREAD, or within NEAR.

    first, second : (n, 2) arrays
        Scaled points of the section.
    """
    from scipy.spatial import cKDTree

    for points, others in ((first, second), (second, first)):
        tree = cKDTree(others)
        own = np.median(tree.query(others, k=2)[0][:, 1])
        if np.median(tree.query(points)[0]) > max(SPREAD * own, NEAR):
            return False
    return True


def reached(sections: np.ndarray, attractor: Attractor) -> np.ndarray:
    """Return which motions have reached an attractor.

    Parameters
    ----------
    sections : (n, cycles, 2) array
        The latest points of n motions, scaled as those of the attractor; at least two periods. Of
        an attractor with a period the last two periods count, of another all points.
    attractor : Attractor

    Returns
    -------
    (n,) array of bool
    """
    if not attractor.period:
        from scipy.spatial import cKDTree

        tree = cKDTree(attractor.points)
        distance = tree.query(sections.reshape(-1, 2), distance_upper_bound=NEAR)[0]
        on = np.isfinite(distance).reshape(sections.shape[:2])
        return on.mean(axis=1) >= MOST
    last = sections[:, -2 * attractor.period :]
    away = np.abs(last[:, -1:] - attractor.points).max(axis=-1)
    steps = np.arange(1 - last.shape[1], 1)
    expected = attractor.points[(away.argmin(axis=1)[:, np.newaxis] + steps) % attractor.period]
    return np.abs(last - expected).max(axis=(1, 2)) <= SAME


def assign(sections: np.ndarray, attractors: Sequence[Attractor]) -> np.ndarray:
    """Return the index of the attractor that each motion has reached; -1 if none of these.

    sections : (n, cycles, 2) array
        As in `reached`.
    """
    labels = np.full(len(sections), -1)
    # Those with a period first: their points may lie among those of one without.
    for i in sorted(range(len(attractors)), key=lambda i: attractors[i].period or math.inf):
        rest = np.flatnonzero(labels < 0)
        if rest.size:
            labels[rest[reached(sections[rest], attractors[i])]] = i
    return labels
