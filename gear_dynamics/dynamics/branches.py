"""Branches of periodic orbits along a parameter, through folds, with their bifurcations."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.arclength import Curve, CurvePoint, Family
from gear_dynamics.dynamics.shooting import OrbitError, PeriodicOrbit

FOLD, FLIP, TORUS, GRAZING = 'fold', 'flip', 'Neimark-Sacker', 'grazing'

LOCATED = 1e-10
"""Length of the curve within which a bifurcation is located."""

TURN = 0.9
"""Least cosine between the tangents at neighbouring orbits."""

GROWTH = 1.4
"""Factor by which the step grows where the correction was easy."""

EASY = 4
"""Newton steps up to which a correction was easy."""

AWAY = 0.01
"""Length of the first step onto the branch of doubled period."""

ROOTS = 60
"""Steps of a search for a root at most."""

ContactSequence = Callable[[CurvePoint], str]
"""Gives the sequence of contacts of an orbit."""


class Bifurcation(NamedTuple):
    """A bifurcation on a branch.

    Attributes
    ----------
    kind : str
        `fold`, `flip`, `Neimark-Sacker` or `grazing`.
    at : CurvePoint
        The orbit there.
    multiplier : complex
        The multiplier that is critical; of a grazing the largest.
    """

    kind: str
    at: CurvePoint
    multiplier: complex


class Branch(NamedTuple):
    """A branch of periodic orbits.

    Attributes
    ----------
    period : int
    orbits : list of CurvePoint
        In their order along the branch.
    bifurcations : list of Bifurcation
        Likewise.
    end : str
        Why the branch ends: `end of the range`, `closed`, `enough orbits`, `step too short`.
    """

    period: int
    orbits: list[CurvePoint]
    bifurcations: list[Bifurcation]
    end: str


def continuation(
    family: Family,
    orbit: PeriodicOrbit | CurvePoint,
    value: float,
    begin: float,
    end: float,
    *,
    rising: bool = True,
    sequence: ContactSequence | None = None,
    largest_step: float = 0.02,
    least_step: float = 1e-7,
    most: int = 2000,
) -> Branch:
    """Follow a periodic orbit along a parameter, through folds, until it leaves the range.

    Pseudo-arclength continuation (Keller 1977) with multiple shooting. Folds are located where a
    multiplier is +1 (root of det(M - I)), flips where one is -1 (root of det(M + I)),
    Neimark-Sacker bifurcations where a complex pair has modulus 1, and grazings where the sequence
    of contacts changes.

    At a grazing of a backlash oscillator the contact force is continuous, so that the map keeps
    its derivative and Newton's method its convergence; the second derivative has a singularity
    like a square root, which costs shorter steps alone.

    Parameters
    ----------
    family : callable
        Gives the system, a `StroboscopicMap`, at a value of the parameter.
    orbit : PeriodicOrbit or CurvePoint
        At `value`. A CurvePoint, such as `Curve.correct` returns, is followed along its tangent.
    value : float
        Of the parameter, from begin to end.
    begin, end : float
        Range of the parameter, begin below end.
    rising : bool
        Whether the parameter grows at first.
    sequence : callable, optional
        Gives the sequence of contacts of an orbit; without it grazings are not looked for.
    largest_step, least_step : float
        Of the length of the curve: states over their scale (root mean square over the points) and
        the parameter over its range.
    most : int
        Orbits at most.

    Returns
    -------
    Branch
        What was found, whatever ended it.

    Raises
    ------
    OrbitError
        If the orbit given does not lie on a branch.
    """
    period = len(orbit.points)
    curve = Curve(family, begin, end, period)
    if isinstance(orbit, CurvePoint):
        present = orbit
    else:
        upwards = np.zeros(orbit.points.size + 1)
        upwards[-1] = 1.0 if rising else -1.0
        present = curve.first(value, orbit.points, upwards)
    orbits, found, length = [present], [], largest_step / 4
    words = sequence(present) if sequence else ''
    why = 'enough orbits'
    while len(orbits) < most:
        try:
            following = curve.along(present, length)
            bent = following.tangent @ present.tangent < TURN
        except (OrbitError, np.linalg.LinAlgError):
            bent = True
        if bent:
            length /= 2
            if length < least_step:
                why = 'step too short'
                break
            continue
        if not begin <= following.value <= end:
            orbits += _at_the_edge(curve, present, begin if following.value < begin else end)
            why = 'end of the range'
            break
        following_words = sequence(following) if sequence else ''
        found += _between(curve, present, following, length, sequence, (words, following_words))
        present, words = following, following_words
        orbits.append(present)
        if following.steps <= EASY:
            length = min(length * GROWTH, largest_step)
        if len(orbits) > 10 and _returns(orbits, largest_step):
            why = 'closed'
            break
    return Branch(period, orbits, found, why)


def doubled_guess(family: Family, flip: Bifurcation) -> tuple[np.ndarray, np.ndarray]:
    """Return a guess of an orbit on the branch of doubled period, and the direction to it.

    At a flip the branch leaves along the eigenvector of the multiplier -1, from which the states
    depart to the one side in the first period and to the other in the second.

    Returns
    -------
    points : (2 * period, dimension) array
    direction : (2 * period * dimension + 1,) array
        As `Curve.correct` takes it.
    """
    points = flip.at.points
    values, vectors = np.linalg.eig(flip.at.monodromy)
    vector = vectors[:, np.abs(values + 1).argmin()].real
    jacobians = family(flip.at.value).tangent(points)[1]
    moved = []
    for jacobian in [*jacobians, *jacobians]:
        moved.append(vector)
        vector = jacobian @ vector
    direction = np.append(np.array(moved).ravel(), 0.0)
    direction /= np.linalg.norm(direction)
    twice = np.concatenate([points, points])
    away = AWAY * np.sqrt(len(twice)) * direction[:-1].reshape(twice.shape)
    return twice + away, direction


def _at_the_edge(curve: Curve, last: CurvePoint, value: float) -> list[CurvePoint]:
    """Return the orbit at the edge of the range, if there is one beside the last."""
    fixed = np.zeros(last.points.size + 1)
    fixed[-1] = 1.0
    try:
        edge = curve.correct(value, last.points, fixed)
    except (OrbitError, np.linalg.LinAlgError):
        return []
    return [edge._replace(tangent=edge.tangent * np.sign(edge.tangent @ last.tangent))]


def _returns(orbits: list[CurvePoint], step: float) -> bool:
    """Return whether a branch has come back to its first orbit, in its first direction."""
    first, last, before = orbits[0], orbits[-1], orbits[-2]
    gap = np.abs(first.points - last.points).max()
    passed = (first.value - last.value) * (first.value - before.value) <= 0
    return bool(gap < step and passed and first.tangent @ last.tangent > TURN)


def _between(
    curve: Curve,
    one: CurvePoint,
    other: CurvePoint,
    length: float,
    sequence: ContactSequence | None,
    words: tuple[str, str],
) -> list[Bifurcation]:
    """Return the bifurcations between two neighbouring orbits, in their order."""
    found = []
    if one.tangent[-1] * other.tangent[-1] < 0:
        at = _root(curve, one, length, lambda p: _determinant(p, -1.0))
        found.append(Bifurcation(FOLD, at, _nearest(at, 1.0)))
    if _determinant(one, 1.0) * _determinant(other, 1.0) < 0:
        at = _root(curve, one, length, lambda p: _determinant(p, 1.0))
        found.append(Bifurcation(FLIP, at, _nearest(at, -1.0)))
    if _pairs_outside(one) != _pairs_outside(other):
        count = min(_pairs_outside(one), _pairs_outside(other))
        at = _root(curve, one, length, lambda p: _pair_modulus(p, count))
        found.append(Bifurcation(TORUS, at, _pair(at, count)))
    if sequence and words[0] != words[1]:
        at = _root(curve, one, length, lambda p: -1.0 if sequence(p) == words[0] else 1.0)
        found.append(Bifurcation(GRAZING, at, complex(at.multipliers[0])))
    return sorted(found, key=lambda each: float((each.at.points - one.points).ravel()
                                                @ one.tangent[:-1]))  # fmt: skip


def _determinant(point: CurvePoint, sign: float) -> float:
    return float(np.linalg.det(point.monodromy + sign * np.eye(len(point.monodromy))))


def _nearest(point: CurvePoint, value: float) -> complex:
    return complex(point.multipliers[np.abs(point.multipliers - value).argmin()])


def _upper(point: CurvePoint) -> np.ndarray:
    """Return one of each complex pair of multipliers, the largest modulus first."""
    values = point.multipliers
    return values[values.imag > 1e-9]


def _pairs_outside(point: CurvePoint) -> int:
    return int(np.sum(np.abs(_upper(point)) > 1))


def _pair(point: CurvePoint, count: int) -> complex:
    upper = _upper(point)
    return complex(upper[count]) if count < len(upper) else complex(np.nan)


def _pair_modulus(point: CurvePoint, count: int) -> float:
    """Return by how much the modulus of a pair exceeds 1; a pair that is real has left it below."""
    pair = _pair(point, count)
    return float(abs(pair) - 1) if np.isfinite(pair) else -1.0


def _root(
    curve: Curve, one: CurvePoint, length: float, test: Callable[[CurvePoint], float]
) -> CurvePoint:
    """Return the orbit at which a test changes sign, by the Illinois variant of regula falsi."""
    low, high = 0.0, length
    at_low, at_high = test(one), test(curve.along(one, length))
    best = one
    for count in range(ROOTS):
        # Every third step a bisection: a test that is a sign alone has no slope to use.
        mixed = count % 3 and at_high != at_low
        middle = (low * at_high - high * at_low) / (at_high - at_low) if mixed else (low + high) / 2
        best = curve.along(one, middle)
        value = test(best)
        if value == 0 or abs(high - low) < LOCATED:
            break
        if value * at_high < 0:
            low, at_low = high, at_high
        else:
            at_low /= 2
        high, at_high = middle, value
    return best
