"""A gear pair that carries its faults, for what takes a pair and knows no faults."""

from __future__ import annotations

import dataclasses

from gear_dynamics.model.faults.fault import Fault
from gear_dynamics.model.gear_pair import GearPair


@dataclasses.dataclass(frozen=True)
class FaultyPair(GearPair):
    """A gear pair with faults of its own: every simulation, map and study runs them.

    `dataclasses.replace` keeps the faults. Made by `faulty`.
    """

    faults: tuple[Fault, ...] = ()


def faulty(pair: GearPair, faults: tuple[Fault, ...] | list[Fault]) -> FaultyPair:
    """Return a gear pair with faults of its own.

    Parameters
    ----------
    pair : GearPair
    faults : sequence of Fault

    Raises
    ------
    ParameterError
        If there is anything but faults, or a fault does not fit the pair.

    Examples
    --------
    >>> from gear_dynamics import GearPair, faults
    >>> pair = faults.faulty(GearPair(), [faults.RootCrack('pinion', tooth=5, severity=0.4)])
    >>> pair.faults[0].depth
    0.0008
    """
    from gear_dynamics.model.faults.collection import checked_faults, fault_ports

    checked = checked_faults(faults)
    fault_ports(pair, checked)
    return FaultyPair(**pair.to_mapping(), faults=checked)  # type: ignore[arg-type]
