"""What is studied: a gear pair at a speed and a load, and how one of its values is varied."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gear_dynamics.config_files import config_file
from gear_dynamics.model.dimensionless import read_rig, torque_of
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.run_settings import RunSettings

FREQUENCY_RATIO = 'w'
"""Name of the ratio of the mesh frequency to wn; it stands for the speed."""

FRICTION = 'friction_coefficient'

RUN_NAMES = ('speed', 'load_torque')
"""What is studied beside the parameters of the pair."""


class OperatingPoint(NamedTuple):
    """A gear pair at work.

    Attributes
    ----------
    pair : GearPair
    speed : float
        Of the pinion [rad/s].
    load_torque : float
        On the gear [N m].
    asked_ratio : float, optional
        w, if it was asked for: it is kept where another value changes wn, and the speed follows.
    """

    pair: GearPair
    speed: float
    load_torque: float
    asked_ratio: float | None = None

    @classmethod
    def from_dimensionless(
        cls, *, frequency_ratio: float, mean_load: float, **pair: Any
    ) -> OperatingPoint:
        """Return a model of one degree of freedom at work.

        Parameters
        ----------
        frequency_ratio : float
            w: mesh frequency over wn.
        mean_load : float
            Mesh force of the load over k b.
        **pair
            As `GearPair.from_dimensionless` takes it.

        Raises
        ------
        ParameterError
            If a value is out of its range.
        """
        gears = GearPair.from_dimensionless(**pair)
        torque = torque_of(gears, mean_load)
        point = cls(gears, RunSettings().speed, RunSettings().load_torque)
        return point.with_value('load_torque', torque).with_value(FREQUENCY_RATIO, frequency_ratio)

    @property
    def frequency_ratio(self) -> float:
        """w: mesh frequency over wn."""
        return self.pair.pinion_teeth * self.speed / self.pair.derived.wn

    @property
    def cycle(self) -> float:
        """Length of a mesh cycle in tau = wn t."""
        return 2 * math.pi / self.frequency_ratio

    def value(self, name: str) -> float:
        """Return w, speed, load_torque or a number of the pair.

        Raises
        ------
        ParameterError
            If there is no such number.
        """
        if name == FREQUENCY_RATIO:
            return self.frequency_ratio
        if name in RUN_NAMES:
            return float(getattr(self, name))
        numbers = [a.name for a in self.pair.parameters() if isinstance(a.default, float)]
        self._check_name(name, numbers)
        return float(getattr(self.pair, name))

    def with_value(self, name: str, value: float | str | bool) -> OperatingPoint:
        """Return the same with another value of w, speed, load_torque or a pair's parameter.

        Of w and speed the one that is given last holds. Numbers may come as text.

        Raises
        ------
        ParameterError
            If there is no such parameter, or the value is out of its range.
        """
        if name == FREQUENCY_RATIO:
            return self._at_ratio(_number(name, value))
        changed: dict[str, Any] = {name: value}
        if name in RUN_NAMES:
            other = self._replace(**{name: getattr(_run_settings(changed), name)})
            return other._replace(asked_ratio=None) if name == 'speed' else other
        self._check_name(name, [about.name for about in self.pair.parameters()])
        other = self._replace(pair=dataclasses.replace(self.pair, **changed))
        return other if self.asked_ratio is None else other._at_ratio(self.asked_ratio)

    def _check_name(self, name: str, parameters: Sequence[str]) -> None:
        if name not in parameters:
            known = ', '.join([FREQUENCY_RATIO, *RUN_NAMES, *parameters])
            raise ParameterError(f'{name} cannot be varied; known are {known}')

    def _at_ratio(self, ratio: float) -> OperatingPoint:
        """Return the same at the speed that belongs to w, which is kept from now on."""
        speed = ratio * self.pair.derived.wn / self.pair.pinion_teeth
        try:
            return self.with_value('speed', speed)._replace(asked_ratio=ratio)
        except ParameterError as error:
            raise ParameterError(f'w is {ratio:g}: {error}') from None

    def scaled(self, sections: np.ndarray) -> np.ndarray:
        """Return delta / b and delta_dot / (b wn) of sections, (..., 2)."""
        b, wn = self.pair.half_backlash, self.pair.derived.wn
        return sections[..., :2] / [b, b * wn]


def read_operating_point(path: str | Path, **given: float) -> OperatingPoint:
    """Return the pair, speed and load torque of a ROS parameter file for `gear_sim`.

    Parameters
    ----------
    path : str or Path
    **given : float
        `speed` or `load_torque`, in place of what the file has. A file that `GearPair.to_yaml`
        wrote has neither.

    Raises
    ------
    ParameterError
        If the file is missing, has a value that is not allowed, or has no speed or load torque
        and none is given.
    """
    pair = GearPair.from_yaml(path)
    values = read_rig(path) | given
    for name in RUN_NAMES:
        if name not in values:
            default = getattr(RunSettings(), name)
            raise ParameterError(f'{path} has no {name}: give it, such as --set {name}={default:g}')
    try:
        run = _run_settings({name: values[name] for name in RUN_NAMES if name in values})
    except ParameterError as error:
        raise ParameterError(f'{path}: {error}') from None
    return OperatingPoint(pair, run.speed, run.load_torque)


def _number(name: str, value: Any) -> float:
    try:
        return float(value)
    except ValueError:
        raise ParameterError(f'{name} is {value!r}: it must be a number') from None


def _run_settings(values: dict[str, Any]) -> RunSettings:
    run = RunSettings.from_mapping(values)
    if run.speed == 0:
        raise ParameterError('speed is 0: it must be positive, as a study counts mesh cycles')
    return run


def default_operating_point() -> OperatingPoint:
    """Return the default pair at the default speed and load."""
    run = RunSettings()
    return OperatingPoint(GearPair(), run.speed, run.load_torque)


def friction_chaos() -> OperatingPoint:
    """Return the preset whose motion is chaotic without friction and periodic with it.

    Raises
    ------
    ParameterError
        If config/friction_chaos.yaml was not installed.
    """
    path = config_file('friction_chaos.yaml')
    if path is None:
        raise ParameterError('friction_chaos.yaml is not installed: name a file with --params')
    return read_operating_point(path)


def with_frictions(point: OperatingPoint, frictions: Sequence[float]) -> list[OperatingPoint]:
    """Return the point with each friction coefficient.

    Raises
    ------
    ParameterError
        If one is out of its range, or given twice.
    """
    points = [point.with_value(FRICTION, mu) for mu in frictions]
    values = [each.pair.friction_coefficient for each in points]
    for mu in values:
        if values.count(mu) > 1:
            raise ParameterError(
                f'{FRICTION} {mu:g} is given {values.count(mu)} times: give it once'
            )
    return points


def unzip(points: Sequence[OperatingPoint]) -> tuple[list, np.ndarray, np.ndarray]:
    """Return pairs, speeds and load torques as `run_cycles` takes them."""
    return (
        [each.pair for each in points],
        np.array([each.speed for each in points]),
        np.array([each.load_torque for each in points]),
    )
