"""Periodic orbits of a stroboscopic map by multiple shooting, stable or not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.stroboscopic import StroboscopicMap

LONGEST = 32
"""Longest period that is looked for, in cycles."""

HALVINGS = 12
"""Times that a Newton step is halved until it brings the orbit nearer."""

REPEATS = 1e-7
"""Distance within which points of an orbit are one: its period is shorter then."""


class OrbitError(ValueError):
    """No periodic orbit was found from a start."""


class PeriodicOrbit(NamedTuple):
    """A periodic orbit.

    Attributes
    ----------
    points : (period, dimension) array
        Successive states on the section.
    residual : float
        Greatest distance of the image of a point from the next point.
    multipliers : (dimension,) complex array
        Floquet multipliers, the largest modulus first. The orbit is stable if all are below 1.
    errors : (dimension,) array
        Of the multipliers, to first order (`floquet`).
    monodromy : (dimension, dimension) array
        Derivative of the map after a period, at the first point.
    steps : int
        Newton steps taken.
    """

    points: np.ndarray
    residual: float
    multipliers: np.ndarray
    errors: np.ndarray
    monodromy: np.ndarray
    steps: int

    @property
    def period(self) -> int:
        """Cycles after which the orbit closes."""
        return len(self.points)

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie within the unit circle."""
        return bool(np.abs(self.multipliers[0]) < 1)


def periodic_orbit(
    system: StroboscopicMap,
    period: int,
    start: np.ndarray,
    *,
    tolerance: float = 1e-11,
    steps: int = 40,
) -> PeriodicOrbit:
    """Return the periodic orbit that Newton's method reaches from a start.

    Multiple shooting: the unknowns are all points of the orbit, so that long and unstable orbits
    converge too (Stoer and Bulirsch 2002, section 7.3.5). A step that does not bring the points
    nearer to an orbit is halved.

    Parameters
    ----------
    system : StroboscopicMap
        Such as `GearMap`.
    period : int
        In cycles, 1 to LONGEST. If the orbit closes sooner, its own period is returned.
    start : (dimension,) or (period, dimension) array
        The first state, whose images are the others; or a guess of all points.
    tolerance : float
        Greatest distance of the image of a point from the next, in the scale of the states.
    steps : int
        Newton steps at most.

    Returns
    -------
    PeriodicOrbit

    Raises
    ------
    OrbitError
        If the steps do not converge; it names the distance that was left.
    ValueError
        If the period is out of range, or the start has a wrong shape.
    """
    points = _first_points(system, period, start)
    images, jacobians = system.tangent(points)
    for step in range(steps + 1):
        away = images - np.roll(points, -1, axis=0)
        distance = float(np.abs(away).max())
        if distance <= tolerance:
            return _orbit(points, jacobians, distance, step)
        if step == steps or not np.isfinite(distance):
            break
        change = _newton_step(jacobians, away)
        for halving in range(HALVINGS):
            trial = points + change / 2**halving
            trial_images, trial_jacobians = system.tangent(trial)
            nearer = np.abs(trial_images - np.roll(trial, -1, axis=0)).max()
            if nearer < distance:
                break
        else:
            # Rounding of the integrator is reached, or there is nothing to converge to.
            if distance <= 100 * tolerance:
                return _orbit(points, jacobians, distance, step)
            break
        points, images, jacobians = trial, trial_images, trial_jacobians
    raise OrbitError(
        f'no orbit of period {period} was found from this start: after {step} Newton steps its '
        f'points miss each other by {distance:.2g}: try another start, or another period'
    )


def _first_points(system: StroboscopicMap, period: int, start: np.ndarray) -> np.ndarray:
    if not 1 <= period <= LONGEST:
        raise ValueError(f'period is {period}: it must be from 1 to {LONGEST}')
    start = np.array(start, dtype=float)
    if start.shape == (period, system.dimension):
        return start
    if start.shape != (system.dimension,):
        raise ValueError(
            f'start has the shape {start.shape}: it must be ({system.dimension},) or '
            f'({period}, {system.dimension})'
        )
    points = [start]
    for _ in range(period - 1):
        points.append(system.iterate(points[-1][np.newaxis])[0])
    return np.array(points)


def shooting_matrix(jacobians: np.ndarray) -> np.ndarray:
    """Return the derivative of all images minus next points, by all points of an orbit.

    jacobians : (period, dimension, dimension) array
    """
    period, d = jacobians.shape[:2]
    matrix = np.zeros((period, d, period, d))
    for i in range(period):
        matrix[i, :, i] += jacobians[i]
        matrix[i, :, (i + 1) % period] -= np.eye(d)
    return matrix.reshape(period * d, period * d)


def _newton_step(jacobians: np.ndarray, away: np.ndarray) -> np.ndarray:
    matrix = shooting_matrix(jacobians)
    try:
        return np.linalg.solve(matrix, -away.ravel()).reshape(away.shape)
    except np.linalg.LinAlgError:
        # At a fold the matrix is singular: the shortest step is as good as any.
        return np.linalg.lstsq(matrix, -away.ravel(), rcond=None)[0].reshape(away.shape)


def monodromy_of(jacobians: np.ndarray) -> np.ndarray:
    """Return the derivative of the map after a period, from those of its cycles."""
    product = np.eye(jacobians.shape[1])
    for each in jacobians:
        product = each @ product
    return product


def _orbit(points: np.ndarray, jacobians: np.ndarray, residual: float, steps: int) -> PeriodicOrbit:
    period = _own_period(points)
    points, jacobians = points[:period], jacobians[:period]
    monodromy = monodromy_of(jacobians)
    multipliers, errors = floquet(monodromy, residual)
    return PeriodicOrbit(points, residual, multipliers, errors, monodromy, steps)


def _own_period(points: np.ndarray) -> int:
    period = len(points)
    for shorter in range(1, period):
        closes = np.abs(points - np.roll(points, shorter, axis=0)).max() < REPEATS
        if period % shorter == 0 and closes:
            return shorter
    return period


def floquet(monodromy: np.ndarray, residual: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the multipliers of a monodromy matrix, the largest first, and their errors.

    An error dM moves a multiplier by y* dM x / (y* x), with its left and right eigenvectors y and x
    (Golub and Van Loan 2013, section 7.2.2). dM is taken as the residual of the orbit, or rounding
    if that is more, times the norm of M.
    """
    values, right = np.linalg.eig(monodromy)
    order = np.argsort(-np.abs(values), kind='stable')
    values, right = values[order], right[:, order]
    left = np.linalg.pinv(right)
    condition = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=0)
    size = np.linalg.norm(monodromy, 2) * max(residual, 1e-13)
    return values, condition * size
