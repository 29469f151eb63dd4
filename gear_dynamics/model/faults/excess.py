"""Refusal of faults that together leave nothing of the backlash or of a tooth pair."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.model.faults.fault import Fault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.piecewise import Pieces
from gear_dynamics.model.ports import WHEELS, Ports, ToothDeviation
from gear_dynamics.parameters.parameter import ParameterError

LEAST_STIFFNESS = 0.02
"""Least stiffness of all tooth pairs, over the nominal one."""

ROUNDING = 1e-4
"""Of the stiffness that is taken: the polynomials of two faults are good to 1e-5 each."""

MOST_NAMED = 4
"""Faults that a message names at most."""


class FaultPorts(NamedTuple):
    """A fault and what it does to the pair."""

    fault: Fault
    ports: Ports


def refuse_excess(pair: GearPair, parts: Sequence[FaultPorts]) -> None:
    """Refuse faults that together leave no backlash or no stiffness of a tooth pair.

    Raises
    ------
    ParameterError
        In one line that names the faults, their severities, what they take, and the limit.
    """
    _refuse_closed_gap(pair, parts)
    s = np.linspace(0.0, 1.0, 201)[1:-1] * pair.derived.path_length
    healthy = 1 + _change(pair.healthy_ports, s, None)
    everywhere = healthy + sum(_change(part.ports, s, None) for part in parts)
    left = everywhere * np.prod([_left(part.ports, s) for part in parts], axis=0)
    if left.min() < LEAST_STIFFNESS:
        at = left.argmin()
        takers = [p for p in parts if (_left(p.ports, s) - 1 + _change(p.ports, s, None))[at] < 0]
        raise ParameterError(
            f'{_named(takers)}: these leave {max(left.min(), 0.0):.2g} of the stiffness of all '
            f'tooth pairs, which must be at least {LEAST_STIFFNESS}; make a severity smaller'
        )
    _refuse_soft_teeth(parts, everywhere, s)


def _refuse_closed_gap(pair: GearPair, parts: Sequence[FaultPorts]) -> None:
    taken = [_off_the_gap(part.ports) for part in parts]
    if sum(taken) >= pair.half_backlash:
        takers = [part for part, each in zip(parts, taken, strict=True) if each > 0]
        raise ParameterError(
            f'{_named(takers)}: together these take {sum(taken):.6g} m off the half backlash, '
            f'which must be less than {pair.half_backlash:g} m; make a severity smaller'
        )


def _off_the_gap(ports: Ports) -> float:
    """Return what terms may take off the half backlash [m]."""
    taken = 0.0
    for term in ports:
        if getattr(term, 'signal', '') == 'half_backlash':
            offset = getattr(term, 'value', None)
            taken += -offset if offset is not None else abs(getattr(term, 'amplitude', 0.0))
    return taken


def _refuse_soft_teeth(parts: Sequence[FaultPorts], everywhere: np.ndarray, s: np.ndarray) -> None:
    """Refuse teeth that meet and whose added compliance takes more than the stiffness there is."""
    worst = everywhere.copy()
    by_tooth: dict[tuple[str, int], np.ndarray] = {}
    for part in parts:
        for place in {_place(term) for term in part.ports if isinstance(term, ToothDeviation)}:
            if place is not None:
                by_tooth[place] = by_tooth.get(place, 0.0) + _change(part.ports, s, place)
    for wheel in WHEELS:
        changes = [change for (of, _), change in by_tooth.items() if of == wheel]
        worst += np.min([np.zeros(s.size), *changes], axis=0)
    if worst.min() < -ROUNDING:
        at = worst.argmin()
        softest = [
            min((p for p in by_tooth if p[0] == wheel), key=lambda p: by_tooth[p][at], default=None)
            for wheel in WHEELS
        ]
        places = {None, *softest}
        takers = [p for p in parts if any(_change(p.ports, s, each)[at] < 0 for each in places)]
        raise ParameterError(
            f'{_named(takers)}: where these teeth meet they take {1 - worst.min():.4g} of the '
            f'stiffness of a tooth pair, which can be 1 at most; make a severity smaller'
        )


def _place(term: ToothDeviation) -> tuple[str, int] | None:
    """Return wheel and tooth of a term; None for all teeth."""
    return None if term.wheel is None or term.tooth is None else (term.wheel, term.tooth)


def _change(ports: Ports, s: np.ndarray, place: tuple[str, int] | None) -> np.ndarray:
    """Return what terms add to the stiffness of all teeth or of one, over the nominal one."""
    found = np.zeros(s.size)
    for term in ports:
        if isinstance(term, ToothDeviation) and _place(term) == place and term.stiffness.any():
            found += Pieces(term.edges, term.stiffness).at(s)
    return found


def _left(ports: Ports, s: np.ndarray) -> np.ndarray:
    """Return what the losses of all teeth leave."""
    found = np.ones(s.size)
    for term in ports:
        if isinstance(term, ToothDeviation) and _place(term) is None:
            found[(s >= term.edges[0]) & (s <= term.edges[-1])] *= 1 - term.loss
    return found


def _named(parts: Sequence[FaultPorts]) -> str:
    """Return the names and severities of faults in a list."""
    shown = []
    for fault, _ in parts[:MOST_NAMED]:
        tooth = getattr(fault, 'tooth', None)
        where = getattr(fault, 'wheel', '') + ('' if tooth is None else f' tooth {tooth}')
        shown.append(
            f'{fault.kind()} severity is {fault.severity:g}' + (f' ({where})' if where else '')
        )
    more = len(parts) - MOST_NAMED
    return ', '.join(shown) + (f' and {more} more' if more > 0 else '')
