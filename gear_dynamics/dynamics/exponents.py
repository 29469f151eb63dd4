"""Lyapunov exponents from the growth of tangent vectors, with their uncertainty."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

LEAST = 40
"""Cycles below which a record tells no standard error of its halves."""

WIDTHS = (2, 4, 8)
"""How many of the lowest frequencies the standard error is taken from; the largest counts."""

CUTS = (0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2)
"""Shares of the record that are tried as transient."""

GAIN = 4.0
"""Times by which a cut must lower the error where the halves agree: what a transient does that has
ended, and chaos seldom (once in 500 records of 1000 cycles of the preset)."""

AGREE = 3.0
"""Standard errors within which the halves of a settled record agree."""

FLOOR = 1e-6
"""Difference per tau below which exponents agree in any case."""

RECORD = 50
"""Points of the convergence record."""


class Exponents(NamedTuple):
    """Lyapunov exponents per tau, in descending order.

    Attributes
    ----------
    values, standard_errors : (k,) arrays
        Means over the settled part of the record, and their standard errors.
    convergence : (RECORD, k) array
        The means over the first cycles of the settled part.
    convergence_cycles : (RECORD,) array
        How many cycles those are.
    discarded : int
        Cycles that were judged a transient.
    settled : (k,) array of bool
        Whether the halves of what is left agree in each exponent, within AGREE standard errors. A
        record that is not settled may be a long transient.
    """

    values: np.ndarray
    standard_errors: np.ndarray
    convergence: np.ndarray
    convergence_cycles: np.ndarray
    discarded: int
    settled: np.ndarray


def lyapunov_spectrum(growth: np.ndarray, cycle: float) -> Exponents:
    """Return the Lyapunov exponents of one motion, with standard errors.

    Parameters
    ----------
    growth : (cycles, k) array
        Logarithm of the growth of each of k orthonormal tangent vectors over each cycle, after
        orthonormalisation (Benettin, Galgani, Giorgilli and Strelcyn 1980).
    cycle : float
        Length of a cycle in tau, or in whatever the exponents shall be given per.

    Raises
    ------
    ValueError
        If there are too few cycles for a standard error.
    """
    if len(growth) < LEAST:
        raise ValueError(f'{len(growth)} cycles are too few: give {LEAST} or more')
    rates = growth / cycle
    discarded = transient(rates)
    kept = rates[discarded:]
    values = kept.mean(axis=0)
    order = np.argsort(-values, kind='stable')
    cycles = np.ceil(np.linspace(len(kept) / RECORD, len(kept), RECORD)).astype(int)
    running = np.cumsum(kept, axis=0)[cycles - 1] / cycles[:, np.newaxis]
    return Exponents(
        values[order],
        standard_error(kept)[order],
        running[:, order],
        cycles,
        discarded,
        halves_agree(kept)[order],
    )


def sum_error(sums: np.ndarray, divergence: np.ndarray) -> np.ndarray:
    """Return by how much sums of all exponents differ from the mean divergence, over that.

    Without any damping the divergence is zero, and the difference is returned as it is.
    """
    scale = np.abs(divergence)
    return (sums - divergence) / np.where(scale > 0, scale, 1.0)


def standard_error(rows: np.ndarray) -> np.ndarray:
    """Return the standard error of the mean over axis 0 of correlated rows, (n, ...).

    Its square is the spectral density at frequency zero over n, and that is the mean of the
    periodogram over its lowest frequencies (Heidelberger and Welch 1981). Chaos may stay near an
    unstable orbit for as long as the record can show, so that the fewest frequencies may tell what
    more would hide: the largest of the estimates by WIDTHS counts, 1.13 times the truth for noise.
    Of a periodic sequence it is the error by the period that is not whole.
    """
    lowest = np.fft.rfft(rows, axis=0)[1 : max(WIDTHS) + 1]
    power = np.abs(lowest) ** 2
    density = np.max([power[:width].mean(axis=0) for width in WIDTHS], axis=0)
    return np.sqrt(density) / len(rows)


def transient(rates: np.ndarray) -> int:
    """Return how much of the beginning is a transient, from the rates, (cycles, k).

    Of CUTS, that which leaves the smallest standard error of the first column (White 1997, the
    marginal standard error rule) among those after which the halves agree in most columns. None if
    the halves of the whole agree in all and the error gains little: to cut chaos where it looks
    best makes the error too small.
    """
    begins = [int(cut * len(rates)) for cut in CUTS]
    agreeing = [int(halves_agree(rates[begin:]).sum()) for begin in begins]
    errors = [float(standard_error(rates[begin:, 0])) for begin in begins]
    best = min(zip(errors, begins, agreeing, strict=True), key=lambda each: (-each[2], each[0]))
    if agreeing[0] == rates.shape[1] and GAIN * best[0] >= errors[0]:
        return 0
    return best[1]


def halves_agree(rates: np.ndarray) -> np.ndarray:
    """Return for each column whether the means of the halves agree within AGREE standard errors."""
    middle = len(rates) // 2
    if len(rates) < LEAST:
        return np.zeros(rates.shape[1], bool)
    early, late = rates[:middle], rates[middle:]
    error = np.hypot(standard_error(early), standard_error(late))
    return np.abs(early.mean(axis=0) - late.mean(axis=0)) <= AGREE * error + FLOOR
