"""Lyapunov exponents from the growth of variations: averages that come with their uncertainty."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

BATCHES = 20
"""Parts of a record whose means give the standard error."""

CUTS = (0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2)
"""Shares of the record that are tried as transient."""

AGREE = 3.0
"""Standard errors within which the halves of a settled record agree."""

_FLOOR = 1e-6
"""Difference per tau below which halves agree in any case."""

RECORD = 50
"""Points of the convergence record."""


class Exponents(NamedTuple):
    """Lyapunov exponents per tau, in descending order.

    Attributes
    ----------
    values, standard_errors : (k,) arrays
        Means over the settled part of the record; standard errors of the means of BATCHES parts.
    convergence : (RECORD, k) array
        The means over the first cycles of the settled part.
    convergence_cycles : (RECORD,) array
        How many cycles those are.
    discarded : int
        Cycles that were judged a transient.
    settled : bool
        Whether the halves of what is left agree in the largest exponent, within AGREE standard
        errors. A record that is not settled may be a long transient.
    """

    values: np.ndarray
    standard_errors: np.ndarray
    convergence: np.ndarray
    convergence_cycles: np.ndarray
    discarded: int
    settled: bool


def exponents(growth: np.ndarray, cycle: float) -> Exponents:
    """Return the exponents of one motion.

    Parameters
    ----------
    growth : (cycles, k) array
        Logarithm of the growth of each of k orthonormal variations over each cycle, after
        orthonormalisation (Benettin, Galgani, Giorgilli and Strelcyn 1980).
    cycle : float
        Length of a cycle in tau, or in whatever the exponents shall be given per.

    Raises
    ------
    ValueError
        If there are too few cycles for a standard error.
    """
    if len(growth) < 2 * BATCHES:
        raise ValueError(f'{len(growth)} cycles are too few: give {2 * BATCHES} or more')
    rates = growth / cycle
    discarded, settled = transient(rates[:, 0])
    kept = rates[discarded:]
    values = kept.mean(axis=0)
    order = np.argsort(-values, kind='stable')
    cycles = np.unique(np.linspace(len(kept) / RECORD, len(kept), RECORD).astype(int))
    cycles = cycles[cycles > 0]
    running = np.cumsum(kept, axis=0)[cycles - 1] / cycles[:, np.newaxis]
    return Exponents(
        values[order],
        standard_error(kept)[order],
        running[:, order],
        cycles,
        discarded,
        settled,
    )


def standard_error(rows: np.ndarray) -> np.ndarray:
    """Return the standard error of the mean over axis 0 from the means of BATCHES parts.

    Parts are far longer than the correlation of neighbours, which would hide it otherwise.
    """
    length = len(rows) // BATCHES
    parts = rows[: length * BATCHES].reshape(BATCHES, length, *rows.shape[1:])
    return parts.mean(axis=1).std(axis=0, ddof=1) / math.sqrt(BATCHES)


def transient(series: np.ndarray) -> tuple[int, bool]:
    """Return how much of the beginning is a transient, and whether the rest is settled.

    Of CUTS, that which leaves the smallest standard error (White 1997, the marginal standard error
    rule) among those after which the two halves agree within AGREE standard errors.
    """
    begins = [int(cut * len(series)) for cut in CUTS]
    agreeing = [begin for begin in begins if _halves_agree(series[begin:])]
    if not agreeing:
        return begins[-1], False
    return min(agreeing, key=lambda begin: float(standard_error(series[begin:]))), True


def _halves_agree(series: np.ndarray) -> bool:
    middle = len(series) // 2
    early, late = series[:middle], series[middle:]
    if middle < BATCHES:
        return False
    error = math.hypot(standard_error(early), standard_error(late))
    return bool(abs(early.mean() - late.mean()) <= AGREE * error + _FLOOR)
