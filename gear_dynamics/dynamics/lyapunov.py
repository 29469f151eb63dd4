"""The largest Lyapunov exponent from a series."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from gear_dynamics.dynamics.embedding import (
    cao_dimension,
    embed,
    mean_period,
    mutual_information_lag,
)

CLOSEST = 0.25
"""Share of the pairs of neighbours, the closest, whose growth is followed."""

HALF_WAY = 0.5
"""Growth is exponential up to about half-way, in logarithms, from the first distance to that of
unrelated states."""

LONGEST = 15
"""Mean periods, or steps of a map, for which a pair is followed at most."""

GROUPS = 10
"""Groups of pairs, in order of time, whose slopes are compared for the uncertainty."""


class Lyapunov(NamedTuple):
    """A largest Lyapunov exponent and how it was found.

    Attributes
    ----------
    exponent, uncertainty : float
        Per second for a series with a rate, else per step. The uncertainty is one standard error
        over groups of pairs and half of what the two halves of the fitted line differ by, added in
        squares. NaN if the series is too short, or has no growth to fit a line to.
    lag, dimension : int
        Of the embedding.
    steps : int
        Steps of growth that the line was fitted to.
    """

    exponent: float
    uncertainty: float
    lag: int
    dimension: int
    steps: int


def lyapunov_exponent(
    series: np.ndarray,
    rate: float = 1.0,
    *,
    lag: int | None = None,
    dimension: int | None = None,
) -> Lyapunov:
    """Return the largest Lyapunov exponent by Rosenstein, Collins and De Luca 1993.

    The mean logarithm of the distance between nearest neighbours is followed in time; its slope
    is the exponent, from the end of the embedding window, or half-way if that is sooner, to
    saturation. Neighbours are at least a mean period apart in time; of all pairs the closest
    quarter is followed, as a short series has too little room for growth otherwise (Kantz 1994
    bounds the first distance too).

    Parameters
    ----------
    series : ndarray, shape (n,)
        One coordinate, stationary; 1000 values or more.
    rate : float
        Values per second; 1 gives an exponent per step.
    lag : int, optional
        Of the embedding: 1 for a map, such as a section. By default the first minimum of the
        mutual information (Fraser and Swinney 1986), as fits a flow.
    dimension : int, optional
        Of the embedding; by default Cao's (1997).
    """
    period = mean_period(series)
    if lag is None:
        lag = mutual_information_lag(series, max(2, math.ceil(period)))
    if dimension is None:
        dimension = cao_dimension(series, lag)
    vectors = embed(series, dimension, lag)
    apart = math.ceil(period)
    horizon = min(math.ceil(LONGEST * (period if lag > 1 else 1)), len(vectors) // 4)
    pairs = _closest_pairs(vectors[: len(vectors) - horizon], apart)
    if len(pairs) < 2 * GROUPS:
        return Lyapunov(math.nan, math.nan, lag, dimension, 0)
    curves = _growth(vectors, pairs, horizon)
    stop = _half_way(curves.mean(axis=0), _unrelated(vectors))
    start = min((dimension - 1) * lag, stop // 2)
    if stop - start < 2:
        return Lyapunov(math.nan, math.nan, lag, dimension, 0)
    exponent, uncertainty = _slope(curves[:, start : stop + 1])
    return Lyapunov(exponent * rate, uncertainty * rate, lag, dimension, stop - start)


def _closest_pairs(vectors: np.ndarray, apart: int) -> np.ndarray:
    """Return indices of the closest neighbours, shape (pairs, 2), in order of time."""
    count = min(2 * apart + 2, len(vectors))
    distances, found = cKDTree(vectors).query(vectors, k=count)
    index = np.arange(len(vectors))
    allowed = (np.abs(found - index[:, np.newaxis]) > apart) & (distances > 0)
    first = np.argmax(allowed, axis=1)
    has = allowed.any(axis=1)
    if not has.any():
        return np.empty((0, 2), dtype=int)
    nearest = distances[index, first]
    chosen = has & (nearest <= np.quantile(nearest[has], CLOSEST))
    return np.stack([index[chosen], found[index, first][chosen]], axis=1)


def _growth(vectors: np.ndarray, pairs: np.ndarray, horizon: int) -> np.ndarray:
    """Return the mean logarithm of the distance, shape (GROUPS, horizon)."""
    curves = np.empty((GROUPS, horizon))
    for step in range(horizon):
        logarithm = _log_distance(vectors[pairs[:, 0] + step], vectors[pairs[:, 1] + step])
        curves[:, step] = [np.nanmean(part) for part in np.array_split(logarithm, GROUPS)]
    return curves


def _log_distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    distance = np.linalg.norm(one - other, axis=1)
    return np.log(np.where(distance > 0, distance, np.nan))


def _unrelated(vectors: np.ndarray) -> float:
    shuffled = np.random.default_rng(0).permutation(len(vectors))
    return float(np.nanmean(_log_distance(vectors, vectors[shuffled])))


def _half_way(curve: np.ndarray, ceiling: float) -> int:
    level = curve[0] + HALF_WAY * (ceiling - curve[0])
    beyond = np.flatnonzero(curve > level)
    return int(beyond[0]) if len(beyond) else len(curve) - 1


def _slope(curves: np.ndarray) -> tuple[float, float]:
    steps = np.arange(curves.shape[1])
    slopes = np.polyfit(steps, curves.T, 1)[0]
    mean = curves.mean(axis=0)
    middle = len(mean) // 2
    early, late = (
        np.polyfit(steps[part], mean[part], 1)[0]
        for part in (slice(0, middle + 1), slice(middle, None))
    )
    statistical = float(np.std(slopes, ddof=1)) / math.sqrt(len(slopes))
    return float(slopes.mean()), math.hypot(statistical, (late - early) / 2)
