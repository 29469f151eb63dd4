"""Functions of the place on the path of contact, as piecewise polynomials."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.model.port_checks import DEGREE
from gear_dynamics.parameters.parameter import ParameterError

_SHORTEST = 1 / 64
"""Least share of the stretch between two cuts that a piece may take."""


class Pieces(NamedTuple):
    """A piecewise polynomial, in the form that `ports.ToothDeviation` takes.

    edges : (n + 1,) array
        [m]
    coefficients : (n, DEGREE + 1) array
        Of the powers of the place in the piece, from 0 to 1, the lowest first.
    """

    edges: np.ndarray
    coefficients: np.ndarray

    def at(self, s: np.ndarray) -> np.ndarray:
        """Return the values at s, an (n,) array [m]; 0 outside the edges."""
        s = np.asarray(s, float)
        piece = np.clip(np.searchsorted(self.edges, s, side='right') - 1, 0, len(self.edges) - 2)
        x = (s - self.edges[piece]) / (self.edges[piece + 1] - self.edges[piece])
        value = np.zeros(s.shape)
        for power in reversed(range(DEGREE + 1)):
            value = value * x + self.coefficients[piece, power]
        return np.where((s >= self.edges[0]) & (s <= self.edges[-1]), value, 0.0)


def fit(
    function: Callable[[np.ndarray], np.ndarray],
    cuts: Sequence[float],
    tolerance: float,
    scale: float = 0.0,
) -> Pieces:
    """Return a function of s as a piecewise polynomial.

    Parameters
    ----------
    function : callable
        Smooth between the cuts; takes and gives an (n,) array.
    cuts : sequence of float
        Where it may jump or bend, with both ends, ascending [m]. Stretches are halved until the
        polynomials fit, down to 1/64.
    tolerance : float
        Greatest error, relative to the largest value on the piece or to `scale`.
    scale : float
        Least value that the tolerance is relative to.

    Raises
    ------
    ParameterError
        If the function is not finite.
    """
    edges, rows = [float(cuts[0])], []
    for begin, end in itertools.pairwise(cuts):
        stretches = [(float(begin), float(end))]
        while stretches:
            low, high = stretches.pop()
            row, error = _fit_piece(function, low, high, tolerance, scale)
            if error > 1 and high - low > _SHORTEST * (end - begin):
                stretches += [((low + high) / 2, high), (low, (low + high) / 2)]
            else:
                edges.append(high)
                rows.append(row)
    return Pieces(np.array(edges), np.array(rows))


def _fit_piece(
    function: Callable[[np.ndarray], np.ndarray],
    begin: float,
    end: float,
    tolerance: float,
    scale: float,
) -> tuple[np.ndarray, float]:
    """Return the coefficients on a piece, and the error as a multiple of the tolerance."""
    middle, half = (begin + end) / 2, (end - begin) / 2
    nodes = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    # The ends themselves belong to the neighbours, where the function may jump.
    test = np.linspace(-1 + 1e-9, 1 - 1e-9, 33)
    values = function(middle + half * np.concatenate([nodes, test]))
    if not np.isfinite(values).all():
        raise ParameterError(f'a function of s is not finite from s = {begin:g} to {end:g} m')
    allowed = tolerance * max(float(abs(values).max()), scale)
    series = np.polynomial.chebyshev.chebfit(nodes, values[: nodes.size], DEGREE)
    series = _trimmed(series, allowed / 10)
    missed = np.polynomial.chebyshev.chebval(test, series) - values[nodes.size :]
    local = np.polynomial.Polynomial(np.polynomial.chebyshev.cheb2poly(series))
    row = local(np.polynomial.Polynomial([-1.0, 2.0])).coef
    error = float(abs(missed).max())
    return np.pad(row, (0, DEGREE + 1 - row.size)), error / allowed if error else 0.0


def _trimmed(series: np.ndarray, small: float) -> np.ndarray:
    """Return a Chebyshev series without its last terms, as far as they are small together."""
    tail = np.cumsum(abs(series[::-1]))[::-1]
    return series[: max(int((tail > small).sum()), 1)]
