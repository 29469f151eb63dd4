"""Any number of faults: checked, added up, and read from a file."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from gear_dynamics.model.faults.fault import Fault, Operation
from gear_dynamics.model.friction import friction_ports
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.piecewise import Pieces
from gear_dynamics.model.ports import HEALTHY, Ports, ToothDeviation
from gear_dynamics.parameters.parameter import ParameterError, refuse_unknown_name

LEAST_STIFFNESS = 0.02
"""Least stiffness of all tooth pairs, over the nominal one."""


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
    pair: GearPair, faults: Iterable[Fault], operation: Operation | None = None
) -> Ports:
    """Return what faults do to a gear pair together.

    Parameters
    ----------
    pair : GearPair
    faults : iterable of Fault
    operation : Operation, optional
        The commanded operating point, for the faults that depend on it.

    Raises
    ------
    ParameterError
        If a fault does not fit the pair, or the faults together leave no backlash, no support or
        no stiffness of a tooth pair.
    """
    total = HEALTHY
    for fault in faults:
        total = total + _ports_of(fault, pair, operation or Operation())
    if total != HEALTHY:
        _refuse_excess(pair, total)
        _refuse_negative_stiffness(pair, pair.healthy_ports + total)
    return total


def machine_ports(
    pair: GearPair, faults: Iterable[Fault] = (), operation: Operation | None = None
) -> Ports:
    """Return all departures of a machine from the nominal pair: its own, friction and faults.

    Parameters and errors are those of `fault_ports`; friction follows the operating point too. The
    faults of a `FaultyPair` come first.
    """
    operation = operation or Operation()
    own = pair.healthy_ports + friction_ports(pair, *operation)
    given = (*getattr(pair, 'faults', ()), *faults)
    return own + fault_ports(pair, given, operation)


@functools.lru_cache(maxsize=256)
def _ports_of(fault: Fault, pair: GearPair, operation: Operation) -> Ports:
    return fault.ports(pair, operation)


def _refuse_excess(pair: GearPair, ports: Ports) -> None:
    """Refuse sums of terms that leave nothing of the backlash, of a support, or of the friction."""
    for signal, present, what in (
        ('half_backlash', pair.half_backlash, 'half backlash [m]'),
        ('pinion_support_stiffness', pair.pinion_support_stiffness, 'pinion support [N/m]'),
        ('gear_support_stiffness', pair.gear_support_stiffness, 'gear support [N/m]'),
    ):
        taken = 0.0
        for term in ports:
            if getattr(term, 'signal', '') == signal:
                offset = getattr(term, 'value', None)
                taken += -offset if offset is not None else abs(getattr(term, 'amplitude', 0.0))
        if taken >= present:
            raise ParameterError(
                f'the faults together take {taken:g} off the {what}, which is {present:g}: make '
                'their severities smaller'
            )


def _refuse_negative_stiffness(pair: GearPair, ports: Ports) -> None:
    """Refuse tooth deviations that together take more than the whole stiffness of a tooth pair."""
    s = np.linspace(0.0, 1.0, 201)[1:-1] * pair.derived.path_length
    everywhere, by_tooth = np.ones(s.size), {'pinion': {}, 'gear': {}}  # type: ignore[var-annotated]
    for term in ports:
        if isinstance(term, ToothDeviation) and term.stiffness.any():
            change = Pieces(term.edges, term.stiffness).at(s)
            if term.tooth is None or term.wheel is None:
                everywhere += change
            else:
                teeth = by_tooth[term.wheel]
                teeth[term.tooth] = teeth.get(term.tooth, 0.0) + change
    left = max(round(float(everywhere.min()), 6), 0.0)
    if left < LEAST_STIFFNESS:
        raise ParameterError(
            f'the faults of all teeth leave {left:g} of the stiffness of a '
            f'tooth pair: it must be at least {LEAST_STIFFNESS}; make their severities smaller'
        )
    worst = everywhere.copy()
    for teeth in by_tooth.values():
        if teeth:
            worst += np.minimum(np.min(list(teeth.values()), axis=0), 0.0)
    if worst.min() < -1e-4:
        raise ParameterError(
            f'the faults of teeth that meet take {1 - worst.min():.3g} of the stiffness of a '
            'tooth pair: it can be 1 at most; make their severities smaller'
        )


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
