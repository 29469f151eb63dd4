"""What all faults have in common."""

from __future__ import annotations

import abc
import dataclasses
import math
import re
from typing import Any, ClassVar, NamedTuple

import numpy as np

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import HEALTHY, Ports
from gear_dynamics.parameters.parameter import ParameterError, ParameterSet, parameter

ALL_TEETH = -1
"""Stands for None where no empty value is known, as in ROS."""


class SpeedAndLoad(NamedTuple):
    """What a machine is commanded: pinion speed [rad/s] and load torque on the gear [N m]."""

    speed: float = 104.72
    load_torque: float = 150.0


def severity_parameter() -> Any:
    """Return the field that every fault has."""
    return parameter(0.5, 'from 0, healthy, to 1', minimum=0.0, maximum=1.0, live=True)


def wheel_parameter() -> Any:
    """Return the field of faults of one wheel."""
    return parameter('pinion', 'faulty wheel', choices=('pinion', 'gear'), live=True)


def tooth_parameter() -> Any:
    """Return the field of faults of one tooth."""
    return parameter(
        0,
        'faulty tooth, counted from 0; -1 (None in Python) stands for all',
        minimum=ALL_TEETH,
        maximum=999,
        live=True,
    )


@dataclasses.dataclass(frozen=True)
class Fault(ParameterSet, abc.ABC):
    """A fault: how a gear pair departs from the healthy one.

    Frozen; a subclass has `severity`, `wheel` and `tooth` where they apply, what its severity 1
    means in SI, and its present magnitude as a property.

    Raises
    ------
    ParameterError
        If a value is out of its range.
    """

    FOLLOWS_COMMANDS: ClassVar[bool] = False
    """Whether its ports depend on the operating point."""

    @property
    @abc.abstractmethod
    def severity(self) -> float:
        """From 0, healthy, to 1; a field of every fault."""

    def __post_init__(self) -> None:
        tooth = getattr(self, 'tooth', 0)
        if tooth is None:
            object.__setattr__(self, 'tooth', ALL_TEETH)
        try:
            super().__post_init__()
        except ParameterError as error:
            raise ParameterError(f'{self.kind()} {error}') from None
        if getattr(self, 'tooth', 0) == ALL_TEETH:
            object.__setattr__(self, 'tooth', None)

    @classmethod
    def kind(cls) -> str:
        """Return the fault's name in parameters and labels, such as 'root_crack'."""
        return re.sub(r'(?<!^)(?=[A-Z])', '_', cls.__name__).lower()

    def ports(self, pair: GearPair, commanded: SpeedAndLoad | None = None) -> Ports:
        """Return what the fault does to a gear pair; nothing at severity 0.

        Parameters
        ----------
        pair : GearPair
        commanded : SpeedAndLoad, optional
            The operating point, for the few faults that depend on it.

        Raises
        ------
        ParameterError
            If the fault does not fit the pair: in one line, with fault, value and range.
        """
        tooth, wheel = getattr(self, 'tooth', None), getattr(self, 'wheel', 'pinion')
        teeth = pair.pinion_teeth if wheel == 'pinion' else pair.gear_teeth
        if tooth is not None and tooth >= teeth:
            raise self.refusal('tooth', tooth, f'from 0 to {teeth - 1} on this {wheel}')
        if self.severity == 0:
            return HEALTHY
        return self._ports(pair, commanded or SpeedAndLoad())

    @abc.abstractmethod
    def _ports(self, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
        """Return what the fault does at a severity above 0."""

    def orders(self, pair: GearPair) -> tuple[float, ...]:
        """Return the orders of the pinion shaft at which the fault shows, the first one foremost.

        A fault of teeth or shafts gives sidebands about the mesh harmonics at these distances.
        """
        wheel = getattr(self, 'wheel', 'pinion')
        return (1.0 if wheel == 'pinion' else pair.pinion_teeth / pair.gear_teeth,)

    def refusal(self, name: str, value: Any, allowed: str) -> ParameterError:
        """Return the error that a value does not fit the pair."""
        shown = f'{value:g}' if isinstance(value, float) else value
        return ParameterError(f'{self.kind()} {name} is {shown}: it must be {allowed}')


@dataclasses.dataclass(frozen=True)
class WheelFault(Fault):
    """A fault of one wheel."""

    wheel: str = wheel_parameter()
    severity: float = severity_parameter()

    MIRROR: ClassVar[dict[str, float]] = {'pinion': 1.0, 'gear': -1.0}
    """The gear turns the other way."""


def rounded_down(value: float) -> str:
    """Return a limit to four digits that is not above it: what a message allows is allowed."""
    step = 10.0 ** (math.floor(math.log10(value)) - 3)
    return f'{math.floor(value / step) * step:.4g}'


def limits(pair: GearPair) -> np.ndarray:
    """Return both ends of the path of contact [m]."""
    return np.array([0.0, pair.derived.path_length])
