"""The angle of a shaft as a function of time, from pulses, angles or speeds."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt
from scipy import interpolate

from gear_dynamics.signal.arguments import positive, real_series
from gear_dynamics.signal.tacho import even_pulses

MOST_POINTS = 64
"""Points in a revolution that an angle is kept at; more is the noise of its steps."""


MOST_MARKS = 128
"""Marks of a wheel whose places are worth learning."""


@dataclasses.dataclass(frozen=True)
class ShaftPhase:
    """The angle of a shaft.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Rising [s].
    revolutions : ndarray, shape (n,)
        Rising; a fixed speed has two points.
    """

    time: np.ndarray
    revolutions: np.ndarray

    @property
    def start(self) -> float:
        """First instant at which the angle is known [s]."""
        return float(self.time[0])

    @property
    def end(self) -> float:
        """Last instant at which the angle is known [s]."""
        return float(self.time[-1])

    @property
    def turned(self) -> float:
        """Revolutions from start to end."""
        return float(self.revolutions[-1] - self.revolutions[0])

    @property
    def speed(self) -> float:
        """Mean speed [revolutions/s]."""
        return self.turned / (self.end - self.start)

    @property
    def variation(self) -> float:
        """Range of the speed over its mean, from the angle in tenths of the time."""
        if len(self.time) < 4:
            return 0.0
        edges = np.linspace(self.start, self.end, 11)
        speeds = np.diff(self.at(edges)) / np.diff(edges)
        return float(np.ptp(speeds) / abs(self.speed))

    def at(self, time: np.ndarray) -> np.ndarray:
        """Return the revolutions at instants from start to end [s]."""
        if len(self.time) < 4:
            return np.interp(time, self.time, self.revolutions)
        # Monotone between the points, with a continuous speed (Fritsch and Carlson 1980).
        return interpolate.PchipInterpolator(self.time, self.revolutions)(time)


def phase_from_pulses(instants: npt.ArrayLike, numbers: npt.ArrayLike, pulses: float) -> ShaftPhase:
    """Return the angle from the instants [s] of numbered pulses, `pulses` a revolution.

    Marks that are not evenly spaced are calibrated out where there are a few of them.
    """
    instants, numbers = (
        real_series(instants, 'instants').astype(float, copy=False),
        np.asarray(numbers),
    )
    if pulses == int(pulses) and 2 <= pulses <= MOST_MARKS:
        return ShaftPhase(instants, even_pulses(instants, numbers, int(pulses)))
    return ShaftPhase(instants, numbers / pulses)


def phase_from_angle(
    angle: npt.ArrayLike, rate: float, revolution: float, start: float = 0.0
) -> ShaftPhase:
    """Return the angle from samples of it, wrapped or not.

    Samples are averaged in groups of at most a 64th of a revolution, so that the steps of an
    encoder's counts do not show.

    Parameters
    ----------
    angle : array_like, shape (n,)
        In any unit, moving by less than half a revolution a sample.
    rate : float
        [Hz]
    revolution : float
        Values in a revolution.
    start : float
        Time of the first sample [s].

    Raises
    ------
    ValueError
        If the shaft stands still or turns to and fro, or a value is not finite.
    """
    rate, revolution = positive(rate, 'rate'), positive(revolution, 'revolution')
    turned = (
        np.unwrap(real_series(angle, 'angle').astype(float, copy=False), period=revolution)
        / revolution
    )
    if turned[-1] < turned[0]:
        turned = -turned
    travel = turned[-1] - turned[0]
    if travel <= 0:
        raise ValueError('the angle stands still')
    group = max(1, int(len(turned) / (travel * MOST_POINTS)))
    count = len(turned) // group
    if count < 4:
        raise ValueError('the angle holds too few samples')
    means = turned[: count * group].reshape(count, group).mean(axis=1)
    if not np.all(np.diff(means) > 0):
        raise ValueError('the shaft stops or turns back')
    time = start + (np.arange(count) * group + (group - 1) / 2) / rate
    return ShaftPhase(time, means)


def phase_from_speed(speed: npt.ArrayLike, rate: float, start: float = 0.0) -> ShaftPhase:
    """Return the angle as the integral of samples of the speed [revolutions/s].

    Raises
    ------
    ValueError
        If the shaft stands still or turns back, or a value is not finite.
    """
    rate, speed = positive(rate, 'rate'), real_series(speed, 'speed').astype(float, copy=False)
    if np.mean(speed) < 0:
        speed = -speed
    if not np.all(speed > 0):
        raise ValueError('the shaft stops or turns back')
    steps = (speed[1:] + speed[:-1]) / (2 * rate)
    return ShaftPhase(
        start + np.arange(len(speed)) / rate, np.concatenate([[0.0], np.cumsum(steps)])
    )


def phase_from_constant(speed: float, start: float, end: float) -> ShaftPhase:
    """Return the angle at a constant speed [revolutions/s] from `start` to `end` [s]."""
    return ShaftPhase(np.array([start, end]), np.array([0.0, speed * (end - start)]))
