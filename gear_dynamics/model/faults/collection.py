"""Any number of faults: checked, added up, and read from a file."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from typing import Any

from gear_dynamics.model.faults.excess import FaultPorts, refuse_excess
from gear_dynamics.model.faults.fault import Fault, SpeedAndLoad
from gear_dynamics.model.faults.support_wear import SupportWear
from gear_dynamics.model.friction import friction_ports
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import HEALTHY, Ports
from gear_dynamics.parameters.parameter import ParameterError, refuse_unknown_name


def checked_faults(faults: Any) -> tuple[Fault, ...]:
    """Return what must be faults.

    Raises
    ------
    ParameterError
        If there is anything else.
    """
    given = (faults,) if isinstance(faults, Fault) else faults
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise ParameterError(f'faults is {faults!r}: it must be a list of faults')
    listed = tuple(given)
    for each in listed:
        if not isinstance(each, Fault):
            raise ParameterError(
                f"faults has {each!r}: it must be a fault, such as gd.faults.RootCrack('pinion')"
            )
    return listed


def fault_ports(
    pair: GearPair, faults: Iterable[Fault], commanded: SpeedAndLoad | None = None
) -> Ports:
    """Return what faults do to a gear pair together.

    Parameters
    ----------
    pair : GearPair
    faults : iterable of Fault
    commanded : SpeedAndLoad, optional
        The commanded operating point, for the faults that depend on it.

    Raises
    ------
    ParameterError
        If a fault does not fit the pair, or the faults together leave no backlash or no
        stiffness of a tooth pair.
    """
    support = {'pinion': 1.0, 'gear': 1.0}
    parts = []
    for fault in faults:
        ports = _ports_of(fault, pair, commanded or SpeedAndLoad())
        if isinstance(fault, SupportWear):
            # A support that is worn twice loses a share of what is left.
            ports = ports.scaled(support[fault.wheel])
            support[fault.wheel] *= 1 - fault.share
        if ports != HEALTHY:
            parts.append(FaultPorts(fault, ports))
    if parts:
        refuse_excess(pair, parts)
    return sum((part.ports for part in parts), HEALTHY)


def machine_ports(
    pair: GearPair, faults: Iterable[Fault] = (), commanded: SpeedAndLoad | None = None
) -> Ports:
    """Return all departures of a machine from the nominal pair: its own, friction and faults.

    Parameters and errors are those of `fault_ports`; friction follows the operating point too. The
    faults of a `FaultyPair` come first.
    """
    commanded = commanded or SpeedAndLoad()
    own = pair.healthy_ports + friction_ports(pair, *commanded)
    given = (*getattr(pair, 'faults', ()), *faults)
    return own + fault_ports(pair, given, commanded)


@functools.lru_cache(maxsize=256)
def _ports_of(fault: Fault, pair: GearPair, commanded: SpeedAndLoad) -> Ports:
    return fault.ports(pair, commanded)


def fault_of(values: Mapping[str, Any]) -> Fault:
    """Return the fault that a mapping describes: `fault` has its kind, the rest are its fields.

    Raises
    ------
    ParameterError
        If the kind or a field is unknown, or a value is not allowed.
    """
    from gear_dynamics.model.faults import KINDS

    given = {str(name): value for name, value in values.items()}
    kind = given.pop('fault', None)
    if not isinstance(kind, str):
        raise ParameterError(f'fault is {kind!r}: it must name a fault, such as root_crack')
    refuse_unknown_name(kind, KINDS)
    for name in given:
        refuse_unknown_name(name, [about.name for about in KINDS[kind].parameters()])
    return KINDS[kind](**given)
