"""The 0-1 test for chaos."""

from __future__ import annotations

import numpy as np
from scipy import fft


def zero_one_test(series: np.ndarray, frequencies: int = 100, seed: int = 0) -> float:
    """Return K of the 0-1 test: near 0 for regular, near 1 for chaotic dynamics.

    The correlation method with the regularised mean square displacement, and the median over
    random frequencies in (pi/5, 4 pi/5): Gottwald and Melbourne 2009, On the implementation of
    the 0-1 test for chaos, equations 2.3 to 2.6. Displacements run to a tenth of the series, as
    they advise. Give it a section, or a series sampled so coarsely that neighbours differ: on
    oversampled data the test says regular.

    Parameters
    ----------
    series : ndarray, shape (n,)
        1000 values or more give a clear answer.
    frequencies : int
    seed : int
        Of the random frequencies, so that a record has one answer.

    Raises
    ------
    ValueError
        If there are fewer than 100 values.
    """
    count = len(series)
    if count < 100:
        raise ValueError(f'{count} values are too few for the 0-1 test: give it 100 or more')
    generator = np.random.default_rng(seed)
    c = generator.uniform(np.pi / 5, 4 * np.pi / 5, frequencies)
    lags = count // 10
    rotation = np.exp(1j * np.outer(c, np.arange(1, count + 1)))
    translation = np.cumsum(series * rotation, axis=1)
    displacement = _mean_square_displacement(translation, lags)
    n = np.arange(1, lags + 1)
    oscillation = np.mean(series) ** 2 * (1 - np.cos(np.outer(c, n))) / (1 - np.cos(c))[:, None]
    return float(np.median(_correlation_with_ramp(displacement - oscillation)))


def _mean_square_displacement(paths: np.ndarray, lags: int) -> np.ndarray:
    """Return the mean of |z(j + n) - z(j)|^2 over j for n = 1 ... lags, by Fourier transform."""
    paths = paths - paths.mean(axis=1, keepdims=True)
    kept = paths.shape[1] - lags
    size = fft.next_fast_len(paths.shape[1] + kept)
    product = fft.fft(paths, size, axis=1) * np.conj(fft.fft(paths[:, :kept], size, axis=1))
    correlation = fft.ifft(product, axis=1).real[:, 1 : lags + 1]
    energy = np.cumsum(np.abs(paths) ** 2, axis=1)
    later = energy[:, kept : kept + lags] - energy[:, :lags]
    return (later + energy[:, kept - 1 : kept] - 2 * correlation) / kept


def _correlation_with_ramp(rows: np.ndarray) -> np.ndarray:
    ramp = np.arange(rows.shape[1]) - (rows.shape[1] - 1) / 2
    centred = rows - rows.mean(axis=1, keepdims=True)
    norms = np.sqrt((centred**2).sum(axis=1) * (ramp**2).sum())
    return centred @ ramp / np.where(norms > 0, norms, 1.0)
