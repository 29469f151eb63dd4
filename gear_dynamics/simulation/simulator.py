"""A gear pair that runs: samples, events, commands."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gear_dynamics.integrator import stepper
from gear_dynamics.integrator.band_limit import BandLimiter, decimations
from gear_dynamics.integrator.jumps import ROWS_OF_JUMP
from gear_dynamics.integrator.layout import HIGH_RATE_COLUMNS, OVERSAMPLING
from gear_dynamics.integrator.motion import Motion, copy_of, elapsed, renewed, start
from gear_dynamics.integrator.tables import Fade, Group, make_tables
from gear_dynamics.machine.columns import EVENTS, SAMPLE_COLUMNS, SAMPLES, SHAFTS
from gear_dynamics.model.faults import Fault
from gear_dynamics.model.faults.collection import checked_faults
from gear_dynamics.model.faults.label import Label, labels
from gear_dynamics.model.gear_pair import GearPair, checked_pair
from gear_dynamics.model.ports import HEALTHY, Ports, checked_ports
from gear_dynamics.parameters.parameter import ParameterError, refuse_unknown_name
from gear_dynamics.parameters.run_settings import RunSettings
from gear_dynamics.simulation.state import State, checked_state, model_ports
from gear_dynamics.simulation.stepping import (
    IntegrationError,
    checked_count,
    fill,
    hand_out,
    interrupt,
    reach_sample,
    why_stopped,
)

_CHUNK = 1024

RAMP = 0.05
"""Time in which ports fade out and in when they change [s]."""


class Simulator:
    """A gear pair under speed and torque commands.

    Parameters
    ----------
    pair : GearPair
    drive : bool
        False runs the reduced form of docs/model.md.
    faults : sequence of Fault
        What is wrong with the machine, such as gd.faults.RootCrack('pinion', tooth=5).
    ports : Ports
        How the machine departs from the healthy one.
    **values
        Fields of `RunSettings` by name: sample_rate, speed, load_torque, speed_rate_limit,
        torque_rate_limit, anti_alias, rtol, atol, section_phase.

    Raises
    ------
    ParameterError
        If `pair` is none, a name is unknown, a value is out of its range, or `ports` are none.
    """

    def __init__(
        self,
        pair: GearPair,
        *,
        faults: Sequence[Fault] = (),
        drive: bool = True,
        ports: Ports = HEALTHY,
        **values: Any,
    ) -> None:
        self.pair = checked_pair(pair)
        for name in values:
            refuse_unknown_name(name, [about.name for about in RunSettings.parameters()])
        self.settings = RunSettings(**values)
        self.ports, self.faults = checked_ports(ports), checked_faults(faults)
        self._drive = drive
        self._limiters = self._make_limiters() if self.settings.anti_alias else []
        self._jumps = np.zeros((_CHUNK if self._limiters else 0, ROWS_OF_JUMP, HIGH_RATE_COLUMNS))
        self._rows = np.zeros((_CHUNK, HIGH_RATE_COLUMNS))
        self.shafts = np.zeros(0, SHAFTS)
        """Of the samples that were last handed out: an array of SHAFTS."""
        self.reset()

    def _make_limiters(self) -> list[BandLimiter]:
        """Return what brings the samples down to the rate, the highest rate first."""
        limiters, source = [], self._integrate
        for power in reversed(range(decimations(self.sample_rate))):
            limiters.append(BandLimiter(_CHUNK, self.sample_rate * OVERSAMPLING**power, source))
            source = limiters[-1].fill
        return limiters

    @property
    def labels(self) -> tuple[Label, ...]:
        """What is wrong with the machine, and the orders at which it shows."""
        return labels(self.faults, self.pair)

    @property
    def sample_rate(self) -> float:
        """Samples per second of model time [Hz]."""
        return self.settings.sample_rate

    @property
    def _record(self) -> np.void:
        return self._motion.records[0]

    def reset(self, pair: GearPair | None = None, faults: Sequence[Fault] | None = None) -> None:
        """Go back to t = 0, in the static deflection of the present commands.

        Parameters
        ----------
        pair : GearPair, optional
            Another pair to go on with.
        faults : sequence of Fault, optional
            All that is wrong with the machine from then on; the present faults by default.

        Raises
        ------
        ParameterError
            If `pair` is no gear pair, or a fault does not fit it; nothing changes then.
        """
        new_pair = self.pair if pair is None else checked_pair(pair)
        new_faults = self.faults if faults is None else checked_faults(faults)
        model_ports(new_pair, self.settings, self.ports, new_faults)
        self.pair, self.faults = new_pair, new_faults
        self._held_events: list[np.ndarray] = []
        self._motion = self._start()
        if self._limiters:
            first = np.zeros((1, HIGH_RATE_COLUMNS))
            self._integrate(first)
            for limiter in self._limiters:
                limiter.start(first)
            self._motion = self._start()
        self._held_events = []
        self.samples_done = 0

    def _start(self) -> Motion:
        oversampling = OVERSAMPLING ** len(self._limiters)
        ports = model_ports(self.pair, self.settings, self.ports, self.faults)
        self._fade = Fade.of(ports)
        return start(self.pair, self.settings, oversampling, self._drive, ports)

    def advance(self, n: int) -> np.ndarray:
        """Return the next n samples, an (n,) array of SAMPLES; t is since the start of the run.

        Events are kept until `take_events` takes them, however many they become: 3 GB in an hour of
        the default pair at 15 000 rpm.

        Raises
        ------
        ParameterError
            If n is no whole number, or negative.
        IntegrationError
            If the step size falls through its floor or the motion is no longer finite.
        """
        n = checked_count(n)
        samples, shafts = np.empty(n, SAMPLES), np.empty(n, SHAFTS)
        rows = samples.view(np.float64).reshape(n, len(SAMPLE_COLUMNS))
        besides = shafts.view(np.float64).reshape(n, 2)
        for begin in range(0, n, _CHUNK):
            part = slice(begin, begin + _CHUNK)
            if self._limiters:
                self._limiters[-1].make(rows[part], besides[part])
            else:
                made = self._rows[: len(rows[part])]
                self._integrate(made)
                hand_out(made, rows[part], besides[part])
        self.shafts = shafts
        self.samples_done += n
        return samples

    def _integrate(self, rows: np.ndarray) -> None:
        """Fill rows with the integrator's next samples."""
        filled, whole_every = 0, OVERSAMPLING if self._limiters else 1
        while filled < len(rows):
            count, status = fill(*self._motion, self._jumps, whole_every, rows[filled:])
            filled += count
            self._check(status)
        self._hold_events()

    def _check(self, status: int) -> None:
        if status == stepper.EVENTS_FULL:
            self._hold_events()
        elif status != stepper.DONE:
            raise IntegrationError(why_stopped(self._record, status, self.settings.rtol))

    def _hold_events(self) -> None:
        counts = self._record['counts']
        if counts['events']:
            self._held_events.append(self._record['events'][: counts['events']].copy())
            counts['events'] = 0
        if self._limiters and counts['jumps']:
            self._limiters[0].smooth(self._jumps[: counts['jumps']])
            counts['jumps'] = 0

    def take_events(self) -> np.ndarray:
        """Return the events within the time of the samples handed out since the last call.

        That time ends where the next sample is due, so that no event is older than its block.
        Events that are not taken stay in memory, without bound: call it after each `advance`.

        Returns
        -------
        (m,) array of EVENTS
            In order of time; t is since the start of the run.
        """
        self._reach_sample()
        self._hold_events()
        if not self._held_events:
            return np.zeros(0, EVENTS)
        events = np.concatenate(self._held_events)
        due = int(np.searchsorted(events['t'], self.samples_done / self.sample_rate))
        self._held_events = [events[due:]] if due < len(events) else []
        return events[:due]

    def command(self, *, speed: float | None = None, load_torque: float | None = None) -> None:
        """Set new targets, which are approached at the rate limits from the next sample on.

        The band-limited stream is integrated `layout.AHEAD` samples ahead of what it hands out, at
        rates below 25 kHz up to a third more; a command takes effect there.

        Raises
        ------
        ParameterError
            If a value is out of its range.
        """
        settings = self._with(speed=speed, load_torque=load_torque)
        self._interrupt()
        self._go_by(settings)
        if self.pair.friction_model != 'coulomb' or any(f.FOLLOWS_COMMANDS for f in self.faults):
            self._put_ports(self._time_to_targets())

    def _with(self, **values: float | None) -> RunSettings:
        """Return the settings with those values that are given."""
        given: dict[str, Any] = {name: value for name, value in values.items() if value is not None}
        return dataclasses.replace(self.settings, **given)

    def _go_by(self, settings: RunSettings) -> None:
        """Approach the settings' targets from the interrupted step on."""
        self.settings = settings
        commands = self._record['commands']
        commands['speed_target'], commands['torque_target'] = settings.speed, settings.load_torque
        commands['speed_limit'] = settings.speed_rate_limit
        commands['torque_limit'] = settings.torque_rate_limit
        self._approach('speed', 'accel')
        self._approach('torque', 'torque_rate')

    def _approach(self, name: str, rate: str) -> None:
        commands = self._record['commands']
        missing = float(commands[f'{name}_target'] - commands[name])
        if missing == 0:
            commands[rate], commands[f'{name}_reached'] = 0.0, math.inf
        else:
            limit = commands[f'{name}_limit']
            commands[rate] = math.copysign(limit, missing)
            commands[f'{name}_reached'] = self._record['step']['begin'] + abs(missing) / limit

    def _time_to_targets(self) -> float:
        """Return how long the commands take to reach their targets, RAMP at least [s]."""
        commands = self._record['commands']
        ends = [float(commands[name]) for name in ('speed_reached', 'torque_reached')]
        last = max((end for end in ends if math.isfinite(end)), default=0.0)
        return max(last - float(self._record['step']['begin']), RAMP)

    def change(
        self,
        *,
        pair: GearPair | None = None,
        faults: Sequence[Fault] | None = None,
        ports: Ports | None = None,
        ramp: float = RAMP,
        speed_rate_limit: float | None = None,
        torque_rate_limit: float | None = None,
    ) -> None:
        """Change parameters from the next sample on; positions, velocities and phase go on.

        Parameters
        ----------
        pair : GearPair, optional
        faults : sequence of Fault, optional
            All that is wrong with the machine from now on.
        ports : Ports, optional
            How the machine departs from the healthy one from now on.
        ramp : float
            Time in which ports fade out and in, linearly [s]; 0 changes them at once. Terms that
            are there before and after do not change.
        speed_rate_limit, torque_rate_limit : float, optional

        Raises
        ------
        ParameterError
            If `pair` is no gear pair or changes a parameter that cannot change while running, or a
            value is out of its range.
        """
        settings = self._with(
            speed_rate_limit=speed_rate_limit, torque_rate_limit=torque_rate_limit
        )
        if not (math.isfinite(ramp) and ramp >= 0):
            raise ParameterError(f'ramp is {ramp!r}: it must be a time in seconds, 0 or more')
        new_pair = self.pair if pair is None else checked_pair(pair)
        self._refuse_fixed(new_pair)
        new_ports = self.ports if ports is None else checked_ports(ports)
        new_faults = self.faults if faults is None else checked_faults(faults)
        # What cannot be is refused before anything changes.
        make_tables(new_pair, [Group(model_ports(new_pair, settings, new_ports, new_faults))])
        self._interrupt()
        self.pair, self.ports, self.faults = new_pair, new_ports, new_faults
        if pair is not None or ports is not None or faults is not None:
            self._put_ports(ramp)
        self._go_by(settings)

    def _refuse_fixed(self, pair: GearPair) -> None:
        for about in pair.parameters():
            if not about.live and getattr(pair, about.name) != getattr(self.pair, about.name):
                raise ParameterError(
                    f'{about.name} is {getattr(pair, about.name)!r}: it cannot change while '
                    f'running and stays {getattr(self.pair, about.name)!r}'
                )

    def _put_ports(self, ramp: float) -> None:
        """Put the present pair and ports into the motion, which goes on from the same state."""
        target = model_ports(self.pair, self.settings, self.ports, self.faults)
        begin = elapsed(self._record)
        self._fade = self._fade.towards(target, begin, ramp)
        self._motion = renewed(self._motion, self.pair, self.settings, self._drive, self._fade)

    def _reach_sample(self) -> None:
        """Step up to the instant of the next sample."""
        status = stepper.EVENTS_FULL
        while status == stepper.EVENTS_FULL:
            status = reach_sample(*self._motion, self._jumps)
            self._check(status)

    def _interrupt(self) -> None:
        self._reach_sample()
        self._hold_events()
        interrupt(self._motion.records)

    @property
    def counters(self) -> dict[str, int | float]:
        """Counts since the start: steps, rejected_steps, contact_losses, back_flank_impacts.

        rejected_steps are those that were cut short because contact changed within them;
        contact_losses counts when the last pair in contact loses it; smallest_step is in seconds.
        """
        names = ('steps', 'rejected_steps', 'contact_losses', 'back_flank_impacts')
        counts: dict[str, int | float] = {n: int(self._record['counts'][n]) for n in names}
        smallest = float(self._record['step']['smallest'])
        counts['smallest_step'] = smallest if math.isfinite(smallest) else 0.0
        return counts

    def state(self) -> State:
        """Return everything that the next samples depend on; see `set_state`."""
        return State(
            pair=self.pair,
            settings=self.settings,
            ports=self.ports,
            faults=self.faults,
            drive=self._drive,
            samples_done=self.samples_done,
            motion=copy_of(self._motion),
            fade=self._fade,
            held_events=tuple(self._held_events),
            filters=tuple(limiter.memory() for limiter in self._limiters),
        )

    def set_state(self, state: State) -> None:
        """Go on from a state: the next samples and events are those that followed it.

        Raises
        ------
        ParameterError
            If the state is of a simulator with other samples or another form of the equations.
        """
        checked_state('state', state)
        for name in ('sample_rate', 'anti_alias'):
            mine, other = getattr(self.settings, name), getattr(state.settings, name)
            if mine != other:
                raise ParameterError(f'{name} is {mine!r}: the state is of {other!r}')
        if state.drive != self._drive:
            raise ParameterError(f'drive is {self._drive!r}: the state is of {state.drive!r}')
        self.pair, self.settings = state.pair, state.settings
        self.ports, self.faults = state.ports, state.faults
        self._motion, self._fade = copy_of(state.motion), state.fade
        self._held_events = list(state.held_events)
        self.samples_done = state.samples_done
        for limiter, memory in zip(self._limiters, state.filters, strict=True):
            limiter.set_memory(memory)

    def copy(self) -> Simulator:
        """Return an independent simulator in the same state."""
        values = dataclasses.asdict(self.settings)
        other = Simulator(
            self.pair, drive=self._drive, ports=self.ports, faults=self.faults, **values
        )
        other.set_state(self.state())
        return other
