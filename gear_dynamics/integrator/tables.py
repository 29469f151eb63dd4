"""Ports as tables for the compiled kernels."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gear_dynamics.integrator.constants import FOLDED
from gear_dynamics.integrator.kernel import kernel, part_of
from gear_dynamics.integrator.layout import ERROR, GAP, SIGNAL
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.port_checks import DEGREE
from gear_dynamics.model.ports import (
    TOOTH_QUANTITIES,
    WHEELS,
    Harmonic,
    Offset,
    Ports,
    Table,
    Term,
    ToothDeviation,
)
from gear_dynamics.parameters.parameter import ParameterError

PIECES = np.dtype(
    [
        ('begin', np.float64),
        ('end', np.float64),
        ('ramp', np.int64),
        ('flawed', np.int64),
        ('loss', np.float64),
        ('coefficients', np.float64, (len(TOOTH_QUANTITIES), DEGREE + 1)),
    ]
)
"""Pieces of tooth deviations: begin and end, s in base pitches; the group of terms whose strength
they have; whether they have a flank error; share of k and c that is lost; coefficients in the order
of PAIR_STIFFNESS, ..."""

WAVES = np.dtype(
    [(name, np.int64) for name in ('signal', 'teeth', 'derivative', 'ramp')]
    + [(name, np.float64) for name in ('order', 'amplitude', 'phase')]
)
"""Sines, and constants (order 0): order per revolution of a wheel of so many teeth (1: per mesh
cycle), or per second (teeth 0)."""

CURVES = np.dtype(
    [(name, np.int64) for name in ('signal', 'timed', 'first', 'count', 'ramp', 'piece', 'lap')]
    + [('period', np.float64)]
)
"""Piecewise polynomials that repeat: the first of their pieces and how many there are, the present
piece and lap, and the period in mesh cycles or, if timed, in seconds."""

CURVE_PIECES = np.dtype(
    [('begin', np.float64), ('end', np.float64), ('coefficients', np.float64, (DEGREE + 1,))]
)

RAMPS = np.dtype([(name, np.float64) for name in ('begin', 'value', 'rate', 'target')])
"""Strengths of groups of terms: value at time begin [s since the start], rate, and last value."""


class Tables(NamedTuple):
    """The ports of one gear pair.

    Attributes
    ----------
    teeth : (z1 + z2 + 2,) array of int
        Where the pieces of all teeth (0), of pinion tooth i (1 + i) and of gear tooth i
        (1 + z1 + i) begin, and the end.
    pieces, waves, curves, curve_pieces, ramps : arrays of the dtypes of these names
    """

    teeth: np.ndarray
    pieces: np.ndarray
    waves: np.ndarray
    curves: np.ndarray
    curve_pieces: np.ndarray
    ramps: np.ndarray


_DTYPES = (np.dtype(np.int64), PIECES, WAVES, CURVES, CURVE_PIECES, RAMPS)
_KINDS = len(_DTYPES)
_HEADER = 8 * _KINDS


def packed(tables: Tables) -> np.ndarray:
    """Return tables as one array of bytes; without any terms, no bytes.

    One array costs a kernel less than six, in each call from function to function.
    """
    if not (tables.pieces.size or tables.waves.size or tables.curves.size):
        return np.zeros(0, np.uint8)
    counts = np.array([len(array) for array in tables])
    parts = [counts, *tables]
    return np.concatenate([np.ascontiguousarray(part).view(np.uint8).ravel() for part in parts])


def unpacked(ports: np.ndarray) -> Tables:
    """Return the tables in an array of bytes, as views of it."""
    if not ports.size:
        return Tables(*(np.zeros(0, dtype) for dtype in _DTYPES))
    counts, begin, views = ports[:_HEADER].view(np.int64), _HEADER, []
    for count, dtype in zip(counts, _DTYPES, strict=True):
        end = begin + int(count) * dtype.itemsize
        views.append(ports[begin:end].view(dtype))
        begin = end
    return Tables(*views)


@kernel
def unpack(ports):
    """Return the tables in an array of bytes that is not empty, as views of it."""
    counts = part_of(ports, 0, _KINDS, _INTEGER)
    a = _HEADER
    b = a + 8 * counts[0]
    c = b + _PIECE_SIZE * counts[1]
    d = c + _WAVE_SIZE * counts[2]
    e = d + _CURVE_SIZE * counts[3]
    f = e + _CURVE_PIECE_SIZE * counts[4]
    return Tables(
        part_of(ports, a, counts[0], _INTEGER),
        part_of(ports, b, counts[1], PIECES),
        part_of(ports, c, counts[2], WAVES),
        part_of(ports, d, counts[3], CURVES),
        part_of(ports, e, counts[4], CURVE_PIECES),
        part_of(ports, f, counts[5], RAMPS),
    )


_INTEGER = np.dtype(np.int64)
_PIECE_SIZE, _WAVE_SIZE, _CURVE_SIZE, _CURVE_PIECE_SIZE = (
    dtype.itemsize for dtype in _DTYPES[1:-1]
)


class Group(NamedTuple):
    """Ports whose strength goes linearly from one value to another; constant if these are equal."""

    ports: Ports
    strength: float = 1.0
    target: float = 1.0

    @property
    def constant(self) -> bool:
        """Whether the terms are there in full and stay."""
        return self.strength == self.target == 1.0


class Fade(NamedTuple):
    """Groups of ports, and when their strengths change.

    Attributes
    ----------
    groups : tuple of Group
    begin, duration : float
        Of the change [s since the start of the run].
    """

    groups: tuple[Group, ...]
    begin: float = 0.0
    duration: float = 0.0

    @classmethod
    def of(cls, ports: Ports) -> Fade:
        """Return ports that are there in full."""
        return cls((Group(ports),))

    def _strengths(self, time: float) -> list[tuple[Term, float]]:
        """Return the terms with their strengths at a time [s]."""
        done = (time - self.begin) / self.duration if self.duration > 0 else 1.0
        found = []
        for ports, strength, target in self.groups:
            now = target if done >= 1.0 else strength + done * (target - strength)
            found += [(term, now) for term in ports if now != 0.0]
        return found

    def towards(self, ports: Ports, time: float, duration: float) -> Fade:
        """Return a change to other ports that begins at a time [s] and takes a duration [s]."""
        if duration == 0:
            return Fade.of(ports)
        coming = list(ports)
        by_change: dict[tuple[float, float], list[Term]] = {(1.0, 1.0): []}
        for term, strength in self._strengths(time):
            stays = term in coming
            if stays:
                coming.remove(term)
            elif isinstance(term, ToothDeviation) and (other := _same_loss(term, coming)):
                # Losses multiply: one that fades out while the other comes in would leave more
                # than either.
                coming.remove(other)
                strength *= term.loss / other.loss
                term, stays = other, True
            by_change.setdefault((strength, 1.0 if stays else 0.0), []).append(term)
        by_change.setdefault((0.0, 1.0), []).extend(coming)
        groups = tuple(
            Group(Ports(terms), *change)
            for change, terms in by_change.items()
            if terms or change == (1.0, 1.0)
        )
        return Fade(groups, time, duration if len(groups) > 1 else 0.0)


def _same_loss(term: ToothDeviation, coming: Sequence[Term]) -> ToothDeviation | None:
    """Return the term that differs from another one by the size of its loss alone."""
    for other in coming:
        if not isinstance(other, ToothDeviation) or not term.loss or not other.loss:
            continue
        if dataclasses.replace(other, loss=term.loss) == term:
            return other
    return None


def folded_offsets(groups: Sequence[Group]) -> list[Term]:
    """Return the offsets that change a constant instead of being a signal."""
    return [term for group in groups if group.constant for term in group.ports if _is_folded(term)]


def _is_folded(term: Term) -> bool:
    return isinstance(term, Offset) and term.signal in FOLDED


def make_tables(
    pair: GearPair, groups: Sequence[Group] = (), begin: float = 0.0, duration: float = 0.0
) -> Tables:
    """Return the tables of a gear pair with groups of ports.

    Parameters
    ----------
    pair : GearPair
    groups : sequence of Group
    begin, duration : float
        When the strengths begin to change, and for how long [s].

    Raises
    ------
    ParameterError
        If a term names a tooth that the wheel does not have, or the half backlash could vanish.
    """
    pieces: list[list[np.ndarray]] = [[] for _ in range(1 + pair.pinion_teeth + pair.gear_teeth)]
    waves: list[tuple] = []
    curves: list[tuple] = []
    curve_pieces: list[tuple] = []
    ramps = np.zeros(len(groups), RAMPS)
    cycles = {'pinion': pair.pinion_teeth, 'gear': pair.gear_teeth, 'mesh': 1, 'time': 0}
    for ramp, group in enumerate(groups):
        change = group.target - group.strength
        ramps[ramp] = begin, group.strength, change / duration if change else 0.0, group.target
        for term in group.ports:
            if isinstance(term, ToothDeviation):
                pieces[_group_of_teeth(pair, term)].append(_tooth_pieces(pair, term, ramp))
            elif isinstance(term, Harmonic):
                teeth = cycles[term.argument]
                numbers = term.order, term.amplitude, term.phase
                waves.append((SIGNAL[term.signal], teeth, term.derivative, ramp, *numbers))
            elif isinstance(term, Table):
                scale = float(cycles[term.argument] or 1.0)
                knots = term.knots * scale
                first, timed = len(curve_pieces), term.argument == 'time'
                count, period = len(knots) - 1, knots[-1] - knots[0]
                curves.append((SIGNAL[term.signal], timed, first, count, ramp, 0, 0, period))
                curve_pieces += zip(knots[:-1], knots[1:], term.coefficients, strict=True)
            elif isinstance(term, Offset) and not (group.constant and _is_folded(term)):
                waves.append((SIGNAL[term.signal], 1, 0, ramp, 0.0, term.value, math.pi / 2))
    _refuse_closed_gap(pair, groups)
    rows = [row for of_tooth in pieces for row in of_tooth]
    starts = np.cumsum([0, *(sum(map(len, of_tooth)) for of_tooth in pieces)])
    return Tables(
        teeth=starts.astype(np.int64),
        pieces=np.concatenate(rows) if rows else np.zeros(0, PIECES),
        waves=np.array(waves, WAVES),
        curves=np.array(curves, CURVES),
        curve_pieces=np.array(curve_pieces, CURVE_PIECES),
        ramps=ramps,
    )


def _group_of_teeth(pair: GearPair, term: ToothDeviation) -> int:
    if term.wheel is None or term.tooth is None:
        return 0
    teeth = pair.pinion_teeth if term.wheel == 'pinion' else pair.gear_teeth
    if term.tooth >= teeth:
        raise ParameterError(f'tooth is {term.tooth}: the {term.wheel} has teeth 0 to {teeth - 1}')
    return 1 + term.tooth + (pair.pinion_teeth if term.wheel == WHEELS[1] else 0)


def _tooth_pieces(pair: GearPair, term: ToothDeviation, ramp: int) -> np.ndarray:
    rows = np.zeros(len(term.edges) - 1, PIECES)
    places = term.edges / pair.derived.base_pitch
    rows['begin'], rows['end'], rows['ramp'] = places[:-1], places[1:], ramp
    for i, name in enumerate(TOOTH_QUANTITIES):
        rows['coefficients'][:, i] = getattr(term, name)
    rows['flawed'], rows['loss'] = term.error.any(), term.loss
    return rows


def has_friction(pair: GearPair, groups: Sequence[Group]) -> bool:
    """Return whether there is friction, of the pair or of ports."""
    terms = [term for group in groups for term in group.ports]
    return (
        pair.friction_coefficient > 0
        or any(isinstance(t, ToothDeviation) and t.friction.any() for t in terms)
        or any(getattr(t, 'signal', '') == 'friction' for t in terms)
    )


def _refuse_closed_gap(pair: GearPair, groups: Sequence[Group]) -> None:
    """Refuse signals that could close the backlash."""
    least = pair.half_backlash
    for group in groups:
        most = max(abs(group.strength), abs(group.target))
        for term in group.ports:
            if getattr(term, 'signal', '') != 'half_backlash':
                continue
            if isinstance(term, Harmonic):
                least -= most * abs(term.amplitude)
            elif isinstance(term, Table):
                least -= most * np.abs(term.coefficients).sum(axis=1).max()
            elif isinstance(term, Offset):
                least += min(term.value * group.strength, term.value * group.target)
    if least <= 0:
        raise ParameterError(
            f'half_backlash is {pair.half_backlash:g} m: what is added to it could bring it to '
            f'{least:g} m; it must stay positive'
        )


def place_curves(tables: Tables, cycles: float, time: float) -> None:
    """Set the present piece and lap of each curve, at a mesh phase [cycles] and time [s]."""
    for curve in tables.curves:
        rows = tables.curve_pieces[curve['first'] : curve['first'] + curve['count']]
        since = (time if curve['timed'] else cycles) - rows[0]['begin']
        lap = math.floor(since / curve['period'])
        at = since - lap * curve['period'] + rows[0]['begin']
        piece = int(np.searchsorted(rows['begin'], at, side='right')) - 1
        curve['lap'], curve['piece'] = lap, min(max(piece, 0), len(rows) - 1)


def jumps_possible(tables: Tables) -> bool:
    """Return whether what delta_i is held against may jump where a mesh event ends a step."""
    moved = np.isin(tables.curves['signal'], [ERROR, GAP])
    return bool(tables.pieces['flawed'].any() or moved.any())
