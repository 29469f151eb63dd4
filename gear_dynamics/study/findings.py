"""What `lyapunov` and `attractor` find of one motion, and its tables and text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.exponents import (
    FLOOR,
    Exponents,
    lyapunov_spectrum,
    standard_error,
    sum_error,
)
from gear_dynamics.dynamics.regimes import AGREE, Regime, regime
from gear_dynamics.study.exponent_tables import EXPONENT_UNITS, convergence_table
from gear_dynamics.study.operating_point import OperatingPoint
from gear_dynamics.study.outcome import Arrays

UNITS = {
    'friction': '1',
    'kind': '-',
    **EXPONENT_UNITS,
    'discarded': 'cycles',
    'nearby': '1/tau',
    'nearby_error': '1/tau',
    'sections': 'b, b wn',
}


class MotionResult(NamedTuple):
    """What one motion did.

    Attributes
    ----------
    friction : float
    exponents : Exponents
    regime : Regime
    nearby, nearby_error : float
        Largest exponent and its standard error by two nearby motions.
    divergence : float
        Mean of the trace of the Jacobian along the orbit, per tau.
    """

    friction: float
    exponents: Exponents
    regime: Regime
    nearby: float
    nearby_error: float
    divergence: float

    @property
    def sum_error(self) -> float:
        """Relative difference of the sum of all exponents from the mean divergence."""
        total = self.exponents.values.sum()
        return abs(float(sum_error(total, np.asarray(self.divergence))))


def finding(point: OperatingPoint, result: Arrays, i: int) -> MotionResult:
    """Return what motion i of a task's result did."""
    cycle = point.cycle
    all_ten = lyapunov_spectrum(result['growth'][i], cycle)
    kept = slice(all_ten.discarded, None)
    near = result['nearby'][i] / cycle
    near = near[len(near) // 10 :]
    return MotionResult(
        point.pair.friction_coefficient,
        all_ten,
        regime(
            result['sections'][i, kept],
            exponent=all_ten.values[0],
            standard_error=all_ten.standard_errors[0],
        ),
        float(near.mean()),
        float(standard_error(near)),
        float(result['divergence'][i, kept].mean() / cycle),
    )


def support_exponents(point: OperatingPoint) -> tuple[float, float]:
    """Return the exponents of x1 and of x2, twice each, in closed form.

    x1 and x2 are driven by the friction force and feed nothing back: free, they decay at
    zeta_s sqrt(k_s / m).
    """
    pair, d = point.pair, point.pair.derived
    first = pair.support_damping_ratio * math.sqrt(pair.pinion_support_stiffness / d.pinion_mass)
    second = pair.support_damping_ratio * math.sqrt(pair.gear_support_stiffness / d.gear_mass)
    return -first / d.wn, -second / d.wn


def pooled(values: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean over motions, (motions, ...), and its standard error.

    The error is the larger of that within the records and that between them.
    """
    count = len(values)
    within = np.sqrt((errors**2).sum(axis=0)) / count
    between = values.std(axis=0, ddof=1) / math.sqrt(count) if count > 1 else 0.0
    return values.mean(axis=0), np.maximum(within, between)


def differing_words(near: float, near_error: float, value: float, error: float) -> list[str]:
    """Return a line if the largest exponents by nearby motions and tangent vectors differ."""
    apart, combined = abs(near - value), math.hypot(near_error, error)
    if apart <= AGREE * combined + FLOOR:
        return []
    return [
        f'  the two differ by {apart:.2g}, more than {AGREE:g} of their standard errors '
        f'({combined:.2g}): run more cycles'
    ]


def unsettled_words(group: Sequence[MotionResult]) -> list[str]:
    """Return a line about the records that are not settled, if there are any."""
    which = [np.flatnonzero(~each.exponents.settled) + 1 for each in group]
    count = sum(each.size > 0 for each in which)
    if not count:
        return []
    numbers = ', '.join(str(number) for number in np.unique(np.concatenate(which)))
    return [
        f'  not settled: {count} of {len(group)} records, in exponents {numbers}: run more cycles'
    ]


def finding_arrays(findings: Sequence[MotionResult]) -> dict[str, np.ndarray]:
    """Return exponents and their convergence, by the names of UNITS, a row for each motion."""
    all_ten = [each.exponents for each in findings]
    return {
        'friction': np.array([each.friction for each in findings]),
        'kind': np.array([each.regime.words for each in findings]),
        'exponents': np.array([each.values for each in all_ten]),
        'standard_errors': np.array([each.standard_errors for each in all_ten]),
        'settled': np.array([each.settled for each in all_ten]),
        'convergence': np.array([each.convergence for each in all_ten]),
        'convergence_cycles': np.array([each.convergence_cycles for each in all_ten]),
        'sum_error': np.array([each.sum_error for each in findings]),
        'discarded': np.array([each.discarded for each in all_ten]),
        'nearby': np.array([each.nearby for each in findings]),
        'nearby_error': np.array([each.nearby_error for each in findings]),
    }


def convergence_of(findings: Sequence[MotionResult]) -> dict[str, np.ndarray]:
    """Return the table of the means of all exponents over the first cycles."""
    each = finding_arrays(findings)
    motions = {
        'friction_coefficient [1]': each['friction'],
        'motion [1]': np.arange(1, len(findings) + 1),
    }
    return convergence_table(motions, each)
