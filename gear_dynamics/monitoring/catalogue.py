"""All monitoring tasks, and the names of all indicators that `condition` can hold."""

from __future__ import annotations

import collections
import difflib
import functools
from collections.abc import Iterable, Iterator

from gear_dynamics.machine.columns import ACROSS, ALONG, FORCE
from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring import diagnosis, wheel_average
from gear_dynamics.monitoring.angle_task import AngleTask
from gear_dynamics.monitoring.contact_task import ContactTask
from gear_dynamics.monitoring.envelope_task import EnvelopeTask
from gear_dynamics.monitoring.layout import Layout, MeshLayout
from gear_dynamics.monitoring.mesh_task import MeshTask
from gear_dynamics.monitoring.motion_task import MotionTask
from gear_dynamics.monitoring.record import Factory
from gear_dynamics.monitoring.spectrum_task import SpectrumTask
from gear_dynamics.monitoring.statistics_task import StatisticsTask
from gear_dynamics.monitoring.task import Indicator, Learned
from gear_dynamics.monitoring.wheel_average import Harmonics
from gear_dynamics.parameters.settings import AnalyzerSettings


class Catalogue:
    """Makes the tasks of a machine.

    Parameters
    ----------
    settings : AnalyzerSettings
    layout : Layout
    restarts : Counter
        Where work that begins anew is counted, by reason.
    harmonics : dict of str to Harmonics
        What NB4 keeps of each wheel, from record to record.
    normal : Learned
        What is normal.
    """

    def __init__(
        self,
        settings: AnalyzerSettings,
        layout: Layout,
        restarts: collections.Counter[str],
        harmonics: dict[str, Harmonics],
        normal: Learned,
    ) -> None:
        self._normal = normal
        self._settings = settings
        self._layout = layout
        self._restarts = restarts
        self._harmonics = harmonics

    def factories(self) -> Iterator[Factory]:
        """Yield a function for each task that makes it."""
        settings, layout = self._settings, self._layout
        rate, channels = layout.sample_rate, layout.channels
        length = max(2, round(settings.statistics_duration * rate))
        yield functools.partial(SpectrumTask, settings, rate, channels)
        yield functools.partial(StatisticsTask, length, rate, channels)
        yield functools.partial(EnvelopeTask, settings, max(length, 256), rate, channels)
        averaged: set[str] = set()
        for mesh in layout.meshes:
            sides = [side for side in (0, 1) if mesh.wheels[side] not in averaged]
            averaged |= set(mesh.wheels)
            yield functools.partial(self._angle_task, mesh, sides)
        for mesh in self._with_motion:
            yield functools.partial(self._contact_task, mesh, length)
            yield functools.partial(self._motion_task, mesh)
            if {*ALONG, *ACROSS, FORCE} <= set(channels):
                subject = self._subject('mesh', mesh)
                yield functools.partial(MeshTask, subject, layout, mesh, length, self._normal)

    @functools.cached_property
    def _with_motion(self) -> list[MeshLayout]:
        return [mesh for mesh in self._layout.meshes if mesh.has_motion]

    def _angle_task(self, mesh: MeshLayout, sides: list[int]) -> AngleTask:
        return AngleTask(
            self._settings,
            self._layout,
            mesh,
            sides,
            self._restarts,
            self._harmonics,
            self._normal,
        )

    def _contact_task(self, mesh: MeshLayout, length: int) -> ContactTask:
        assert mesh.mesh.half_backlash is not None
        return ContactTask(
            self._subject('contact', mesh),
            mesh.mesh.name,
            self._layout.index(str(mesh.mesh.displacement)),
            mesh.mesh.half_backlash,
            length,
            self._layout.sample_rate,
        )

    def _motion_task(self, mesh: MeshLayout) -> MotionTask:
        subject = self._subject('motion', mesh)
        return MotionTask(subject, self._settings, self._layout, mesh, self._restarts)

    def _subject(self, name: str, mesh: MeshLayout) -> str:
        return name if len(self._with_motion) == 1 else f'{mesh.mesh.name}_{name}'


OF_CHANNEL = (*StatisticsTask.indicators, *EnvelopeTask.indicators)
OF_CHANNEL_AND_WHEEL = wheel_average.INDICATORS
OF_WHEEL = diagnosis.INDICATORS
OF_MESH = {
    'contact': ContactTask.indicators,
    'motion': MotionTask.indicators,
    'mesh': MeshTask.indicators,
}


def indicators(machine: Machine) -> dict[str, Indicator]:
    """Return every SUBJECT/NAME that `condition` can hold of a machine, with its declaration."""
    wheels = [wheel.name for wheel in machine.wheels]
    meshes = [mesh.name for mesh in machine.meshes if mesh.displacement]
    found: dict[str, Indicator] = {}
    for channel in (channel.name for channel in machine.channels):
        of_wheels = {
            f'{wheel}_{each.name}': each for wheel in wheels for each in OF_CHANNEL_AND_WHEEL
        }
        names = {each.name: each for each in OF_CHANNEL} | of_wheels
        found |= {f'{channel}/{name}': each for name, each in names.items()}
    found |= {f'{wheel}/{each.name}': each for wheel in wheels for each in OF_WHEEL}
    for subject, of_mesh in OF_MESH.items():
        subjects = [f'{mesh}_{subject}' for mesh in meshes] if len(meshes) > 1 else [subject]
        found |= {f'{name}/{each.name}': each for name in subjects for each in of_mesh}
    return found


def check_names(names: Iterable[str], machine: Machine) -> None:
    """Check that every name is an indicator of a machine, or `*/NAME` for that of every subject.

    Raises
    ------
    ValueError
        If one is not; the message names the nearest that is.
    """
    known = set(indicators(machine))
    known |= {f'*/{each.split("/")[1]}' for each in known}
    for name in names:
        if name not in known:
            nearest = difflib.get_close_matches(name, sorted(known), 1, 0)
            raise ValueError(f'{name!r} is no indicator: the nearest is {nearest[0]!r}')


def markdown() -> str:
    """Return the table of all indicators for the docs."""
    rows = ['| indicator | unit | what it is |', '|---|---|---|']
    for pattern, group in (
        ('CHANNEL/{}', OF_CHANNEL),
        ('CHANNEL/WHEEL_{}', OF_CHANNEL_AND_WHEEL),
        ('WHEEL/{}', OF_WHEEL),
        *((f'{subject}/{{}}', of_mesh) for subject, of_mesh in OF_MESH.items()),
    ):
        for each in group:
            unit = {'own': "the channel's", '': ''}.get(each.unit, each.unit)
            rows.append(f'| `{pattern.format(each.name)}` | {unit} | {each.about} |')
    return '\n'.join(rows)
