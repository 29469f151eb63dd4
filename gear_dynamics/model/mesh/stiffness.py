"""The stiffness of a healthy tooth pair over the path of contact, by every method."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gear_dynamics.model.mesh import iso_6336
from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.model.mesh.piecewise import Pieces, fit
from gear_dynamics.model.mesh.potential_energy import PotentialEnergy
from gear_dynamics.parameters.gear_pair import GearPairParameters
from gear_dynamics.parameters.number_lists import number_rows
from gear_dynamics.parameters.parameter import ParameterError

TOLERANCE = 1e-6
"""Greatest error of the polynomials, relative to the stiffness."""

DEVIATION_TOLERANCE = 1e-5
"""Greatest error of the changes by faults, relative to the nominal stiffness."""

LONGEST_TABLE = 200
"""Rows that a table may have: each begins a new step of the integrator."""

Law = Callable[..., np.ndarray]


class Stiffness(NamedTuple):
    """What a tooth pair adds to the stiffness of the mesh.

    Attributes
    ----------
    single : float
        Of a pair alone in contact at the pitch point, or what stands for it [N/m].
    cuts : tuple of float
        Places where it may jump or bend, with both ends of the path [m].
    at : callable
        Takes s, an (n,) array [m], and the compliance that the pair has besides [m/N]; gives [N/m].
    nominal : callable
        Takes s and gives the stiffness that the deviations of `ports.ToothDeviation` are relative
        to: `single`, or with `constant` the pair's equal share of it [N/m].
    """

    single: float
    cuts: tuple[float, ...]
    at: Law
    nominal: Law


_FIELDS = (
    'mesh_stiffness tooth_pair_stiffness stiffness_ratio stiffness_harmonics stiffness_table '
    'pinion_teeth gear_teeth module pressure_angle_deg face_width pinion_bore gear_bore '
    'youngs_modulus poissons_ratio'
).split()


def stiffness(pair: GearPairParameters) -> Stiffness:
    """Return the stiffness of a healthy tooth pair by the method that `mesh_stiffness` names.

    Raises
    ------
    ParameterError
        If the method does not cover the pair, or its harmonics or table are malformed.
    """
    return _cached(tuple(getattr(pair, name) for name in _FIELDS))


@functools.lru_cache(maxsize=64)
def _cached(values: tuple) -> Stiffness:
    pair = GearPairParameters(**dict(zip(_FIELDS, values, strict=True)))
    return _MAKERS[pair.mesh_stiffness](pair, PathOfContact.of(pair))


@functools.lru_cache(maxsize=64)
def _cached_pieces(values: tuple) -> Pieces:
    law = _cached(values)
    return fit(law.at, law.cuts, TOLERANCE)


def pieces(pair: GearPairParameters) -> Pieces:
    """Return the stiffness of a healthy tooth pair as polynomials in s [N/m], good to 1e-6."""
    return _cached_pieces(tuple(getattr(pair, name) for name in _FIELDS))


def deviation(
    pair: GearPairParameters,
    changed: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> Pieces:
    """Return a change of stiffness in the form of `ports.ToothDeviation`.

    Parameters
    ----------
    pair : GearPairParameters
    changed : callable
        Gives the changed stiffness of a tooth pair from s and the healthy one, (n,) arrays.
    """
    law = stiffness(pair)
    healthy = pieces(pair).at

    def relative(s: np.ndarray) -> np.ndarray:
        k = healthy(s)
        return (changed(s, k) - k) / law.nominal(s)

    return fit(relative, law.cuts, DEVIATION_TOLERANCE, scale=1.0)


def single_stiffnesses(pair: GearPairParameters) -> dict[str, float]:
    """Return the stiffness of a single pair at the pitch point by every method [N/m].

    0 stands where a method does not cover the pair. That of ISO 6336 is the greatest on the path.
    """
    found = {'rectangular': pair.tooth_pair_stiffness, 'iso_6336': _iso(pair)}
    pitch_point = np.array([PathOfContact.of(pair).approach])
    try:
        energy = PotentialEnergy.of(pair, body_once=True)
    except ParameterError:
        found['potential_energy'] = 0.0
    else:
        found['potential_energy'] = float(energy.single(pitch_point)[0])
    return found


def _same(single: float) -> Law:
    return lambda s: np.full(np.shape(s), single)


def _shared(path: PathOfContact, s: np.ndarray, two: float) -> np.ndarray:
    """Return 1 for a pair alone in contact, and `two` for one of two."""
    return np.where(np.isnan(path.other_pair(s)), 1.0, two)


def _stepwise(pair: GearPairParameters, path: PathOfContact, ratio: float) -> Stiffness:
    def at(s: np.ndarray, softened: np.ndarray | float = 0.0) -> np.ndarray:
        k = pair.tooth_pair_stiffness * _shared(path, s, ratio / 2)
        return k / (1 + k * softened)

    def nominal(s: np.ndarray) -> np.ndarray:
        share = 0.5 if pair.mesh_stiffness == 'constant' else 1.0
        return pair.tooth_pair_stiffness * _shared(path, s, share)

    return Stiffness(pair.tooth_pair_stiffness, path.edges, at, nominal)


def _rectangular(pair: GearPairParameters, path: PathOfContact) -> Stiffness:
    return _stepwise(pair, path, pair.stiffness_ratio)


def _constant(pair: GearPairParameters, path: PathOfContact) -> Stiffness:
    return _stepwise(pair, path, 1.0)


def _by_energy(body_once: bool) -> Callable[[GearPairParameters, PathOfContact], Stiffness]:
    def make(pair: GearPairParameters, path: PathOfContact) -> Stiffness:
        energy = PotentialEnergy.of(pair, body_once)
        single = float(energy.single(np.array([path.approach]))[0])
        return Stiffness(single, path.edges, energy.of_pair, _same(single))

    return make


def _iso(pair: GearPairParameters) -> float:
    return iso_6336.single_stiffness(
        pair.pinion_teeth,
        pair.gear_teeth,
        math.radians(pair.pressure_angle_deg),
        pair.face_width,
        pair.youngs_modulus,
    )


def _iso_6336(pair: GearPairParameters, path: PathOfContact) -> Stiffness:
    energy = PotentialEnergy.of(pair, body_once=True)
    greatest = energy.single(np.linspace(0.0, path.length, 201)).max()
    scale = _iso(pair) / float(greatest)

    def at(s: np.ndarray, softened: np.ndarray | float = 0.0) -> np.ndarray:
        return scale * energy.of_pair(s, softened * scale)

    single = scale * float(energy.single(np.array([path.approach]))[0])
    return Stiffness(single, path.edges, at, _same(single))


def _harmonic(pair: GearPairParameters, path: PathOfContact) -> Stiffness:
    rows = number_rows('stiffness_harmonics', pair.stiffness_harmonics, 2)

    def relative(s: np.ndarray) -> np.ndarray:
        turn = 2 * np.pi * np.asarray(s, float) / path.base_pitch
        waves = [a * np.cos((n + 1) * turn + phase) for n, (a, phase) in enumerate(rows)]
        return 1 + sum(waves, np.zeros(turn.shape))

    if relative(np.linspace(0.0, path.base_pitch, 1001)).min() <= 0.01:
        raise ParameterError(
            f'stiffness_harmonics is {pair.stiffness_harmonics!r}: the stiffness must stay above '
            '0.01 of its mean; make the amplitudes smaller'
        )

    def at(s: np.ndarray, softened: np.ndarray | float = 0.0) -> np.ndarray:
        k = pair.tooth_pair_stiffness * relative(s) * _shared(path, s, 0.5)
        return k / (1 + k * softened)

    single = pair.tooth_pair_stiffness
    return Stiffness(single, path.edges, at, _same(single))


def _table(pair: GearPairParameters, path: PathOfContact) -> Stiffness:
    s_rows, k_rows = _read_table(pair.stiffness_table)

    def at(s: np.ndarray, softened: np.ndarray | float = 0.0) -> np.ndarray:
        k = np.interp(s, s_rows, k_rows)
        return k / (1 + k * softened)

    inside = [float(s) for s in s_rows if 0 < s < path.length]
    cuts = tuple(sorted({0.0, *inside, path.length}))
    single = float(np.interp(path.approach, s_rows, k_rows))
    return Stiffness(single, cuts, at, _same(single))


def _read_table(file: str) -> tuple[np.ndarray, np.ndarray]:
    if not file:
        raise ParameterError(
            "stiffness_table is '': mesh_stiffness table needs a file of s [m] and stiffness [N/m]"
        )
    try:
        text = Path(file).read_text(encoding='utf-8').replace(',', ' ')
        rows = np.loadtxt(text.splitlines(), ndmin=2)
    except OSError as error:
        raise ParameterError(f'stiffness_table {file}: cannot be read: {error.strerror}') from None
    except ValueError:
        rows = np.zeros((0, 0))
    if rows.ndim != 2 or rows.shape[1:] != (2,) or not 2 <= len(rows) <= LONGEST_TABLE:
        raise ParameterError(
            f'stiffness_table {file}: must have 2 to {LONGEST_TABLE} rows of two numbers, s [m] '
            'and stiffness [N/m]'
        )
    s, k = rows.T
    if not np.isfinite(rows).all() or (np.diff(s) <= 0).any() or (k < 1e3).any():
        raise ParameterError(
            f'stiffness_table {file}: s must ascend, and the stiffness be at least 1000 N/m'
        )
    return s, k


_MAKERS: dict[str, Callable[[GearPairParameters, PathOfContact], Stiffness]] = {
    'rectangular': _rectangular,
    'constant': _constant,
    'potential_energy': _by_energy(body_once=True),
    'potential_energy_per_pair': _by_energy(body_once=False),
    'iso_6336': _iso_6336,
    'harmonic': _harmonic,
    'table': _table,
}
