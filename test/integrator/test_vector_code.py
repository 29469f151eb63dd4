"""The vector instructions against the plain versions of integrator/plain.py, on random numbers."""

import functools
import os
import subprocess
import sys

import numba
import numpy as np
import pytest
from ros_support import ROOT

from gear_dynamics.integrator import lanes, plain, polynomials
from gear_dynamics.integrator.layout import (
    DELTA,
    HIGH_RATE_COLUMNS,
    PADDED_TAPS,
    ROWS,
    STATES,
    TAPS,
    VALUES,
)
from gear_dynamics.machine.columns import SAMPLE_COLUMNS

SUM = 1e-12
"""Two orders of summation differ by some rounding errors of numbers near 1."""


@pytest.fixture
def rng():
    return np.random.default_rng(1)


@functools.cache
def compiled(module, name, count):
    """Return a function that may be called, since an intrinsic may not."""
    names = ', '.join(f'a{i}' for i in range(count))
    scope = {'function': getattr(module, name)}
    exec(f'def call({names}):\n    return function({names})', scope)
    return numba.njit(scope['call'])


def compared(module, name, inputs, out=None):
    """Run both versions, compiled and plain; return what each gives or writes into `out`."""
    if numba.config.DISABLE_JIT:
        pytest.skip('nothing is compiled')
    results = []
    for function in (
        compiled(module, name, len(inputs) + (out is not None)),
        getattr(plain, name),
    ):
        if out is None:
            results.append(function(*inputs))
        else:
            target = out.copy()
            function(*inputs, target)
            results.append(target)
    return results


def assert_alike(module, name, inputs, out=None, tolerance=SUM):
    got, expected = compared(module, name, inputs, out)
    np.testing.assert_allclose(got, expected, rtol=tolerance, atol=tolerance)
    if out is not None:
        assert not np.array_equal(expected, out)


@pytest.mark.parametrize('exponent', [-300, -3, 0, 1, 200])
def test_rough_logarithm(exponent, rng):
    number = (1 + rng.random()) * 2.0**exponent
    got, expected = compared(lanes, 'rough_log2', [number])
    assert got == expected
    assert abs(got - np.log2(number)) < 0.09


def test_weighted_sums(rng):
    weights = np.zeros(PADDED_TAPS)
    weights[:TAPS] = rng.standard_normal(TAPS)
    rows = rng.standard_normal((TAPS + 20, HIGH_RATE_COLUMNS))
    numbers = rng.standard_normal(PADDED_TAPS + 20)
    assert_alike(lanes, 'weighted_line', [weights, numbers, 11], tolerance=1e-11)
    out = np.zeros((4, len(SAMPLE_COLUMNS)))
    if numba.config.DISABLE_JIT:
        return
    results = []
    for function in (compiled(lanes, 'weighted_rows', 5), plain.weighted_rows):
        target = out.copy()
        function(weights, rows, 7, target, 2)
        results.append(target)
    np.testing.assert_allclose(*results, rtol=1e-11, atol=1e-11)
    assert results[0][2].any()
    assert not results[0][[0, 1, 3]].any()


@pytest.fixture
def series(rng):
    """Coefficients that fall as those of a series do."""
    return rng.standard_normal((ROWS, 8)) * 0.5 ** np.arange(ROWS)[:, np.newaxis]


def test_polynomials_of_a_series(series, rng):
    assert_alike(polynomials, 'columns_at', [series, 0.7], np.zeros((2, 8)))
    got, expected = compared(polynomials, 'advance_columns', [series, 0.7], np.zeros(STATES + 1))
    np.testing.assert_allclose(got[:STATES], expected[:STATES], rtol=SUM, atol=SUM)
    assert_alike(polynomials, 'fill_rates', [series], np.zeros((ROWS, 8)), 1e-11)
    rates = np.zeros((ROWS, 8))
    plain.fill_rates(series, rates)
    times = np.sort(rng.random(8))
    values = np.zeros((VALUES, 8))
    assert_alike(polynomials, 'fill_values', [series, rates, times], values, 1e-11)
    table = rng.standard_normal((3, ROWS)) * 0.5 ** np.arange(ROWS)
    assert_alike(polynomials, 'sixteenths', [table, 1, 0.8], np.zeros((2, 16)), 1e-11)


def test_whether_delta_stays_above_a_level(series):
    lowest = np.polynomial.polynomial.polyval(np.linspace(0, 0.8, 1001), series[:, DELTA]).min()
    for level in np.linspace(lowest - 0.5, lowest + 0.5, 41):
        got, expected = compared(polynomials, 'delta_stays_above', [series, 0.8, level])
        assert got == expected
        assert not (got and level >= lowest)
    assert compared(polynomials, 'delta_stays_above', [series, 0.8, lowest - 0.5]) == [True, True]


PROGRAM = """
import sys
import numpy as np
import gear_dynamics as gd

raw = gd.simulate(gd.GearPair(), 0.002, 25600.0, 335.1, 60.0, anti_alias=False)
limited = gd.simulate(gd.GearPair(), 0.001, 25600.0, 335.1, 60.0)
sys.stdout.buffer.write(raw.samples.tobytes() + limited.samples.tobytes())
"""


def test_a_run_without_the_compiler_is_the_same_to_rounding():
    runs = []
    for disabled in ('0', '1'):
        done = subprocess.run(
            [sys.executable, '-W', 'ignore', '-c', PROGRAM],
            cwd=ROOT,
            env=dict(os.environ, NUMBA_DISABLE_JIT=disabled),
            capture_output=True,
        )
        assert done.returncode == 0, done.stderr.decode()
        runs.append(np.frombuffer(done.stdout).reshape(-1, len(SAMPLE_COLUMNS)))
    compiled, interpreted = runs
    assert len(compiled) == 51 + 26
    scale = abs(compiled).max(axis=0)
    np.testing.assert_allclose(interpreted / scale, compiled / scale, rtol=0, atol=1e-10)
