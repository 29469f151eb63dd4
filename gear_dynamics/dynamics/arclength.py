"""The curve of periodic orbits along a parameter, and steps on it by pseudo-arclength."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.shooting import OrbitError, monodromy_of, shooting_matrix
from gear_dynamics.dynamics.stroboscopic import StroboscopicMap

Family = Callable[[float], StroboscopicMap]
"""Gives the system at a value of the parameter."""

TOLERANCE = 1e-11
"""Greatest distance of the image of a point from the next, on the curve."""

NEWTON = 12
"""Newton steps of a correction at most; further ones are taken with a shorter step instead."""

DIFFERENCE = 1e-6
"""Step of the central difference by the parameter, over the length of its range."""


class CurvePoint(NamedTuple):
    """An orbit on a curve of orbits.

    Attributes
    ----------
    value : float
        Of the parameter.
    points : (period, dimension) array
    monodromy : (dimension, dimension) array
    tangent : (period * dimension + 1,) array
        Unit direction of the curve; its last component is that of the parameter over its range.
    steps : int
        Newton steps of the correction.
    """

    value: float
    points: np.ndarray
    monodromy: np.ndarray
    tangent: np.ndarray
    steps: int

    @property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, the largest modulus first."""
        values = np.linalg.eigvals(self.monodromy)
        return values[np.argsort(-np.abs(values), kind='stable')]

    @property
    def unstable(self) -> int:
        """Number of multipliers outside of the unit circle."""
        return int(np.sum(np.abs(np.linalg.eigvals(self.monodromy)) > 1))


class Curve:
    """The curve of orbits of one period.

    Parameters
    ----------
    family : callable
        Gives the system at a value of the parameter.
    begin, end : float
        Range of the parameter, in which it is measured.
    period : int
        Of the orbits, in cycles.
    """

    def __init__(self, family: Family, begin: float, end: float, period: int) -> None:
        self.family, self.begin, self.end, self.period = family, begin, end, period

    def first(self, value: float, points: np.ndarray, towards: np.ndarray) -> CurvePoint:
        """Return an orbit of the curve with its tangent.

        towards : (period * dimension + 1,) array
            A direction that the tangent shall have a positive component in.
        """
        return self.correct(value, points, towards)

    def along(self, point: CurvePoint, length: float) -> CurvePoint:
        """Return the orbit at a length along the tangent of another.

        Raises
        ------
        OrbitError
            If the correction does not converge.
        """
        moved = point.points + length * self._root() * point.tangent[:-1].reshape(
            point.points.shape
        )
        value = point.value + length * point.tangent[-1] * (self.end - self.begin)
        return self.correct(value, moved, point.tangent)

    def correct(self, value: float, points: np.ndarray, direction: np.ndarray) -> CurvePoint:
        """Return the orbit in the plane through a guess that is normal to a direction.

        Raises
        ------
        OrbitError
            If Newton's method does not converge.
        """
        points, distance = np.array(points, dtype=float), np.inf
        by_value = self._by_value(value, points)
        for step in range(NEWTON + 1):
            images, jacobians = self._system(value).tangent(points)
            away = (images - np.roll(points, -1, axis=0)).ravel()
            before, distance = distance, float(np.abs(away).max())
            if not np.isfinite(distance) or distance > 10 * max(before, 0.1):
                break
            bordered = self._bordered(jacobians, by_value, direction)
            if distance <= TOLERANCE:
                tangent = np.linalg.solve(bordered, np.eye(len(bordered))[-1])
                tangent /= np.linalg.norm(tangent)
                return CurvePoint(value, points, monodromy_of(jacobians), tangent, step)
            if step == NEWTON:
                break
            change = np.linalg.solve(bordered, np.append(-away, 0.0))
            points = points + self._root() * change[:-1].reshape(points.shape)
            value = float(value + change[-1] * (self.end - self.begin))
        raise OrbitError(f'no orbit was found beside {value:.6g}: {distance:.2g} was left')

    def _root(self) -> float:
        """Return what scales points, so that a curve's length does not grow with the period."""
        return float(np.sqrt(self.period))

    def _by_value(self, value: float, points: np.ndarray) -> np.ndarray:
        """Return the derivative of the images by the parameter over its range."""
        step = DIFFERENCE * (self.end - self.begin)
        ends = [self._image(value + each, points) for each in (step, 0.0, -step)]
        # At the limit of a parameter the difference is one-sided.
        kept = [(i, each) for i, each in enumerate(ends) if each is not None]
        if len(kept) < 2:
            raise OrbitError(f'the parameter cannot be varied about {value:.6g}')
        (first, above), (last, below) = kept[0], kept[-1]
        return ((above - below) / ((last - first) * DIFFERENCE)).ravel()

    def _image(self, value: float, points: np.ndarray) -> np.ndarray | None:
        try:
            return self._system(value).iterate(points)
        except OrbitError:
            return None

    def _system(self, value: float) -> StroboscopicMap:
        """Return the system at a value.

        Raises
        ------
        OrbitError
            If the value is far out of the range, or the parameter cannot have it.
        """
        margin = self.end - self.begin
        if self.begin - margin <= value <= self.end + margin:
            try:
                return self.family(value)
            except ValueError:
                pass
        raise OrbitError(f'there is no system at {value:.6g}')

    def _bordered(
        self, jacobians: np.ndarray, by_value: np.ndarray, direction: np.ndarray
    ) -> np.ndarray:
        matrix = np.zeros((len(by_value) + 1,) * 2)
        matrix[:-1, :-1] = shooting_matrix(jacobians) * self._root()
        matrix[:-1, -1] = by_value
        matrix[-1] = direction
        return matrix
