"""The stroboscopic map: the state of a periodically driven system once a cycle of its drive."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

import numpy as np

from gear_dynamics.dynamics.cycles import Cycles, run_cycles
from gear_dynamics.dynamics.initial import error_at_phase_0
from gear_dynamics.dynamics.tangent import free_coordinates
from gear_dynamics.integrator.layout import STATES
from gear_dynamics.integrator.variation import VARIED
from gear_dynamics.model.faults import SpeedAndLoad
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Table, Term
from gear_dynamics.parameters.parameter import ParameterError

FREE = [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]
"""The coordinates and velocities of the reduced form among the integrator's states."""

SAMPLES = 512
"""Samples of delta in a cycle, from which the contact states of an orbit are told."""

LONGEST = 10_000
"""Mesh cycles in the longest cycle of a map."""

IN_DRIVE, IN_GAP, IN_BACK = 'D', 'G', 'B'
"""Contact on the drive flank, none, on the back flank."""


class StroboscopicMap(Protocol):
    """What the algorithms of this room ask of a system.

    Attributes
    ----------
    dimension : int
    cycle : float
        Length of a cycle, in the time that exponents are per.
    """

    @property
    def dimension(self) -> int:
        """Numbers in a state."""

    @property
    def cycle(self) -> float:
        """Length of a cycle."""

    def iterate(self, states: np.ndarray) -> np.ndarray:
        """Return the states, (n, dimension), one cycle later."""

    def tangent(self, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states one cycle later and the Jacobians there, (n, dimension, dimension)."""


class OrbitContact(NamedTuple):
    """The contact of an orbit.

    Attributes
    ----------
    sequence : str
        Contact states in their order over the period, such as `DG`: drive flank (D), gap (G), back
        flank (B).
    clearance : float
        Least distance of an extremum of delta from an edge of the gap, over b: 0 at grazing.
        Positive where the extremum is beyond the edge, negative where it is inside of the gap.
    rms, least, greatest : float
        Of delta over b; the RMS is about the mean.
    """

    sequence: str
    clearance: float
    rms: float
    least: float
    greatest: float


class GearMap:
    """The stroboscopic map of the reduced form at mesh phase 0.

    Its cycle is a mesh cycle; with faults of a tooth or of a shaft, as many mesh cycles as it takes
    until the pair is the same again. It begins as a run does, with tooth 0 of both wheels.

    A state is x1, y1, x2, y2, psi over b and their velocities over b wn; on rigid supports only psi
    and its velocity.

    Parameters
    ----------
    pair : GearPair
    speed : float
        Of the pinion [rad/s], positive.
    load_torque : float
        On the gear [N m].
    rtol, atol : float
        Tolerances of the integrator.

    Attributes
    ----------
    cycles : int
        Mesh cycles in a cycle of the map.

    Raises
    ------
    ParameterError
        If the pair has a fault that does not repeat within LONGEST mesh cycles.
    """

    def __init__(
        self,
        pair: GearPair,
        speed: float,
        load_torque: float,
        *,
        rtol: float = 1e-12,
        atol: float = 1e-15,
    ) -> None:
        self.pair, self.speed, self.load_torque = pair, speed, load_torque
        self.cycles = _period(pair, SpeedAndLoad(speed, load_torque))
        self._rtol, self._atol = rtol, atol
        self._free = free_coordinates(pair)
        scale = pair.half_backlash * np.repeat([1.0, pair.derived.wn], VARIED // 2)
        self._scale, self._columns = scale[self._free], [FREE[i] for i in self._free]

    @property
    def dimension(self) -> int:
        """Numbers in a state."""
        return len(self._free)

    @property
    def cycle(self) -> float:
        """Length of a cycle of the map in tau = wn t."""
        mesh_cycle = 2 * np.pi * self.pair.derived.wn / (self.pair.pinion_teeth * self.speed)
        return float(self.cycles * mesh_cycle)

    def scaled(self, states: np.ndarray) -> np.ndarray:
        """Return the states of `run_cycles`, (n, STATES), as states of this map."""
        return states[..., self._columns] / self._scale

    def unscaled(self, states: np.ndarray) -> np.ndarray:
        """Return states of this map as `run_cycles` takes them."""
        full = np.zeros((*states.shape[:-1], STATES))
        full[..., self._columns] = states * self._scale
        return full

    def iterate(self, states: np.ndarray) -> np.ndarray:
        """Return the states, (n, dimension), one cycle later."""
        return self.scaled(self._run(states).states)

    def tangent(self, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states one cycle later and the Jacobians there, (n, dimension, dimension)."""
        unit = np.repeat(np.eye(VARIED)[np.newaxis, self._free], len(states), axis=0)
        run = self._run(states, vectors=unit, orthogonal=False)
        return self.scaled(run.states), run.vectors[..., self._free].swapaxes(1, 2)

    def section(self, states: np.ndarray) -> np.ndarray:
        """Return delta / b and delta_dot / (b wn) of states, (..., 2)."""
        b, wn = self.pair.half_backlash, self.pair.derived.wn
        error, rate = error_at_phase_0(self.pair, self.speed)
        full = np.zeros((*states.shape[:-1], VARIED))
        full[..., self._free] = states
        delta = full[..., 3] - full[..., 1] + full[..., 4] - error / b
        slope = full[..., 8] - full[..., 6] + full[..., 9] - rate / (b * wn)
        return np.stack([delta, slope], axis=-1)

    def contact(self, points: np.ndarray) -> OrbitContact:
        """Return the contact of the periodic orbit through `points`, (period, dimension)."""
        samples = self._run(points, samples_per_cycle=SAMPLES).samples.ravel()
        b = self.pair.half_backlash
        delta = samples['delta'] / b
        step = self.cycle / self.cycles / self.pair.derived.wn / SAMPLES
        slope = samples['delta_dot'] / b * step
        extrema = _extrema(delta, slope)
        return OrbitContact(
            _sequence(delta, extrema),
            _clearance(extrema),
            float(delta.std()),
            float(extrema.min()),
            float(extrema.max()),
        )

    def _run(self, states: np.ndarray, **options: Any) -> Cycles:
        n = len(states)
        return run_cycles(
            [self.pair] * n,
            self.speed,
            self.load_torque,
            self.cycles,
            states=self.unscaled(states),
            rtol=self._rtol,
            atol=self._atol,
            **options,
        )


def _period(pair: GearPair, commanded: SpeedAndLoad) -> int:
    """Return after how many mesh cycles a pair with its faults is the same again."""
    period = 1
    for fault in getattr(pair, 'faults', ()):
        for term in fault.ports(pair, commanded):
            cycles = _term_period(term, pair)
            period = math.lcm(period, cycles) if cycles else 0
            if not 0 < period <= LONGEST:
                raise ParameterError(
                    f'{fault.kind()} severity is {fault.severity:g}: it must be 0, since the pair '
                    f'would not be the same again within {LONGEST} mesh cycles'
                )
    return period


def _term_period(term: Term, pair: GearPair) -> int:
    """Return after how many mesh cycles a term of a fault is the same again; 0 for never."""
    teeth = {'pinion': pair.pinion_teeth, 'gear': pair.gear_teeth, 'mesh': 1}
    if isinstance(term, (Harmonic, Table)):
        if term.argument not in teeth:
            return 0
        if isinstance(term, Harmonic):
            per_turn = Fraction(term.order)
        else:
            per_turn = 1 / Fraction(float(term.knots[-1] - term.knots[0]))
        per_cycle = per_turn.limit_denominator(LONGEST) / teeth[term.argument]
        near = math.isclose(per_cycle, per_turn / teeth[term.argument], rel_tol=1e-12)
        return per_cycle.denominator if near else 0
    tooth, wheel = (getattr(term, name, None) for name in ('tooth', 'wheel'))
    return 1 if tooth is None or wheel is None else teeth[wheel]


def _extrema(delta: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Return the extrema of a periodic signal, from cubic pieces through values and slopes.

    slope : (n,) array
        Per sample.
    """
    following, next_slope = np.roll(delta, -1), np.roll(slope, -1)
    turns = np.flatnonzero(slope * next_slope < 0)
    if not turns.size:
        return np.array([delta.min(), delta.max()])
    a, b, u, v = (each[turns] for each in (delta, following, slope, next_slope))
    # The cubic a + u s + q s^2 + r s^3 has one turn where its slope changes sign.
    q, r = 3 * (b - a) - 2 * u - v, 2 * (a - b) + u + v
    root = np.sqrt(np.maximum(q * q - 3 * r * u, 0.0))
    # Both forms of the root of 3 r s^2 + 2 q s + u; the one within the step counts.
    with np.errstate(divide='ignore', invalid='ignore'):
        candidates = np.stack([-u / (q + np.where(q >= 0, root, -root)),
                               -(q + np.where(q >= 0, root, -root)) / (3 * r)])  # fmt: skip
    inside = (candidates >= 0) & (candidates <= 1)
    s = np.where(inside[0], candidates[0], np.where(inside[1], candidates[1], u / (u - v)))
    return a + s * (u + s * (q + s * r))


def _sequence(delta: np.ndarray, extrema: np.ndarray) -> str:
    """Return the contact states in their order, starting where the cyclic word is least.

    An excursion between two samples shows in the extrema alone; it counts as one to the gap.
    """
    state = np.where(delta > 1, 0, np.where(delta < -1, 2, 1))
    kept = state[np.flatnonzero(np.diff(state, prepend=state[-1]))]
    letters = [(IN_DRIVE, IN_GAP, IN_BACK)[each] for each in kept]
    if not letters:
        word = (IN_DRIVE, IN_GAP, IN_BACK)[state[0]]
        left = np.any(extrema < 1) if state[0] == 0 else np.any(extrema > -1) and state[0] == 2
        return word + IN_GAP if left else word
    words = [''.join(letters[i:] + letters[:i]) for i in range(len(letters))]
    return min(words)


def _clearance(extrema: np.ndarray) -> float:
    away = np.concatenate([extrema - 1, -1 - extrema])
    return float(away[np.abs(away).argmin()])
