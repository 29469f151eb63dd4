"""The ground truth of faults: what listeners are told of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from gear_dynamics.model.faults.fault import Fault
from gear_dynamics.model.gear_pair import GearPair


class Label(NamedTuple):
    """One fault of a machine.

    Attributes
    ----------
    fault : str
        Its kind, such as 'root_crack'.
    wheel : str
        'pinion' or 'gear'; empty where it concerns no wheel.
    tooth : int or None
        None for all teeth, or where it concerns no tooth.
    severity : float
        From 0 to 1: the target, while it ramps.
    orders : tuple of float
        Orders of the pinion shaft at which the fault shows, see `Fault.orders`.
    """

    fault: str
    wheel: str
    tooth: int | None
    severity: float
    orders: tuple[float, ...]

    def values(self) -> dict[str, str]:
        """Return the label as the text values of a diagnostic status."""
        return {
            'fault': self.fault,
            'wheel': self.wheel,
            'tooth': '' if self.tooth is None else str(self.tooth),
            'severity': f'{self.severity:g}',
            'orders': ' '.join(f'{order:.6g}' for order in self.orders),
        }


def labels(faults: Iterable[Fault], pair: GearPair) -> tuple[Label, ...]:
    """Return the labels of the faults whose severity is above 0."""
    return tuple(
        Label(
            fault.kind(),
            getattr(fault, 'wheel', ''),
            getattr(fault, 'tooth', None),
            fault.severity,
            fault.orders(pair),
        )
        for fault in faults
        if fault.severity > 0
    )
