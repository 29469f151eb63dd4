"""Tables and text of Lyapunov exponents, for all studies."""

from __future__ import annotations

import numpy as np

EXPONENT_UNITS = {
    'exponents': '1/tau',
    'standard_errors': '1/tau',
    'settled': '1',
    'convergence': '1/tau',
    'convergence_cycles': 'cycles',
    'sum_error': '1',
}
"""What a study keeps of all exponents of each motion."""


def exponent_columns(values: np.ndarray, errors: np.ndarray) -> dict[str, np.ndarray]:
    """Return the columns of a table for exponents and their errors, (..., k)."""
    columns = {}
    for i in range(values.shape[-1]):
        columns[f'exponent_{i + 1} [1/tau]'] = values[..., i]
        columns[f'exponent_{i + 1}_error [1/tau]'] = errors[..., i]
    return columns


def convergence_table(
    motions: dict[str, np.ndarray], arrays: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return the means of all exponents over the first cycles, as a table.

    motions : dict of str to (...) array
        Columns that tell the motions apart.
    arrays : dict of str to array
        What EXPONENT_UNITS names of all motions; `convergence` is (..., points, k).
    """
    points, k = arrays['convergence'].shape[-2:]
    running = arrays['convergence'].reshape(-1, k)
    return {
        **{name: np.repeat(column, points) for name, column in motions.items()},
        'cycles [cycles]': arrays['convergence_cycles'].ravel(),
        **{f'exponent_{i + 1} [1/tau]': running[:, i] for i in range(k)},
    }


def verdict(settled: np.ndarray, error: np.ndarray) -> str:
    """Return in words how far the exponents of motions, (..., k), and their sums, (...), hold."""
    return (
        f'Exponents are not settled at {np.mean(~settled.all(axis=-1)):.1%}. Their sum differs '
        f'from the mean divergence by {np.abs(error).max():.1e} of it at most.'
    )
