"""How the model's kernels are compiled."""

import numba

kernel = numba.njit(cache=True, error_model='numpy')
"""Decorator: compiled once and cached on disk; a division by zero gives inf as in NumPy, which
spares a test at each division. Never fastmath: chaotic runs must repeat to the last bit."""
