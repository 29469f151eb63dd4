"""Delay embedding of a series, its parameters chosen by published rules."""

from __future__ import annotations

import numpy as np
from scipy import fft
from scipy.spatial import cKDTree


def embed(series: np.ndarray, dimension: int, lag: int) -> np.ndarray:
    """Return delay vectors, shape (n - (dimension - 1) lag, dimension) (Takens 1981)."""
    count = len(series) - (dimension - 1) * lag
    if count < 1:
        raise ValueError(f'{len(series)} values are too few for dimension {dimension} at lag {lag}')
    return np.stack([series[k * lag : k * lag + count] for k in range(dimension)], axis=1)


def mutual_information_lag(series: np.ndarray, longest: int) -> int:
    """Return the lag of the first minimum of the average mutual information.

    Fraser and Swinney 1986; histogram of sqrt(n / 5) equal bins a side, at most 64. `longest` if
    there is no minimum up to there.
    """
    bins = int(np.clip(np.sqrt(len(series) / 5), 4, 64))
    before = _mutual_information(series, 1, bins)
    for lag in range(2, longest + 1):
        now = _mutual_information(series, lag, bins)
        if now >= before:
            return lag - 1
        before = now
    return longest


def _mutual_information(series: np.ndarray, lag: int, bins: int) -> float:
    joint, _, _ = np.histogram2d(series[:-lag], series[lag:], bins=bins)
    joint /= joint.sum()
    product = np.outer(joint.sum(axis=1), joint.sum(axis=0))
    present = joint > 0
    return float(np.sum(joint[present] * np.log(joint[present] / product[present])))


def cao_dimension(series: np.ndarray, lag: int, highest: int = 8, enough: float = 0.9) -> int:
    """Return the embedding dimension at which Cao's E1 saturates.

    E1(d) = E(d + 1) / E(d), where E(d) is the mean growth of the distance to the nearest neighbour
    from dimension d to d + 1 in the maximum norm; the dimension is the first d with E1 of
    `enough` or more. Cao 1997, Practical method for determining the minimum embedding dimension.
    """
    growths = [_mean_growth(series, 1, lag)]
    for dimension in range(1, highest):
        growths.append(_mean_growth(series, dimension + 1, lag))
        if growths[-1] >= enough * growths[-2]:
            return dimension
    return highest


def _mean_growth(series: np.ndarray, dimension: int, lag: int) -> float:
    longer = embed(series, dimension + 1, lag)
    vectors = longer[:, :dimension]
    distances, neighbours = cKDTree(vectors).query(vectors, k=2, p=np.inf)
    apart = np.max(np.abs(longer - longer[neighbours[:, 1]]), axis=1)
    distinct = distances[:, 1] > 0
    if not distinct.any():
        return 1.0
    return float(np.mean(apart[distinct] / distances[distinct, 1]))


def mean_period(series: np.ndarray) -> float:
    """Return the mean period in samples: one over the mean frequency of the power spectrum.

    Rosenstein, Collins and De Luca 1993 keep nearest neighbours apart by it.
    """
    power = np.abs(fft.rfft(series - np.mean(series))) ** 2
    frequency = fft.rfftfreq(len(series))
    return float(power.sum() / max((power * frequency).sum(), np.finfo(float).tiny))
