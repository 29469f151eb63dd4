"""Tangent vectors: small differences between nearby motions."""

from __future__ import annotations

import numpy as np

from gear_dynamics.integrator.variation import VARIED
from gear_dynamics.model.gear_pair import GearPair

ROTATION = [4, 9]
"""psi and its velocity among the numbers of a tangent vector."""


def free_coordinates(pair: GearPair) -> list[int]:
    """Return which numbers of a tangent vector can differ: on rigid supports only those of psi."""
    return ROTATION if pair.support_model == 'rigid' else list(range(VARIED))


def first_tangent_vectors(
    count: int, k: int | None = None, seed: int = 0, pair: GearPair | None = None
) -> np.ndarray:
    """Return k orthonormal tangent vectors of the reduced form in general position.

    Unit vectors would not do: those of x1 and x2 never leave the plane of x1 and x2.

    Parameters
    ----------
    count : int
        Motions; all get the same vectors.
    k : int, optional
        Vectors of each motion; as many as there are free coordinates by default.
    seed : int
        Of the random directions.
    pair : GearPair, optional
        Its supports tell which coordinates are free; all of them without it.

    Returns
    -------
    (count, k, VARIED) array
    """
    free = list(range(VARIED)) if pair is None else free_coordinates(pair)
    square = np.random.default_rng(seed).normal(size=(len(free), len(free)))
    vectors = np.zeros((len(free), VARIED))
    vectors[:, free] = np.linalg.qr(square)[0]
    return np.repeat(vectors[np.newaxis, :k], count, axis=0)
