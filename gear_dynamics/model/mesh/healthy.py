"""How a healthy pair departs from the nominal rectangle and sine, as ports."""

from __future__ import annotations

import numpy as np

from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.model.mesh.stiffness import pieces, stiffness
from gear_dynamics.model.ports import Harmonic, Ports, Term, ToothDeviation
from gear_dynamics.parameters.gear_pair import GearPairParameters
from gear_dynamics.parameters.number_lists import number_rows
from gear_dynamics.parameters.parameter import ParameterError

LONGEST_HARMONIC = 100
"""Greatest order of the mesh in the transmission error."""


def healthy_ports(pair: GearPairParameters) -> Ports:
    """Return stiffness over the path of contact, tip relief, and harmonics of transmission error.

    The nominal pair has the stiffness `derived.single_stiffness` throughout, or with `constant`
    its equal share of it; a rectangle of ratio 2 needs no ports.

    Raises
    ------
    ParameterError
        If a method does not cover the pair, or one of its texts is malformed.
    """
    terms: list[Term] = []
    if not _is_nominal(pair):
        found = pieces(pair)
        relative = found.coefficients / stiffness(pair).single
        relative[:, 0] -= 1
        terms.append(ToothDeviation(None, None, found.edges, stiffness=relative))
    if pair.mesh_stiffness == 'harmonic':
        # Two pairs share the stiffness, and share the damping as well.
        edges = np.array(PathOfContact.of(pair).edges)
        terms.append(ToothDeviation(None, None, edges, damping=np.array([[-0.5], [0], [-0.5]])))
    terms += _tip_relief(pair)
    terms += _transmission_error(pair)
    return Ports(terms)


def _is_nominal(pair: GearPairParameters) -> bool:
    rectangle = pair.mesh_stiffness == 'rectangular' and pair.stiffness_ratio == 2
    return rectangle or pair.mesh_stiffness == 'constant'


def _tip_relief(pair: GearPairParameters) -> list[Term]:
    """Return the flank error where a tip is in contact: the gear's first, the pinion's last."""
    if pair.tip_relief_amount == 0:
        return []
    path, length = PathOfContact.of(pair), pair.tip_relief_length
    if not 0 < length <= path.length:
        raise ParameterError(
            f'tip_relief_length is {length:g} m: it must be above 0 and at most the path of '
            f'contact, {path.length:g} m'
        )
    rising = [0.0, 1.0, 0.0] if pair.tip_relief_shape == 'linear' else [0.0, 0.0, 1.0]
    falling = [1.0, -1.0, 0.0] if pair.tip_relief_shape == 'linear' else [1.0, -2.0, 1.0]
    rows = pair.tip_relief_amount * np.array([falling, rising])
    gear = ToothDeviation(None, None, np.array([0.0, length]), error=rows[:1])
    end = np.array([path.length - length, path.length])
    return [gear, ToothDeviation(None, None, end, error=rows[1:])]


def _transmission_error(pair: GearPairParameters) -> list[Term]:
    name = 'transmission_error_harmonics'
    terms: list[Term] = []
    for order, amplitude, phase in number_rows(name, getattr(pair, name), 3):
        if not (order.is_integer() and 1 <= order <= LONGEST_HARMONIC and abs(amplitude) <= 1e-3):
            raise ParameterError(
                f'{name} has {order:g} {amplitude:g} {phase:g}: the order must be a whole number '
                f'from 1 to {LONGEST_HARMONIC}, the amplitude at most 0.001 m'
            )
        terms.append(Harmonic('transmission_error', 'mesh', order, amplitude, phase))
    return terms
