"""The gear pair: its parameters, checked, and what follows from them."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gear_dynamics.model.derived import Derived, derive
from gear_dynamics.model.mesh.healthy import healthy_ports
from gear_dynamics.model.ports import Ports
from gear_dynamics.parameters.gear_pair import GearPairParameters
from gear_dynamics.parameters.number_lists import number_rows
from gear_dynamics.parameters.parameter import ParameterError


@dataclasses.dataclass(frozen=True)
class GearPair(GearPairParameters):
    """A spur gear pair on elastic supports; values are SI except where the name says otherwise.

    Frozen: change a value with `dataclasses.replace(pair, friction_coefficient=0.0)`.

    Raises
    ------
    ParameterError
        If a value is out of its range, or the geometry has no continuous, undisturbed contact.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        self.derived  # noqa: B018  (geometry without continuous contact is refused here)
        self.healthy_ports  # noqa: B018  (and so are malformed texts)

    @functools.cached_property
    def derived(self) -> Derived:
        """Geometry, masses, damping and scales that follow from the parameters."""
        return derive(self)

    @functools.cached_property
    def healthy_ports(self) -> Ports:
        """How the healthy pair departs from the nominal rectangle and sine."""
        return healthy_ports(self)

    # The model knows no YAML: what does is loaded only by those who ask for it.

    @classmethod
    def from_yaml(cls, path: str | Path, node: str = '/gear_sim') -> GearPair:
        """Read the gear pair that a node would have with this parameter file.

        Parameters
        ----------
        path : str or Path
            ROS parameter file; names that it does not give keep their defaults.
        node : str
            The node's full name, such as '/rig1/gear_sim', to tell the file's sections apart.

        Raises
        ------
        ParameterError
            If the file cannot be read, has nothing for the node, or has an unknown name or a
            value that is not allowed.
        """
        from gear_dynamics.model.dimensionless import read_rig

        values = read_rig(path, node)
        try:
            return cls.from_mapping(values)
        except ParameterError as error:
            raise ParameterError(f'{path}: {error}') from None

    @classmethod
    def from_dimensionless(
        cls,
        *,
        damping_ratio: float,
        error_amplitude: float,
        error_phase: float = 0.0,
        error_harmonics: Sequence[Sequence[float]] = (),
        stiffness_harmonics: Sequence[Sequence[float]] = (),
        damping_in_gap: bool = True,
        **others: Any,
    ) -> GearPair:
        """Return a pair of one degree of freedom, as many published models have it.

        With x = delta / b and tau = wn t:
        x'' + 2 damping_ratio x' + K f(x) = mean load + error_amplitude w^2 sin(w tau + error_phase)
        + sum of amplitude (order w)^2 sin(order w tau + phase), f being the backlash function with
        half gap 1 and K = 1 + sum of amplitude_n cos(n w tau + phase_n) (Kahraman and Singh 1990).
        Supports are rigid, and there is no friction. Mean load and frequency ratio w belong to the
        operating point: `study.OperatingPoint.from_dimensionless`. The same numbers may stand in a
        parameter file under `dimensionless`.

        Parameters
        ----------
        damping_ratio : float
        error_amplitude : float
            Of the transmission error over b.
        error_phase : float
            [rad].
        error_harmonics : rows of three numbers
            Order of the mesh, amplitude over b, phase [rad].
        stiffness_harmonics : rows of two numbers
            Amplitude over the mean and phase [rad] of each harmonic of the mesh, from the first.
        damping_in_gap : bool
            Whether damping acts out of contact too.
        **others
            Further parameters, such as `half_backlash`, in their own units.

        Raises
        ------
        ParameterError
            If a value is out of its range.
        """
        b = others.get('half_backlash', 1e-4)
        errors = [(order, a * b, phase) for order, a, phase in _rows(error_harmonics, 3)]
        waves = _rows(stiffness_harmonics, 2)
        return cls(
            **{
                'support_model': 'rigid',
                'mesh_stiffness': 'harmonic' if waves else 'constant',
                'stiffness_harmonics': _text(waves),
                'friction_coefficient': 0.0,
                'half_backlash': b,
                'mesh_damping_ratio': damping_ratio,
                'damping_in_gap': damping_in_gap,
                'transmission_error_amplitude': error_amplitude * b,
                'transmission_error_phase': error_phase,
                'transmission_error_harmonics': _text(errors),
                **others,
            }
        )

    def to_yaml(self, path: str | Path) -> None:
        """Write every parameter, with unit and meaning, as a ROS parameter file for any node.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        from gear_dynamics.parameters.files import write_parameters

        write_parameters(path, self)


def _rows(rows: Sequence[Sequence[float]] | str, width: int) -> list[tuple[float, ...]]:
    """Return rows of numbers, each of a given width; also from text as in a parameter list.

    Raises
    ------
    ParameterError
        If one has another.
    """
    if isinstance(rows, str):
        return number_rows('harmonics', rows, width)
    for row in rows:
        if not isinstance(row, Sequence) or isinstance(row, str) or len(row) != width:
            raise ParameterError(f'{row!r} in the harmonics: it must be {width} numbers')
    try:
        return [tuple(float(number) for number in row) for row in rows]
    except (TypeError, ValueError):
        raise ParameterError(f'{rows!r} in the harmonics: they must be rows of numbers') from None


def _text(rows: Sequence[Sequence[float]]) -> str:
    """Return rows of numbers as the parameter list has them."""
    return ', '.join(' '.join(f'{number!r}' for number in row) for row in rows)


def checked_pair(pair: Any) -> GearPair:
    """Return what must be a gear pair.

    Raises
    ------
    ParameterError
        If it is anything else.
    """
    if not isinstance(pair, GearPair):
        raise ParameterError(f'pair is {pair!r}: it must be a GearPair, such as GearPair()')
    return pair
