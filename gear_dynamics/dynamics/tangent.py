"""Tangent vectors: small differences between nearby motions."""

from __future__ import annotations

import numpy as np

from gear_dynamics.integrator.variation import VARIED


def first_tangent_vectors(count: int, k: int | None = None, seed: int = 0) -> np.ndarray:
    """Return k orthonormal tangent vectors of the reduced form in general position.

    Unit vectors would not do: those of x1 and x2 never leave the plane of x1 and x2.

    Parameters
    ----------
    count : int
        Motions; all get the same vectors.
    k : int, optional
        Vectors of each motion; VARIED by default.
    seed : int
        Of the random directions.

    Returns
    -------
    (count, k, VARIED) array
    """
    square = np.random.default_rng(seed).normal(size=(VARIED, VARIED))
    return np.repeat(np.linalg.qr(square)[0][np.newaxis, :k], count, axis=0)
