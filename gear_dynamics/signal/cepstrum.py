"""The power cepstrum, which gathers a family of side bands into one line."""

from __future__ import annotations

import numpy as np
from scipy import fft

from gear_dynamics.signal.spectrum import window_samples


def power_cepstrum(
    x: np.ndarray, rate: float, *, window: str = 'hann'
) -> tuple[np.ndarray, np.ndarray]:
    """Return the power cepstrum: the inverse transform of the logarithm of the power spectrum.

    An echo of strength a after q seconds gives a at quefrency q (and -a^2/2 at 2 q, and so on);
    side bands spaced by f give a line at 1 / f. Bogert, Healy and Tukey 1963; Randall 2017,
    A history of cepstrum analysis and its application to mechanical problems.

    Parameters
    ----------
    x : ndarray, shape (n,) or (n, channels)
    rate : float
        Samples per second [Hz].
    window : str
        Name of a SciPy window.

    Returns
    -------
    quefrency : ndarray, shape (n // 2,)
        [s]
    cepstrum : ndarray, shape (n // 2,) or (n // 2, channels)
    """
    columns = np.asarray(x, dtype=float).reshape(len(x), -1)
    columns = columns - columns.mean(axis=0)
    power = np.abs(fft.fft(columns * window_samples(window, len(x))[:, np.newaxis], axis=0)) ** 2
    # The floor only keeps the logarithm finite where a line is exactly zero.
    floor = np.maximum(power.max(axis=0) * np.finfo(float).eps ** 2, np.finfo(float).tiny)
    cepstrum = fft.ifft(np.log(np.maximum(power, floor)), axis=0).real[: len(x) // 2]
    return np.arange(len(x) // 2) / rate, cepstrum.reshape((-1, *np.shape(x)[1:]))
