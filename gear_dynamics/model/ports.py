"""The ports of the model: how a machine may depart from the healthy one, as plain data.

A fault is a `Ports`, a set of terms. The equations of docs/model.md know nothing of faults:

- `ToothDeviation`: stiffness, damping, flank error and friction of tooth pairs along the path of
  contact, of all pairs or of those of one tooth;
- `Harmonic`: a sine of an angle or of time, added to a signal of the model;
- `Table`: a piecewise polynomial of an angle or of time, added to a signal of the model;
- `Offset`: a constant, added to a signal of the model.

All angles are those of the rigid rotation: Theta1 of the pinion, Theta2 of the gear. The small
rotations th are neglected in them. All ends of polynomial pieces are events of the integrator, so
that no step crosses one.

A change of ports while a simulation runs is ramped: the terms that leave fade out and those that
come fade in, linearly in time. A term that is in both sets does not change.
"""

from __future__ import annotations

import abc
import dataclasses
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from gear_dynamics.model.port_checks import finite, increasing, pieces
from gear_dynamics.parameters.parameter import ParameterError

WHEELS = ('pinion', 'gear')

ARGUMENTS = ('pinion', 'gear', 'mesh', 'time')
"""What a signal is a function of: revolutions of a shaft, mesh cycles, or seconds of the run."""

SIGNALS = {
    'transmission_error': 'm',
    'half_backlash': 'm',
    'friction': '1',
    'pinion_rest_x': 'm',
    'pinion_rest_y': 'm',
    'gear_rest_x': 'm',
    'gear_rest_y': 'm',
    'pinion_force_x': 'N',
    'pinion_force_y': 'N',
    'gear_force_x': 'N',
    'gear_force_y': 'N',
    'drive_torque': 'N m',
    'load_torque': 'N m',
    'pinion_support_stiffness': 'N/m',
    'gear_support_stiffness': 'N/m',
    'pinion_support_damping': 'N s/m',
    'gear_support_damping': 'N s/m',
}
"""The signals of the model that terms may add to, with their units.

transmission_error: e; half_backlash: b; friction: mu of all tooth pairs. rest: the rest point of a
support, which pushes the body by k r + c r'. force: on the body. drive_torque: added to T1, in the
direction of rotation; load_torque: added to T2, against it. support_stiffness, support_damping: of
the x and the y direction alike.
"""

TOOTH_QUANTITIES = ('stiffness', 'damping', 'error', 'friction')


class Term(abc.ABC):
    """A term of `Ports`: equal to another one if every field is."""

    def _key(self) -> tuple[Any, ...]:
        values = (getattr(self, field.name) for field in dataclasses.fields(self))  # type: ignore[arg-type]
        return type(self), *(
            (v.shape, v.tobytes()) if isinstance(v, np.ndarray) else v for v in values
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Term) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    @property
    @abc.abstractmethod
    def is_zero(self) -> bool:
        """Whether the term adds nothing."""

    @abc.abstractmethod
    def scaled(self, factor: float) -> Term:
        """Return the term times a factor."""


