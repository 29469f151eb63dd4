"""The record of how exponents converged."""

import numpy as np
import pytest


def assert_table_ends_at_the_exponents(outcome, motions=None):
    """The means over the whole of a record are the exponents."""
    exponents, cycles = outcome.arrays['exponents'], outcome.arrays['convergence_cycles']
    table = outcome.further['_convergence']
    motions = outcome.table if motions is None else motions
    last = slice(cycles.shape[-1] - 1, None, cycles.shape[-1])
    for i in range(10):
        column = table[f'exponent_{i + 1} [1/tau]']
        assert column[last] == pytest.approx(exponents[..., i].ravel(), rel=1e-9)
        assert np.array_equal(motions[f'exponent_{i + 1} [1/tau]'], exponents[..., i].ravel())
    assert np.array_equal(table['cycles [cycles]'][last], cycles[..., -1].ravel())
