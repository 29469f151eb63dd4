"""A gear pair that runs: samples, events, commands."""

from __future__ import annotations

import dataclasses
import math
import operator
from typing import Any

import numpy as np

from gear_dynamics.integrator import stepper
from gear_dynamics.integrator.band_limit import BandLimiter, decimations
from gear_dynamics.integrator.constants import pack
from gear_dynamics.integrator.jumps import ROWS_OF_JUMP
from gear_dynamics.integrator.kernel import borrowed, kernel
from gear_dynamics.integrator.layout import (
    DRIVE_TORQUE,
    GEAR_SPEED,
    HIGH_RATE_COLUMNS,
    OVERSAMPLING,
)
from gear_dynamics.integrator.motion import Motion, at_rest
from gear_dynamics.machine.columns import EVENTS, SAMPLE_COLUMNS, SAMPLES, SHAFTS
from gear_dynamics.model.gear_pair import GearPair, checked_pair
from gear_dynamics.model.mesh import intervals as mesh
from gear_dynamics.parameters.parameter import ParameterError, refuse_unknown_name
from gear_dynamics.parameters.run_settings import RunSettings

_CHUNK = 1024


class IntegrationError(RuntimeError):
    """The integrator cannot go on; the message says when and why."""


def why_stopped(clock: np.void, status: int, rtol: float) -> str:
    """Return when and why the integrator stopped with this status, and what may help.

    clock : a record of motion.CLOCK
    """
    time = clock['origin'] / clock['sample_rate'] + clock['begin']
    what = f'the integrator stopped at t = {time:.9g} s'
    if status == stepper.STUCK:
        return (
            f'{what}: the step size fell through its floor; check the parameters, or try another '
            f'rtol than {rtol:g}'
        )
    return f'{what}: the motion is no longer finite; check the parameters'


@kernel(nogil=True)
def _fill(records, zones, profiles, jumps, whole_every, out):
    return stepper.fill_samples(
        records[0], borrowed(zones), borrowed(profiles), borrowed(jumps), whole_every, borrowed(out)
    )


@kernel
def _hand_out(rows, samples, shafts):
    """Split the integrator's rows into samples and what the shafts do besides."""
    for i in range(rows.shape[0]):
        for j in range(GEAR_SPEED):
            samples[i, j] = rows[i, j]
        shafts[i, 0], shafts[i, 1] = rows[i, GEAR_SPEED], rows[i, DRIVE_TORQUE]


@kernel
def _reach_sample(records, zones, profiles, jumps):
    status = stepper.run(records[0], zones, profiles, jumps)
    if status == stepper.DONE:
        stepper.pass_section_before_sample(records[0])
    return status


@kernel
def _interrupt(records):
    stepper.interrupt(records[0])


