"""Condition indicators of the raw signal: its level and the shape of its distribution.

`Moments` holds the definitions; the functions apply it to one array.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gear_dynamics.signal.arguments import real_array, whole_number


class Moments:
    """Statistics of a stream, accumulated block by block.

    `rms` includes the mean. `std`, `peak`, `crest_factor`, `kurtosis` and `skewness` are about the
    mean. Kurtosis is not excess: 3 for Gaussian noise, 1.5 for a sine. Ratios are NaN for a
    constant.
    """

    def __init__(self) -> None:
        self.count = 0
        self._centre: np.ndarray | None = None

    def add(self, x: np.ndarray) -> None:
        """Take the next samples, shape (n, ...)."""
        if self._centre is None:
            # Powers are taken about a first guess of the mean, lest they cancel at the end.
            self._centre = np.asarray(x.mean(axis=0, dtype=float))
            self._sums = np.zeros((4, *x.shape[1:]))
            self._high = np.full(x.shape[1:], -np.inf)
            self._low = np.full(x.shape[1:], np.inf)
        self.count += len(x)
        centred = x - self._centre
        square = centred * centred
        self._sums[0] += centred.sum(axis=0)
        self._sums[1] += square.sum(axis=0)
        self._sums[2] += np.einsum('i...,i...->...', square, centred)
        self._sums[3] += np.einsum('i...,i...->...', square, square)
        self._high = np.maximum(self._high, centred.max(axis=0))
        self._low = np.minimum(self._low, centred.min(axis=0))

    def indicators(self) -> dict[str, np.ndarray]:
        """Return mean, rms, std, peak, crest_factor, kurtosis and skewness, one value a channel."""
        assert self._centre is not None
        m1, m2, m3, m4 = self._sums / self.count
        variance = np.maximum(m2 - m1**2, 0)
        mean, std = self._centre + m1, np.sqrt(variance)
        peak = np.maximum(self._high - m1, m1 - self._low)
        third = m3 - 3 * m1 * m2 + 2 * m1**3
        fourth = m4 - 4 * m1 * m3 + 6 * m1**2 * m2 - 3 * m1**4
        return {
            'mean': mean,
            'rms': np.sqrt(variance + mean**2),
            'std': std,
            'peak': peak,
            'crest_factor': ratio(peak, std),
            'kurtosis': ratio(fourth, variance**2),
            'skewness': ratio(third, variance**1.5),
        }


def rms(x: npt.ArrayLike, axis: int = 0) -> np.ndarray:
    """Return the root mean square, the mean included."""
    return _statistic(x, axis, 'rms')


def std(x: npt.ArrayLike, axis: int = 0) -> np.ndarray:
    """Return the standard deviation: the root mean square about the mean."""
    return _statistic(x, axis, 'std')


def peak(x: npt.ArrayLike, axis: int = 0) -> np.ndarray:
    """Return the greatest distance from the mean."""
    return _statistic(x, axis, 'peak')


def crest_factor(x: npt.ArrayLike, axis: int = 0) -> np.ndarray:
    """Return peak / standard deviation; sqrt 2 for a sine, NaN for a constant."""
    return _statistic(x, axis, 'crest_factor')


def kurtosis(x: npt.ArrayLike, axis: int = 0) -> np.ndarray:
    """Return the non-excess kurtosis: 3 for Gaussian noise, 1.5 for a sine, NaN for a constant."""
    return _statistic(x, axis, 'kurtosis')


def skewness(x: npt.ArrayLike, axis: int = 0) -> np.ndarray:
    """Return the skewness: 0 for a symmetric distribution, NaN for a constant."""
    return _statistic(x, axis, 'skewness')


def _statistic(x: npt.ArrayLike, axis: int, name: str) -> np.ndarray:
    moments = Moments()
    moments.add(real_array(x, axis=axis).astype(float, copy=False))
    return moments.indicators()[name]


def normalised_moment(x: npt.ArrayLike, order: int, axis: int = 0) -> np.ndarray:
    """Return the central moment of `order` over that power of the standard deviation.

    On Gaussian noise the orders 4, 6 and 8 give 3, 15 and 105, on a sine 1.5, 2.5 and 4.375. NaN
    for a constant.

    Parameters
    ----------
    x : array_like
    order : int
        At least 2.
    axis : int
        Axis of the samples.
    """
    order = whole_number(order, 'order', 2)
    x = real_array(x, axis=axis).astype(float, copy=False)
    centred = x - x.mean(axis=0)
    square = centred * centred
    power = centred if order % 2 else 1.0
    for _ in range(order // 2):  # faster than a power
        power = power * square
    return ratio(np.mean(power, axis=0), square.mean(axis=0) ** (order / 2))


def ratio(numerator: np.ndarray, denominator: np.ndarray) -> np.ndarray:
    """Return numerator / denominator, NaN where the denominator is zero."""
    zero = np.asarray(denominator) == 0
    return np.where(zero, np.nan, numerator / np.where(zero, 1.0, denominator))