@dataclasses.dataclass(frozen=True, eq=False)
class ToothDeviation(Term):
    """Departure of tooth pairs from the nominal pair, as polynomials along the path of contact.

    With the sums and products over all terms that hold for a pair i at s, the pair has

        k_i = k (1 + sum stiffness) prod(1 - loss)    e_i = sum error
        c_i = c (1 + sum damping) prod(1 - loss)      mu_i = mu + sum friction

    Parameters
    ----------
    wheel : 'pinion', 'gear' or None
        None for all pairs, such as for a stiffness that varies over s.
    tooth : int or None
        Tooth of that wheel, 0 to z - 1; None for all its teeth.
    edges : (n + 1,) array_like
        Ends of the n pieces, s [m], increasing. Outside of them the term adds nothing.
    stiffness, damping, error, friction : (n, m) array_like
        Coefficients of each piece, m <= DEGREE + 1, the lowest first, of the place in the piece,
        x = (s - edges[j]) / (edges[j + 1] - edges[j]) from 0 to 1. stiffness and damping are
        relative to the nominal pair, error is in m, friction is added to mu. Left out: 0.
    loss : float
        Share of stiffness and damping that is lost, 0 to 1, as where part of a face is missing.

    Raises
    ------
    ParameterError
        If a value has the wrong shape or range, or names a tooth that cannot be.
    """

    wheel: str | None
    tooth: int | None
    edges: np.ndarray
    stiffness: np.ndarray = 0.0  # type: ignore[assignment]
    damping: np.ndarray = 0.0  # type: ignore[assignment]
    error: np.ndarray = 0.0  # type: ignore[assignment]
    friction: np.ndarray = 0.0  # type: ignore[assignment]
    loss: float = 0.0

    def __post_init__(self) -> None:
        if self.wheel not in (*WHEELS, None):
            raise ParameterError(f'wheel is {self.wheel!r}: it must be pinion, gear or None')
        if self.tooth is not None and (self.wheel is None or int(self.tooth) < 0):
            raise ParameterError(
                f'tooth is {self.tooth!r} of wheel {self.wheel!r}: name a tooth of a wheel, from 0'
            )
        _set(self, 'edges', increasing('edges', self.edges))
        for name in TOOTH_QUANTITIES:
            _set(self, name, pieces(name, getattr(self, name), len(self.edges) - 1))
        _set(self, 'loss', finite('loss', self.loss))
        if not 0 <= self.loss <= 1:
            raise ParameterError(f'loss is {self.loss:g}: it must be from 0 to 1')

    @property
    def is_zero(self) -> bool:
        """Whether the term adds nothing."""
        return not (self.loss or any(getattr(self, name).any() for name in TOOTH_QUANTITIES))

    def scaled(self, factor: float) -> ToothDeviation:
        """Return the term times a factor."""
        return dataclasses.replace(
            self, **{name: factor * getattr(self, name) for name in (*TOOTH_QUANTITIES, 'loss')}
        )


@dataclasses.dataclass(frozen=True, eq=False)
class Harmonic(Term):
    """A sine: amplitude sin(2 pi order a + phase), of an angle or of time a.

    Parameters
    ----------
    signal : str
        One of `SIGNALS`.
    argument : str
        One of `ARGUMENTS`: a is in revolutions, mesh cycles or seconds.
    order : float
        Per revolution, mesh cycle or second; it need not be an integer.
    amplitude : float
        In the unit of the signal, times s^derivative.
    phase : float
        [rad].
    derivative : int
        0, 1 or 2: the term is this derivative of the sine in time. An unbalance is the second one:
        the force then grows with the square of the speed.

    Raises
    ------
    ParameterError
        If the signal or the argument is unknown, or a number is not finite.
    """

    signal: str
    argument: str
    order: float
    amplitude: float
    phase: float = 0.0
    derivative: int = 0

    def __post_init__(self) -> None:
        _check_names(self.signal, self.argument)
        for name in ('order', 'amplitude', 'phase'):
            _set(self, name, finite(name, getattr(self, name)))
        if self.derivative not in (0, 1, 2):
            raise ParameterError(f'derivative is {self.derivative!r}: it must be 0, 1 or 2')

    @property
    def is_zero(self) -> bool:
        """Whether the term adds nothing."""
        return self.amplitude == 0

    def scaled(self, factor: float) -> Harmonic:
        """Return the term times a factor."""
        return dataclasses.replace(self, amplitude=factor * self.amplitude)


@dataclasses.dataclass(frozen=True, eq=False)
class Table(Term):
    """A piecewise polynomial of an angle or of time that repeats: pulses, or noise from a seed.

    Pulses are pieces with zero pieces between them. A rolling-element bearing's defect is a table
    of pulses of its support's rest point by the shaft's angle; slip is in the knots.

    Parameters
    ----------
    signal, argument : str
        As of `Harmonic`.
    knots : (n + 1,) array_like
        Ends of the n pieces, in revolutions, mesh cycles or seconds since the start of the run,
        increasing. The table repeats after knots[n] - knots[0], to both sides.
    coefficients : (n, m) array_like
        Of each piece, m <= DEGREE + 1, the lowest first, of the place x in the piece from 0 to 1,
        in the unit of the signal. Where the signal is a rest point, the half backlash or the
        transmission error, its value should be continuous from piece to piece: its rate acts on
        dampers.

    Raises
    ------
    ParameterError
        If a name is unknown, or a value has the wrong shape or is not finite.
    """

    signal: str
    argument: str
    knots: np.ndarray
    coefficients: np.ndarray

    def __post_init__(self) -> None:
        _check_names(self.signal, self.argument)
        _set(self, 'knots', increasing('knots', self.knots))
        n = len(self.knots) - 1
        _set(self, 'coefficients', pieces('coefficients', self.coefficients, n))

    @property
    def is_zero(self) -> bool:
        """Whether the term adds nothing."""
        return not self.coefficients.any()

    def scaled(self, factor: float) -> Table:
        """Return the term times a factor."""
        return dataclasses.replace(self, coefficients=factor * self.coefficients)

    @classmethod
    def of_noise(
        cls, signal: str, argument: str, rms: float, spacing: float, count: int, seed: int
    ) -> Table:
        """Return seeded Gaussian noise: independent values `spacing` apart, joined by cubics.

        Parameters
        ----------
        signal, argument : str
        rms : float
            Of the values at the knots, in the unit of the signal.
        spacing : float
            Distance of knots, in the unit of the argument: the noise goes up to 1 / (2 spacing).
        count : int
            Number of knots after which the noise repeats.
        seed : int
        """
        values = rms * np.random.default_rng(seed).standard_normal(count)
        return cls(signal, argument, spacing * np.arange(count + 1), periodic_cubics(values))


