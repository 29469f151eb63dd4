"""Condition indicators of the raw signal: its level and the shape of its distribution."""

from __future__ import annotations

import numpy as np


def rms(x: np.ndarray) -> np.ndarray:
    """Return the root mean square down the first axis, the mean included."""
    return np.sqrt(np.mean(np.square(x), axis=0))


def peak(x: np.ndarray) -> np.ndarray:
    """Return the greatest magnitude down the first axis."""
    return np.max(np.abs(x), axis=0)


def crest_factor(x: np.ndarray) -> np.ndarray:
    """Return peak / RMS; sqrt 2 for a sine, NaN for a signal of zeros."""
    return ratio(peak(x), rms(x))


def normalised_moment(x: np.ndarray, order: int) -> np.ndarray:
    """Return the central moment of `order` over that power of the standard deviation.

    Order 3 is the skewness, order 4 the kurtosis (non-excess). On Gaussian noise the orders 4, 6
    and 8 give 3, 15 and 105, on a sine 1.5, 2.5 and 4.375. NaN for a constant.

    Parameters
    ----------
    x : ndarray, shape (n,) or (n, channels)
    order : int
    """
    centred = x - np.mean(x, axis=0)
    square = centred * centred
    variance = square.mean(axis=0)
    power = square if order % 2 == 0 else square * centred
    for _ in range((order - 2) // 2 if order % 2 == 0 else (order - 3) // 2):
        power = power * square
    return ratio(power.mean(axis=0), variance ** (order / 2))


def kurtosis(x: np.ndarray) -> np.ndarray:
    """Return the non-excess kurtosis: 3 for Gaussian noise, 1.5 for a sine."""
    return normalised_moment(x, 4)


def skewness(x: np.ndarray) -> np.ndarray:
    """Return the skewness: 0 for a symmetric distribution."""
    return normalised_moment(x, 3)


class Moments:
    """The statistics above of a stream, summed block by block."""

    def __init__(self) -> None:
        self.count = 0
        self._centre: np.ndarray | None = None

    def add(self, x: np.ndarray) -> None:
        """Take the next samples, shape (n, channels)."""
        if self._centre is None:
            # Powers are taken about a first guess of the mean, lest they cancel at the end.
            self._centre = x.mean(axis=0)
            self._sums = np.zeros((4, x.shape[1]))
            self._peak = np.zeros(x.shape[1])
        self.count += len(x)
        centred = x - self._centre
        square = centred * centred
        self._sums += (
            centred.sum(axis=0),
            square.sum(axis=0),
            np.einsum('ij,ij->j', square, centred),
            np.einsum('ij,ij->j', square, square),
        )
        self._peak = np.maximum(self._peak, np.maximum(x.max(axis=0), -x.min(axis=0)))

    def indicators(self) -> dict[str, np.ndarray]:
        """Return rms, peak, crest_factor, kurtosis and skewness, one value a channel each."""
        assert self._centre is not None
        m1, m2, m3, m4 = self._sums / self.count
        variance = np.maximum(m2 - m1**2, 0)
        third = m3 - 3 * m1 * m2 + 2 * m1**3
        fourth = m4 - 4 * m1 * m3 + 6 * m1**2 * m2 - 3 * m1**4
        level = np.sqrt(variance + (self._centre + m1) ** 2)
        return {
            'rms': level,
            'peak': self._peak,
            'crest_factor': ratio(self._peak, level),
            'kurtosis': ratio(fourth, variance**2),
            'skewness': ratio(third, variance**1.5),
        }


def ratio(numerator: np.ndarray, denominator: np.ndarray) -> np.ndarray:
    """Return numerator / denominator, NaN where the denominator is zero."""
    zero = np.asarray(denominator) == 0
    return np.where(zero, np.nan, numerator / np.where(zero, 1.0, denominator))
