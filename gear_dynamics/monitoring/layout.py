"""What the monitor reads of a stream: which columns are channels, angles and displacements."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from gear_dynamics.machine.configuration import Rig
from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import Mesh
from gear_dynamics.machine.shaft import Angle
from gear_dynamics.parameters.parameter import Parameter
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.signal.order_tracking import pinion_inertia_share

TIME = 't'

MOST_INERTIA = 1e6  # kg m2, as in the parameter list of a gear pair
MOST_SCALE = 1e9


@dataclasses.dataclass(frozen=True)
class AngleTrack:
    """A column of shaft angles and the mesh cycles that it counts.

    Attributes
    ----------
    column : str
    revolution : float
        Recorded units in a revolution of the shaft.
    cycles : float
        Mesh cycles in that revolution.
    """

    column: str
    revolution: float
    cycles: float


@dataclasses.dataclass(frozen=True)
class MeshLayout:
    """One mesh in the stream.

    Attributes
    ----------
    mesh : Mesh
    wheels : tuple of two str
        Driver and driven.
    teeth : tuple of two int
    tracks : tuple of AngleTrack
        That of the driver, and that of the driven wheel if it has an angle of its own.
    weight : float
        Weight of the first track's phase against the second's.
    """

    mesh: Mesh
    wheels: tuple[str, str]
    teeth: tuple[int, int]
    tracks: tuple[AngleTrack, ...]
    weight: float

    @property
    def has_motion(self) -> bool:
        """Whether the relative displacement and its rate are in the stream, with their scales."""
        mesh = self.mesh
        return None not in (
            *(mesh.displacement, mesh.velocity, mesh.half_backlash, mesh.natural_frequency),
        )


@dataclasses.dataclass(frozen=True)
class Layout:
    """A machine and how its stream is laid out.

    Attributes
    ----------
    machine : Machine
    sample_rate : float
        [Hz]
    block_size : int
        Samples in a message; the events of a block come in one message too.
    section_phase : float
        Mesh phase at which section states are taken [cycles].
    load : str or None
        Column of the load; None if it is not recorded.
    """

    machine: Machine
    sample_rate: float
    block_size: int
    section_phase: float = 0.5
    load: str | None = None

    def __post_init__(self) -> None:
        for name, value in (('sample_rate', self.sample_rate), ('block_size', self.block_size)):
            _about(name).check(value)
        if not 0 <= self.section_phase <= 1:
            raise ValueError(f'section_phase is {self.section_phase:g}: it must be from 0 to 1')
        for shaft in self.machine.shafts:
            if shaft.inertia is not None and not 0 < shaft.inertia <= MOST_INERTIA:
                raise ValueError(
                    f'the inertia of shaft {shaft.name} is {shaft.inertia:g} kg m2: it must be '
                    f'above 0, at most {MOST_INERTIA:g}'
                )
        for mesh in self.machine.meshes:
            for name in ('half_backlash', 'natural_frequency'):
                scale = getattr(mesh, name)
                if scale is not None and not 1 / MOST_SCALE <= scale <= MOST_SCALE:
                    raise ValueError(
                        f'{name} of mesh {mesh.name} is {scale:g}: it must be from '
                        f'{1 / MOST_SCALE:g} to {MOST_SCALE:g}'
                    )

    @classmethod
    def of_rig(cls, rig: Rig) -> Layout:
        """Return the layout of the simulated rig's stream."""
        return cls(rig.machine, rig.sample_rate, rig.block_size, rig.section_phase, 'load_torque')

    @functools.cached_property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return tuple(channel.name for channel in self.machine.channels)

    @functools.cached_property
    def channel_columns(self) -> tuple[str, ...]:
        """Their columns."""
        return tuple(str(each.source.column or each.name) for each in self.machine.channels)

    @functools.cached_property
    def scales(self) -> np.ndarray:
        """Factors from recorded values to SI units, one a channel."""
        return np.array([channel.scale for channel in self.machine.channels])

    @functools.cached_property
    def columns(self) -> tuple[str, ...]:
        """All columns that are read, the time first and the channels next, each once."""
        names = [TIME, *self.channel_columns]
        for mesh in self.meshes:
            names += [track.column for track in mesh.tracks]
            if mesh.has_motion:
                names += [str(mesh.mesh.displacement), str(mesh.mesh.velocity)]
        if self.load is not None:
            names.append(self.load)
        return tuple(dict.fromkeys(names))

    def index(self, column: str) -> int:
        """Return the place of a column in `columns`."""
        return self._places[column]

    @functools.cached_property
    def _places(self) -> dict[str, int]:
        return {name: place for place, name in enumerate(self.columns)}

    @functools.cached_property
    def meshes(self) -> tuple[MeshLayout, ...]:
        """The meshes whose phase can be told from angles in the stream."""
        found = (self._mesh(mesh) for mesh in self.machine.meshes)
        return tuple(mesh for mesh in found if mesh.tracks)

    def _mesh(self, mesh: Mesh) -> MeshLayout:
        machine = self.machine
        wheels = machine.wheel(mesh.driver), machine.wheel(mesh.driven)
        tracks: list[AngleTrack] = []
        for wheel in wheels:
            root, ratio = machine.root(wheel.shaft)
            if isinstance(root.speed, Angle):
                column = str(root.speed.source.column or root.name)
                if column not in [track.column for track in tracks]:
                    cycles = float(ratio) * wheel.teeth
                    tracks.append(AngleTrack(column, root.speed.revolution, cycles))
        inertias = [machine.shaft(wheel.shaft).inertia for wheel in wheels]
        weight = 1.0
        if len(tracks) == 2 and inertias[0] and inertias[1]:
            weight = pinion_inertia_share(
                inertias[0], inertias[1], wheels[0].teeth, wheels[1].teeth
            )
        return MeshLayout(
            mesh,
            (wheels[0].name, wheels[1].name),
            (wheels[0].teeth, wheels[1].teeth),
            tuple(tracks),
            weight,
        )

    def same_record(self, other: Layout) -> bool:
        """Whether a record can go on: only scales of the motion differ."""
        return self._without_scales() == other._without_scales()

    def _without_scales(self) -> Layout:
        meshes = tuple(
            dataclasses.replace(
                mesh,
                half_backlash=mesh.half_backlash and 1.0,
                natural_frequency=mesh.natural_frequency and 1.0,
            )
            for mesh in self.machine.meshes
        )
        return dataclasses.replace(self, machine=dataclasses.replace(self.machine, meshes=meshes))


def _about(name: str) -> Parameter:
    return next(about for about in SimSettings.parameters() if about.name == name)