@dataclasses.dataclass(frozen=True, eq=False)
class Offset(Term):
    """A constant that is added to a signal, such as a change of friction or of a support.

    Parameters
    ----------
    signal : str
        One of `SIGNALS`.
    value : float
        In the unit of the signal.

    Raises
    ------
    ParameterError
        If the signal is unknown, or the value is not finite.
    """

    signal: str
    value: float

    def __post_init__(self) -> None:
        _check_names(self.signal, 'time')
        _set(self, 'value', finite('value', self.value))

    @property
    def is_zero(self) -> bool:
        """Whether the term adds nothing."""
        return self.value == 0

    def scaled(self, factor: float) -> Offset:
        """Return the term times a factor."""
        return dataclasses.replace(self, value=factor * self.value)


class Ports:
    """A set of terms that add up; without any, the healthy machine.

    Terms that add nothing are left out, so that a fault of severity 0 leaves the machine healthy to
    the last bit. `Ports` can be added, compared, and iterated over.

    Parameters
    ----------
    terms : iterable of Term, optional

    Raises
    ------
    ParameterError
        If something else is among the terms.
    """

    def __init__(self, terms: Iterable[Term] = ()) -> None:
        given = tuple(terms)
        for term in given:
            if not isinstance(term, Term):
                raise ParameterError(f'{term!r} is no term of Ports')
        self.terms = tuple(term for term in given if not term.is_zero)

    def __add__(self, other: Ports) -> Ports:
        return Ports(self.terms + other.terms)

    def __iter__(self) -> Iterator[Term]:
        return iter(self.terms)

    def __len__(self) -> int:
        return len(self.terms)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Ports) and self.terms == other.terms

    def __hash__(self) -> int:
        return hash(self.terms)

    def __repr__(self) -> str:
        return f'Ports({list(self.terms)!r})'

    def scaled(self, factor: float) -> Ports:
        """Return the ports with every term times a factor."""
        return Ports(term.scaled(factor) for term in self.terms)


HEALTHY = Ports()
"""The ports of a healthy machine."""


def checked_ports(ports: Any) -> Ports:
    """Return what must be ports.

    Raises
    ------
    ParameterError
        If it is anything else.
    """
    if not isinstance(ports, Ports):
        raise ParameterError(f'ports is {ports!r}: it must be Ports')
    return ports


def periodic_cubics(values: np.ndarray) -> np.ndarray:
    """Return cubics that join equally spaced values and repeat, (n, 4), for `Table`.

    The slope at a value is half the difference of its neighbours (Catmull and Rom, 1974).
    """
    here, after = np.asarray(values, float), np.roll(values, -1)
    slope = (after - np.roll(here, 1)) / 2
    slope_after = np.roll(slope, -1)
    rise = after - here
    return np.stack(
        [here, slope, 3 * rise - 2 * slope - slope_after, slope + slope_after - 2 * rise], axis=1
    )


def smooth_pulse(height: float) -> np.ndarray:
    """Return the coefficients of one piece, height (4 x (1 - x))^3: smooth at both ends.

    Value, slope and curvature are zero at the ends of the piece.
    """
    return 64.0 * height * np.array([0.0, 0.0, 0.0, 1.0, -3.0, 3.0, -1.0])


def _set(term: Term, name: str, value: Any) -> None:
    object.__setattr__(term, name, value)


def _check_names(signal: str, argument: str) -> None:
    if signal not in SIGNALS:
        raise ParameterError(f'signal is {signal!r}: it must be one of {", ".join(SIGNALS)}')
    if argument not in ARGUMENTS:
        raise ParameterError(f'argument is {argument!r}: it must be one of {", ".join(ARGUMENTS)}')
