"""Faults that belong to no tooth: wear, lubrication and load, from the levels of the channels."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gear_dynamics.machine.columns import ACROSS, ALONG, FORCE
from gear_dynamics.monitoring.layout import Layout, MeshLayout
from gear_dynamics.monitoring.task import (
    Batch,
    Bin,
    Condition,
    Indicator,
    Learned,
    Row,
    Task,
    TaskResult,
)
from gear_dynamics.signal.statistics import Moments

WEAR = 'all teeth alike: wear'
LUBRICATION = 'everywhere: lubrication'
LOAD = 'everywhere: load'
"""Kinds of faults, in words."""

SAME_SPEED, SAME_LOAD, SAME_CONTACT = 0.01, 0.03, 0.1
"""Relative differences of speed and load, and difference of the share of time out of contact, down
to which levels are compared with those learned: at another speed they differ in health."""

EVEN = 0.3
"""Greatest difference of the logarithms by which the channels across the line of action grow with
the friction coefficient alone: it scales them all alike."""

UNLEARNED = 'not learned yet in this operating bin'
ELSEWHERE = 'speed, load or contact differ from those learned in this operating bin'
NAMES = ('wear', 'lubrication', 'load')


class MeshTask(Task):
    """Levels over consecutive spans, compared with those learned at the same speed and load.

    In logarithms over what was learned: a friction that grows scales the channels across the line
    of action alike and leaves those along it; a load that grows shows in the mean of the mesh
    force; wear, which changes the form of all teeth, changes the channels by different factors.

    Parameters
    ----------
    subject : str
        `mesh`, or the name of one of several.
    layout : Layout
        That of a stream with the channels ALONG, ACROSS and FORCE.
    mesh : MeshLayout
        Of a mesh with motion.
    length : int
        Samples in a span, at least.
    normal : Learned
        What is normal.
    """

    name = 'levels'
    indicators = (
        Indicator('wear', '', 'greatest change of one channel against another, 1 if none'),
        Indicator('lubrication', '', 'growth across the line of action, 1 if it is not even'),
        Indicator('load', '', 'mean mesh force over that learned at this load'),
    )

    def __init__(
        self, subject: str, layout: Layout, mesh: MeshLayout, length: int, normal: Learned
    ) -> None:
        self._subject = subject
        self._mesh = mesh
        self._normal = normal
        self._length = length
        self._rate = layout.sample_rate
        self._load = None if layout.load is None else layout.index(layout.load)
        self._delta = layout.index(str(mesh.mesh.displacement))
        channels = list(layout.channels)
        self._along = [channels.index(name) for name in ALONG]
        self._across = [channels.index(name) for name in ACROSS]
        self._force = channels.index(FORCE)
        self._names = channels
        self.seconds = length / layout.sample_rate
        self.restart()

    def restart(self) -> None:
        """Begin the span anew."""
        self._moments = Moments()
        self._sums = np.zeros(2)
        self._cycles = 0.0

    def push(self, batch: Batch) -> Iterator[TaskResult]:
        """Take the next samples; yield what is complete."""
        moments, phase = self._moments, batch.phases[self._mesh.mesh.name]
        moments.add(batch.channels)
        half_backlash = self._mesh.mesh.half_backlash or 0.0
        load = math.nan if self._load is None else float(batch.values[:, self._load].sum())
        lost = np.count_nonzero(np.abs(batch.values[:, self._delta]) < half_backlash)
        self._sums += np.array([load, float(lost)])
        self._cycles += float(phase[-1] - phase[0]) / max(len(phase) - 1, 1) * len(phase)
        if moments.count < self._length:
            return
        count = moments.count
        row = self._row(moments.indicators(), count, batch.bin)
        yield TaskResult(batch.first + len(batch.channels) - count, count, [row])
        self.restart()

    def _row(self, found: dict[str, np.ndarray], count: int, bin_: Bin) -> Row:
        with np.errstate(divide='ignore'):
            levels = np.log(found['std'])
        load, lost = (self._sums / count).tolist()
        state = {
            'speed': self._cycles / count * self._rate,
            'load_torque': load,
            'out_of_contact': lost,
        }
        force = float(found['mean'][self._force])
        references = {f'level_{name}': float(levels[i]) for i, name in enumerate(self._names)}
        references |= state | {'mean_force': force}
        values, reason = self._values(levels, force, state, bin_)
        conditions = [
            Condition('wear', WEAR, _sure(values['wear'], 2.0)),
            Condition('lubrication', LUBRICATION, _sure(values['lubrication'], 1.5)),
            Condition('load', LOAD, _sure(values['load'], 1.05)),
        ]
        return Row(
            self._subject, values, reason=reason, references=references, conditions=conditions
        )

    def _values(
        self, levels: np.ndarray, force: float, state: dict[str, float], bin_: Bin
    ) -> tuple[dict[str, float], str]:
        """Return the values, and why they are NaN."""
        unknown = dict.fromkeys(NAMES, math.nan)
        learned = self._learned(bin_, ['speed', 'load_torque', 'out_of_contact', 'mean_force'])
        normal = np.array(self._learned(bin_, [f'level_{name}' for name in self._names]))
        speed, load, lost, mean_force = learned
        if math.isnan(speed) or np.isnan(normal[self._along]).any():
            return unknown, UNLEARNED
        same = (
            abs(state['speed'] - speed) <= SAME_SPEED * abs(speed)
            and not abs(state['load_torque'] - load) > SAME_LOAD * abs(load)
            and abs(state['out_of_contact'] - lost) <= SAME_CONTACT
        )
        if not same:
            return unknown, ELSEWHERE
        growth = levels - normal
        along, across = growth[self._along], growth[self._across]
        values = {'wear': math.exp(np.ptp([*along, *across])), 'lubrication': 1.0, 'load': math.nan}
        scale = state['load_torque'] / load if load else math.nan
        if mean_force and scale > 0:
            values['load'] = force / mean_force / scale
        even = len(across) > 1 and np.ptp(across) < EVEN
        if even and np.min(np.abs(across)) > np.max(np.abs(along)):
            # All across the line of action changes alike and more than what is along it.
            values |= {'lubrication': math.exp(np.mean(across)), 'wear': 1.0}
        return values, ''

    def _learned(self, bin_: Bin, names: list[str]) -> list[float]:
        found = [self._normal(bin_, f'{self._subject}/{name}') for name in names]
        return [math.nan if each is None else each.mean for each in found]


def _sure(value: float, limit: float) -> float:
    """Return how sure a change is: 0.5 at its limit, more the farther it is beyond."""
    if not value > 1:
        return 0.0
    return 1 - 0.5 ** (math.log(value) / math.log(limit))