class Simulator:
    """A gear pair under speed and torque commands.

    Parameters
    ----------
    pair : GearPair
    drive : bool
        False runs the reduced form of docs/model.md.
    profiles : array of mesh.PROFILES, optional
        Flanks that depart from the healthy ones.
    **values
        Fields of `RunSettings` by name: sample_rate, speed, load_torque, speed_rate_limit,
        torque_rate_limit, anti_alias, rtol, atol, section_phase.

    Raises
    ------
    ParameterError
        If `pair` is none, a name is unknown, a value is out of its range, or `profiles` is no table
        of profiles.
    """

    def __init__(
        self,
        pair: GearPair,
        *,
        drive: bool = True,
        profiles: np.ndarray | None = None,
        **values: Any,
    ) -> None:
        self.pair = checked_pair(pair)
        for name in values:
            refuse_unknown_name(name, [about.name for about in RunSettings.parameters()])
        self.settings = RunSettings(**values)
        self._drive = drive
        self._profiles = None if profiles is None else mesh.checked(profiles)
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
    def sample_rate(self) -> float:
        """Samples per second of model time [Hz]."""
        return self.settings.sample_rate

    def reset(self) -> None:
        """Go back to t = 0, in the static deflection of the present commands."""
        self._held_events: list[np.ndarray] = []
        self._motion = self._at_rest()
        if self._limiters:
            first = np.zeros((1, HIGH_RATE_COLUMNS))
            self._integrate(first)
            for limiter in self._limiters:
                limiter.start(first)
            self._motion = self._at_rest()
        self._held_events = []
        self.samples_done = 0

    def _at_rest(self) -> Motion:
        oversampling = OVERSAMPLING ** len(self._limiters)
        return at_rest([self.pair], [self.settings], oversampling, self._drive, self._profiles)

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
        n = _checked_count(n)
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
                _hand_out(made, rows[part], besides[part])
        self.shafts = shafts
        self.samples_done += n
        return samples

    def _integrate(self, rows: np.ndarray) -> None:
        """Fill rows with the integrator's next samples."""
        filled, whole_every = 0, OVERSAMPLING if self._limiters else 1
        while filled < len(rows):
            count, status = _fill(*self._motion, self._jumps, whole_every, rows[filled:])
            filled += count
            self._check(status)
        self._hold_events()

    def _check(self, status: int) -> None:
        clock = self._motion.records[0]['clock']
        if status == stepper.EVENTS_FULL:
            self._hold_events()
        elif status != stepper.DONE:
            raise IntegrationError(why_stopped(clock, status, self.settings.rtol))

    def _hold_events(self) -> None:
        clock = self._motion.records[0]['clock']
        if clock['events']:
            events = self._motion.records[0]['events']
            self._held_events.append(events[: clock['events']].copy())
            clock['events'] = 0
        if self._limiters and clock['jumps']:
            self._limiters[0].smooth(self._jumps[: clock['jumps']])
            clock['jumps'] = 0

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

    def _with(self, **values: float | None) -> RunSettings:
        """Return the settings with those values that are given."""
        given: dict[str, Any] = {name: value for name, value in values.items() if value is not None}
        return dataclasses.replace(self.settings, **given)

    def _go_by(self, settings: RunSettings) -> None:
        """Approach the settings' targets from the interrupted step on."""
        self.settings = settings
        clock = self._motion.records[0]['clock']
        clock['speed_target'], clock['torque_target'] = (
            self.settings.speed,
            self.settings.load_torque,
        )
        clock['speed_limit'] = self.settings.speed_rate_limit
        clock['torque_limit'] = self.settings.torque_rate_limit
        self._approach('speed', 'accel', 'speed_target', 'speed_limit', 'speed_reached')
        self._approach('torque', 'torque_rate', 'torque_target', 'torque_limit', 'torque_reached')

    def _approach(self, value: str, rate: str, target: str, limit: str, reached: str) -> None:
        clock = self._motion.records[0]['clock']
        missing = float(clock[target] - clock[value])
        if missing == 0:
            clock[rate], clock[reached] = 0.0, math.inf
        else:
            clock[rate] = math.copysign(clock[limit], missing)
            clock[reached] = clock['begin'] + abs(missing) / clock[limit]

    def change(
        self,
        *,
        pair: GearPair | None = None,
        speed_rate_limit: float | None = None,
        torque_rate_limit: float | None = None,
    ) -> None:
        """Change parameters from the next sample on; positions, velocities and phase go on.

        Raises
        ------
        ParameterError
            If `pair` is no gear pair or changes a parameter that cannot change while running, or a
            value is out of its range.
        """
        settings = self._with(
            speed_rate_limit=speed_rate_limit, torque_rate_limit=torque_rate_limit
        )
        if pair is not None:
            self._refuse_fixed(checked_pair(pair))
        self._interrupt()
        if pair is not None:
            self.pair = pair
            self._repack()
        self._go_by(settings)

    def _refuse_fixed(self, pair: GearPair) -> None:
        for about in pair.parameters():
            if not about.live and getattr(pair, about.name) != getattr(self.pair, about.name):
                raise ParameterError(
                    f'{about.name} is {getattr(pair, about.name)!r}: it cannot change while '
                    f'running and stays {getattr(self.pair, about.name)!r}'
                )

    def _repack(self) -> None:
        """Put changed parameters into the motion, which goes on from the same state."""
        packed = pack(self.pair, self.settings.rtol, self.settings.atol, self._drive)
        self._motion.records['constants'] = packed
        zones = mesh.zones(self.pair, self._profiles)
        self._motion = self._motion._replace(zones=zones)
        clock = self._motion.records[0]['clock']
        # Where a cycle begins, rounding may leave the phase just below zero.
        zone = np.searchsorted(zones['begin'], clock['phase'], side='right') - 1
        clock['zone'] = max(zone, 0)
        clock['unsettled'] = 1

    def _reach_sample(self) -> None:
        """Step up to the instant of the next sample."""
        status = stepper.EVENTS_FULL
        while status == stepper.EVENTS_FULL:
            status = _reach_sample(*self._motion, self._jumps)
            self._check(status)

    def _interrupt(self) -> None:
        self._reach_sample()
        self._hold_events()
        _interrupt(self._motion.records)

    @property
    def counters(self) -> dict[str, int | float]:
        """Counts since the start: steps, rejected_steps, contact_losses, back_flank_impacts.

        rejected_steps are those that were cut short because contact changed within them;
        contact_losses counts when the last pair in contact loses it; smallest_step is in seconds.
        """
        clock = self._motion.records[0]['clock']
        names = ('steps', 'rejected_steps', 'contact_losses', 'back_flank_impacts')
        counts: dict[str, int | float] = {name: int(clock[name]) for name in names}
        smallest = float(clock['smallest_step'])
        counts['smallest_step'] = smallest if math.isfinite(smallest) else 0.0
        return counts


def _checked_count(n: Any) -> int:
    try:
        count = operator.index(n)
    except TypeError:
        count = -1
    if count < 0:
        raise ParameterError(f'n is {n!r}: it must be a whole number of samples, 0 or more')
    return count
