"""What a picture of basins tells: shares with intervals, basin entropy, uncertainty exponent."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

TWO_SIDED_95 = 1.959963984540054
"""Standard normal deviate of a 95 % interval."""

BOX = 5
"""States along each side of a box of the basin entropy, as Daza and others (2016) use."""

LEAST_UNCERTAIN = 10
"""Pairs of states of different basins below which a distance does not count."""


def wilson_interval(
    count: np.ndarray | int, total: int, deviate: float = TWO_SIDED_95
) -> tuple[np.ndarray, np.ndarray]:
    """Return the interval of a share, by default of 95 % (Wilson 1927).

    It stays within 0 and 1, and is not empty where none or all of the draws count.

    Parameters
    ----------
    count : int or array of int
        Of independent draws.
    total : int
    deviate : float
        Standard normal deviate of the confidence.
    """
    share, z = np.asarray(count) / total, deviate
    middle = share + z**2 / (2 * total)
    half = z * np.sqrt(share * (1 - share) / total + z**2 / (4 * total**2))
    scale = 1 + z**2 / total
    low, high = (middle - half) / scale, (middle + half) / scale
    return np.where(share == 0, 0.0, low), np.where(share == 1, 1.0, high)


class BasinEntropy(NamedTuple):
    """The entropy of a picture of basins (Daza, Wagemakers, Georgeot, Guery-Odelin, Sanjuan 2016).

    Attributes
    ----------
    entropy : float
        S_b, mean over all boxes: 0 if each box has one basin, ln(basins) if all are mixed.
    boundary_entropy : float
        S_bb, mean over the boxes with more than one basin; NaN without any. Above ln 2 the boundary
        is fractal.
    boundary_boxes, boxes : int
    """

    entropy: float
    boundary_entropy: float
    boundary_boxes: int
    boxes: int


def basin_entropy(labels: np.ndarray, box: int = BOX) -> BasinEntropy:
    """Return the basin entropy of a picture.

    Parameters
    ----------
    labels : (rows, columns) array of int
        The attractor that each state reaches. What is left over of whole boxes is left out.
    box : int
        States along each side of a box.

    Raises
    ------
    ValueError
        If the picture is smaller than a box.
    """
    rows, columns = (size // box for size in labels.shape)
    if not rows * columns:
        raise ValueError(f'{labels.shape} states are fewer than a box of {box} x {box}')
    whole = labels[: rows * box, : columns * box].reshape(rows, box, columns, box)
    boxes = whole.swapaxes(1, 2).reshape(rows * columns, box * box)
    shares = np.array([(boxes == each).mean(axis=1) for each in np.unique(labels)])
    logs = np.log(shares, out=np.zeros_like(shares), where=shares > 0)
    each = -(shares * logs).sum(axis=0)
    mixed = shares.max(axis=0) < 1
    boundary = float(each[mixed].mean()) if mixed.any() else math.nan
    return BasinEntropy(float(each.mean()), boundary, int(mixed.sum()), len(boxes))


class UncertaintyExponent(NamedTuple):
    """How the share of uncertain states falls with the error of the initial state.

    Attributes
    ----------
    exponent : float
        1 for a smooth boundary, less for a fractal one, whose dimension is 2 - exponent in a plane;
        NaN where the picture is too coarse.
    standard_error : float
        Of the straight line through the logarithms.
    distances, shares : (n,) arrays
        Distance of two states, in states of the grid, and the share of pairs of states at that
        distance that reach different attractors.
    """

    exponent: float
    standard_error: float
    distances: np.ndarray
    shares: np.ndarray


def uncertainty_exponent(labels: np.ndarray) -> UncertaintyExponent:
    """Return the uncertainty exponent of a picture of basins.

    The share of pairs of states at a distance that reach different attractors grows as that
    distance to the exponent (Grebogi, McDonald, Ott and Yorke 1983). Distances run from one state
    of the grid to an eighth of the picture, along rows and columns.

    Parameters
    ----------
    labels : (rows, columns) array of int
    """
    longest = max(min(labels.shape) // 8, 1)
    steps = np.unique(np.geomspace(1, longest, 8).round().astype(int))
    counts = np.array([_differing(labels, step) for step in steps])
    enough = counts[:, 0] >= LEAST_UNCERTAIN
    steps, shares = steps[enough], counts[enough, 0] / counts[enough, 1]
    if len(steps) < 3:
        return UncertaintyExponent(math.nan, math.nan, steps, shares)
    x, y = np.log(steps), np.log(shares)
    away = x - x.mean()
    slope = float(away @ y / (away @ away))
    left = y - y.mean() - slope * away
    error = float(np.sqrt(left @ left / (len(x) - 2) / (away @ away)))
    return UncertaintyExponent(slope, error, steps, shares)


def _differing(labels: np.ndarray, step: int) -> tuple[int, int]:
    """Return how many pairs of states at a distance differ, and how many there are."""
    down, right = labels[step:] != labels[:-step], labels[:, step:] != labels[:, :-step]
    return int(down.sum() + right.sum()), down.size + right.size
