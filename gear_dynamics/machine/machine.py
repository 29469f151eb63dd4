"""A machine: its shafts, wheels, meshes, bearings and channels, checked as a whole."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeVar

from gear_dynamics.machine import mapping
from gear_dynamics.machine.channel import Channel
from gear_dynamics.machine.file import machine_arguments, read_machine
from gear_dynamics.machine.parts import Bearing, Mesh, Wheel
from gear_dynamics.machine.recording_form import RecordingForm, Severity
from gear_dynamics.machine.shaft import DrivenBy, Shaft, TrackedSpeed

NAME = re.compile(r'[A-Za-z][A-Za-z0-9_]*')
"""Names become parts of topics and of column names."""

FEWEST_TEETH, MOST_TEETH = 4, 1000

_Part = TypeVar('_Part', Channel, Shaft, Wheel, Mesh, Bearing)


@dataclasses.dataclass(frozen=True)
class Machine:
    """What a machine is, simulated or real. Parallel shafts, any number of stages.

    Attributes
    ----------
    name : str
    channels : tuple of Channel
    shafts : tuple of Shaft
    wheels : tuple of Wheel
    meshes : tuple of Mesh
    bearings : tuple of Bearing
    recording : RecordingForm
        How its recordings are laid out.
    severity : Severity, optional
        Zone limits of the velocity RMS.

    Raises
    ------
    ValueError
        With one line, if the parts do not fit together.
    """

    name: str
    channels: tuple[Channel, ...]
    shafts: tuple[Shaft, ...] = ()
    wheels: tuple[Wheel, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    bearings: tuple[Bearing, ...] = ()
    recording: RecordingForm = dataclasses.field(default_factory=RecordingForm)
    severity: Severity | None = None

    def __post_init__(self) -> None:
        for kind, parts in self._kinds():
            _check_names(kind, [part.name for part in parts])
        if not self.channels:
            raise ValueError(f'{self.name} has no channels: at least one is needed')
        for wheel in self.wheels:
            self._find('shafts', self.shafts, wheel.shaft, f'wheel {wheel.name}')
            if not FEWEST_TEETH <= wheel.teeth <= MOST_TEETH:
                raise ValueError(
                    f'wheel {wheel.name} has {wheel.teeth} teeth: it must have from '
                    f'{FEWEST_TEETH} to {MOST_TEETH}'
                )
        for mesh in self.meshes:
            self._check_mesh(mesh)
        for bearing in self.bearings:
            self._check_bearing(bearing)
        for shaft in self.shafts:
            if isinstance(shaft.speed, TrackedSpeed) and shaft.speed.channel is not None:
                owner = f'the speed of shaft {shaft.name}'
                self._find('channels', self.channels, shaft.speed.channel, owner)
            self.root(shaft.name)

    @classmethod
    def from_yaml(cls, path: str | Path) -> Machine:
        """Read a machine file, as docs/machines.md describes it.

        Raises
        ------
        ValueError
            With one line that names the file, the key and what is wrong.
        """
        arguments = read_machine(path)
        try:
            return cls(**arguments)
        except ValueError as error:
            raise ValueError(f'{path}: {error}') from None

    @classmethod
    def from_mapping(cls, content: Mapping[str, Any]) -> Machine:
        """Return the machine of a machine file's content."""
        return cls(**machine_arguments(content))

    def to_mapping(self) -> dict[str, Any]:
        """Return the content of a machine file, from which `from_mapping` makes an equal machine.

        Speeds in rpm, and limits in mm/s, come back within rounding.
        """
        content: dict[str, Any] = {'machine': self.name, **mapping.form_mapping(self.recording)}
        content['channels'] = {each.name: mapping.channel_mapping(each) for each in self.channels}
        content['shafts'] = {each.name: mapping.shaft_mapping(each) for each in self.shafts}
        content['wheels'] = {
            each.name: {'shaft': each.shaft, 'teeth': each.teeth} for each in self.wheels
        }
        content['meshes'] = {each.name: mapping.mesh_mapping(each) for each in self.meshes}
        content['bearings'] = {each.name: mapping.bearing_mapping(each) for each in self.bearings}
        if self.severity is not None:
            content['severity'] = mapping.severity_mapping(self.severity)
        return {key: value for key, value in content.items() if value != {}}

    def channel(self, name: str) -> Channel:
        """Return a channel by its name."""
        return self._find('channels', self.channels, name)

    def shaft(self, name: str) -> Shaft:
        """Return a shaft by its name."""
        return self._find('shafts', self.shafts, name)

    def wheel(self, name: str) -> Wheel:
        """Return a wheel by its name."""
        return self._find('wheels', self.wheels, name)

    def mesh(self, name: str) -> Mesh:
        """Return a mesh by its name."""
        return self._find('meshes', self.meshes, name)

    def meshes_of(self, wheel: str) -> list[tuple[Mesh, Wheel]]:
        """Return the meshes of a wheel, each with the wheel on its other side."""
        found = []
        for mesh in self.meshes:
            if wheel in (mesh.driver, mesh.driven):
                other = mesh.driven if wheel == mesh.driver else mesh.driver
                found.append((mesh, self.wheel(other)))
        return found

    def root(self, shaft: str) -> tuple[Shaft, Fraction]:
        """Return the shaft whose speed is known by itself, and the ratio of speeds to it.

        Returns
        -------
        root : Shaft
            The first shaft on the way along `driven_by` that is driven by no mesh.
        ratio : Fraction
            Revolutions of `shaft` in one revolution of the root; shafts count forward alike.

        Raises
        ------
        ValueError
            If shafts drive each other in a circle, or a mesh does not touch its shaft.
        """
        ratio = Fraction(1)
        way = [shaft]
        current = self.shaft(shaft)
        while isinstance(current.speed, DrivenBy):
            other, step = self._through(current, current.speed.mesh)
            ratio *= step
            if other in way:
                raise ValueError(f'shafts drive each other in a circle: {", ".join(way)}')
            way.append(other)
            current = self.shaft(other)
        return current, ratio

    def _through(self, shaft: Shaft, mesh_name: str) -> tuple[str, Fraction]:
        """Return the shaft on the other side of a mesh, and how often `shaft` turns to its one."""
        mesh = self._find('meshes', self.meshes, mesh_name, f'driven_by of shaft {shaft.name}')
        driver, driven = self.wheel(mesh.driver), self.wheel(mesh.driven)
        if shaft.name == driven.shaft:
            return driver.shaft, Fraction(driver.teeth, driven.teeth)
        if shaft.name == driver.shaft:
            return driven.shaft, Fraction(driven.teeth, driver.teeth)
        raise ValueError(
            f'shaft {shaft.name} is driven_by {mesh.name}, which has no wheel on it: '
            f'{mesh.name} meshes {driver.name} on {driver.shaft} with {driven.name} on '
            f'{driven.shaft}'
        )

    def _kinds(self) -> Iterator[tuple[str, tuple[Channel | Shaft | Wheel | Mesh | Bearing, ...]]]:
        yield 'channels', self.channels
        yield 'shafts', self.shafts
        yield 'wheels', self.wheels
        yield 'meshes', self.meshes
        yield 'bearings', self.bearings

    def _check_mesh(self, mesh: Mesh) -> None:
        owner = f'mesh {mesh.name}'
        driver = self._find('wheels', self.wheels, mesh.driver, owner)
        driven = self._find('wheels', self.wheels, mesh.driven, owner)
        if driver.shaft == driven.shaft:
            raise ValueError(
                f'{owner} joins {driver.name} and {driven.name}, both on shaft {driver.shaft}: '
                'wheels that mesh turn on different shafts'
            )

    def _check_bearing(self, bearing: Bearing) -> None:
        owner = f'bearing {bearing.name}'
        self._find('shafts', self.shafts, bearing.shaft, owner)
        for channel in bearing.channels:
            self._find('channels', self.channels, channel, owner)
        for defect, order in bearing.orders.items():
            if not order > 0:
                raise ValueError(f'{owner}: order {defect} must be above 0')
        if not 0 <= bearing.slip <= 0.1:
            raise ValueError(f'{owner}: slip is {bearing.slip:g}: it must be from 0 to 0.1')

    def _find(self, kind: str, parts: Iterable[_Part], name: str, owner: str = '') -> _Part:
        parts = tuple(parts)
        for part in parts:
            if part.name == name:
                return part
        known = ', '.join(part.name for part in parts) or 'none'
        subject = f'{owner} names {name!r}, which' if owner else f'{name!r}'
        raise ValueError(f'{subject} is none of the {kind} of {self.name}: they are {known}')


def _check_names(kind: str, names: list[str]) -> None:
    for name in names:
        if not NAME.fullmatch(name):
            raise ValueError(
                f'{name!r} of the {kind} is no name: letters, digits and _ are allowed, '
                'and a letter comes first'
            )
        if names.count(name) > 1:
            raise ValueError(f'{name!r} stands twice in the {kind}')
