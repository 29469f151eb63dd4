"""A simulated rig in this process, with its analysis: the page without ROS."""

from __future__ import annotations

import collections
import dataclasses
import queue
import threading
import time
from collections.abc import Mapping
from typing import Any

import yaml

from gear_dynamics.config_files import config_file
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.monitor import Monitor, warm_up
from gear_dynamics.monitoring.results import ConditionResult, Result, TableResult
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.parameter import ParameterError, Value
from gear_dynamics.parameters.settings import AnalyzerSettings, SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.faults import FaultSettings, fault_values
from gear_dynamics.simulation.simulator import Simulator
from gear_dynamics.simulation.stepping import IntegrationError
from gear_dynamics.web.commands import Command, Pause, Reset, SetFault, SetValue, UsePreset
from gear_dynamics.web.hub import Hub
from gear_dynamics.web.live_rig import LiveRig
from gear_dynamics.web.presets import preset_of

CATCH_UP = 0.25
"""Time that the machine may be behind the wall clock and still catch up [s]."""


class LocalMachine:
    """Run a gear pair at wall-clock pace in a thread, analyse it, and feed a LiveRig.

    Parameters
    ----------
    hub : Hub
        Is given the rig once the machine is compiled.
    pair : GearPair
    settings : SimSettings
    """

    def __init__(self, hub: Hub, pair: GearPair, settings: SimSettings) -> None:
        self._hub = hub
        self._rig = LiveRig('local')
        self._pair, self._settings = pair, settings
        self._faults = FaultSettings()
        self._commands: queue.SimpleQueue[Command] = queue.SimpleQueue()
        self._stop = threading.Event()
        self._paused = False
        self._thread = threading.Thread(target=self._run, name='machine', daemon=True)

    def start(self) -> None:
        """Begin to run."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread; one that still compiles ends with the process."""
        self._stop.set()
        self._thread.join(1.0)

    def carry_out(self, command: Command) -> None:
        """Take a command, which is carried out between two blocks."""
        self._commands.put(command)

    def _begin(self, pair: GearPair, settings: SimSettings, faults: FaultSettings) -> None:
        """Start the machine anew with a pair and faults, as at t = 0."""
        self._pair, self._settings, self._faults = pair, settings, faults
        self._simulator = Simulator(
            pair,
            faults=faults.faults(),
            sample_rate=settings.sample_rate,
            speed=settings.speed,
            load_torque=settings.load_torque,
            speed_rate_limit=settings.speed_rate_limit,
            torque_rate_limit=settings.torque_rate_limit,
        )
        thresholds = config_file('thresholds.yaml')
        self._monitor = Monitor(
            AnalyzerSettings(),
            Thresholds({}) if thresholds is None else Thresholds.from_yaml(thresholds),
        )
        self._rig.clear_points()
        self._restart()
        self._configure()
        self._say_faults()

    def _restart(self) -> None:
        self._origin_ns = time.time_ns()
        self._pace: collections.deque[tuple[float, float]] = collections.deque(maxlen=200)
        self._due = time.monotonic()

    def _configure(self) -> None:
        text = configuration_text(self._pair, self._settings)
        self._rig.configure(yaml.safe_load(text))
        self._monitor.configure(Rig.from_text(text))

    def _run(self) -> None:
        warm_up()
        self._begin(self._pair, self._settings, self._faults)
        self._simulator.advance(1)  # compiles what has not been
        self._begin(self._pair, self._settings, self._faults)
        self._hub.add(self._rig, self)
        interval = self._settings.block_size / self._settings.sample_rate
        behind = 0.0
        while not self._stop.is_set():
            while not self._commands.empty():
                self._carry_out(self._commands.get())
            if self._paused:
                self._stop.wait(0.05)
                self._due = time.monotonic()
                continue
            try:
                self._advance()
            except IntegrationError as error:
                self._rig.notice(f'{error}; reset, or choose another preset')
                self._paused = True
                continue
            self._due += interval
            late = time.monotonic() - self._due
            if late > CATCH_UP:
                behind += late
                self._due += late
            self._say(behind)
            self._stop.wait(max(-late, 0.0))

    def _say(self, behind: float) -> None:
        now = time.monotonic()
        self._pace.append((now, self._simulator.samples_done / self._settings.sample_rate))
        (first, begin), (_, end) = self._pace[0], self._pace[-1]
        factor = (end - begin) / (now - first) if now > first and end > begin else 1.0
        values = {'real_time_factor': factor, 'behind': behind}
        message = 'paused' if self._paused else 'running'
        self._rig.set_health('simulator', 0, message, values)

    def _advance(self) -> None:
        simulator, settings = self._simulator, self._settings
        first = simulator.samples_done
        samples = simulator.advance(settings.block_size)
        start = first / settings.sample_rate
        stamp_ns = self._origin_ns + round(start * 1e9)
        samples['t'] -= start
        events = simulator.take_events()
        events['t'] -= start
        self._rig.add_block(samples, settings.sample_rate)
        self._show(self._monitor.add_events(stamp_ns, events))
        self._show(self._monitor.add_block(stamp_ns, samples))

    def _show(self, results: list[Result]) -> None:
        for result in results:
            if isinstance(result, TableResult):
                self._rig.add_table(result.name, result.rows)
            elif isinstance(result, ConditionResult):
                for row in result.rows:
                    values: dict[str, object] = {**row.values, **row.notes}
                    self._rig.set_condition(row.subject, int(row.level), row.message, values)

    def _carry_out(self, command: Command) -> None:
        try:
            self._rig.notice(self._do(command))
        except (ParameterError, IntegrationError) as error:
            self._rig.notice(str(error))

    def _do(self, command: Command) -> str:
        """Carry out a command and return the line that says so."""
        if isinstance(command, SetValue):
            return self._set(command.name, command.value)
        if isinstance(command, Pause):
            self._paused = command.held
            return 'paused' if command.held else 'running'
        if isinstance(command, Reset):
            self._begin(self._pair, self._settings, self._faults)
            return 'back to the start'
        if isinstance(command, UsePreset):
            return self._use_preset(command.name)
        assert isinstance(command, SetFault)
        return self._set_fault(command.kind, vars(command))

    def _set(self, name: str, value: float) -> str:
        if name == 'friction_coefficient':
            self._pair = dataclasses.replace(self._pair, friction_coefficient=value)
            self._simulator.change(pair=self._pair)
        else:
            self._settings = _with(self._settings, {name: value})
            self._simulator.command(
                speed=self._settings.speed, load_torque=self._settings.load_torque
            )
        self._configure()
        return f'{name} set to {value:g}'

    def _set_fault(self, kind: str, values: Mapping[str, Any]) -> str:
        faults = FaultSettings({**self._faults.values, **fault_values(kind, values)})
        self._simulator.change(faults=faults.faults())
        self._faults = faults
        self._say_faults()
        return f'{kind} set to severity {values["severity"]:g}'

    def _say_faults(self) -> None:
        self._rig.set_faults([label.values() for label in self._simulator.labels])

    def _use_preset(self, name: str) -> str:
        preset = preset_of(name)
        path = config_file(preset.pair_file)
        if path is None:
            return f'{name}: config/{preset.pair_file} is not installed'
        values = dict(preset.values)
        friction = values.pop('friction_coefficient')
        pair = dataclasses.replace(GearPair.from_yaml(path), friction_coefficient=friction)
        faults: dict[str, Value] = {}
        for kind, given in preset.faults.items():
            faults.update(fault_values(kind, given))
        self._begin(pair, _with(self._settings, values), FaultSettings(faults))
        return f'running {name}'


def _with(settings: SimSettings, values: Mapping[str, float]) -> SimSettings:
    return SimSettings.from_mapping({**settings.to_mapping(), **values})
