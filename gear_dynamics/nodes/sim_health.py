"""What the sim says of itself in /diagnostics."""

from __future__ import annotations

import time
from collections.abc import Callable

from gear_dynamics.monitoring.level import Level
from gear_dynamics.nodes.diagnostics import Report, Task
from gear_dynamics.nodes.pacing import SECOND, Schedule
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.simulator import Simulator

SLOW = 0.98
"""Share of the wanted pace below which the sim warns that it cannot keep up."""


class SimHealth:
    """Reports of pace, commands and integrator.

    Parameters
    ----------
    settings : SimSettings
        As at the start.
    simulator : Simulator
    schedule : Schedule
    rejected : callable
        Returns the number of commands that were refused.
    """

    def __init__(
        self,
        settings: SimSettings,
        simulator: Simulator,
        schedule: Schedule,
        rejected: Callable[[], int],
    ) -> None:
        self.paused = False
        self._rejected = rejected
        self._wanted = settings.real_time_factor
        self._rate = settings.sample_rate
        self._simulator = simulator
        self._schedule = schedule
        self.restart()

    def tasks(self) -> dict[str, Task]:
        """Return the reports by name."""
        return {'pace': self._pace, 'commands': self._commands, 'integrator': self._integrator}

    def restart(self) -> None:
        """Count the pace from now on: after a reset and after a pause."""
        self._then, self._samples, self._lag = self._count()

    def _pace(self) -> Report:
        now, samples, lag = self._count()
        elapsed = max(now - self._then, 1) / SECOND
        factor = (samples - self._samples) / self._rate / elapsed
        # Whole blocks are counted, so that large ones make the factor waver; the lag does not.
        slow = lag - self._lag > (1 - SLOW) * elapsed
        self._then, self._samples, self._lag = now, samples, lag
        values = {
            'real_time_factor': factor,
            'lag [s]': lag,
            'overruns': self._schedule.overruns,
            'samples': self._simulator.samples_done,
            'sample_rate [Hz]': self._rate,
        }
        if self.paused:
            return Report(Level.OK, 'paused', values)
        if slow:
            message = (
                f'cannot keep up: real-time factor {factor:.3g} of {self._wanted:g}, '
                f'simulated time is {lag:.3g} s behind'
            )
            return Report(Level.WARN, message, values)
        return Report(Level.OK, 'streaming', values)

    def _commands(self) -> Report:
        rejected = self._rejected()
        message = f'{rejected} commands were out of range' if rejected else 'none was refused'
        return Report(Level.OK, message, {'rejected': rejected})

    def _integrator(self) -> Report:
        counters = dict(self._simulator.counters)
        counters['smallest_step [s]'] = counters.pop('smallest_step')
        return Report(Level.OK, f'{counters["steps"]} steps', counters)

    def _count(self) -> tuple[int, int, float]:
        """Return the time [ns], the samples done and the lag [s]."""
        now = time.monotonic_ns()
        lag = 0.0 if self.paused else self._schedule.lag(now)
        return now, self._simulator.samples_done, lag
