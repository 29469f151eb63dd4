"""One gear pair at constant commands."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from gear_dynamics.machine.columns import EVENTS, SAMPLES
from gear_dynamics.model.faults import Fault
from gear_dynamics.model.faults.collection import checked_faults
from gear_dynamics.model.gear_pair import GearPair, checked_pair
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.simulation.run import Run
from gear_dynamics.simulation.simulator import Simulator
from gear_dynamics.simulation.state import State, checked_state

_BLOCK = 1 << 16


def simulate(
    pair: GearPair,
    duration: float = 1.0,
    sample_rate: float = 51200.0,
    speed: float | None = None,
    load_torque: float | None = None,
    *,
    faults: Sequence[Fault] | None = None,
    anti_alias: bool = True,
    rtol: float = 1e-6,
    atol: float = 1e-9,
    initial_state: State | None = None,
) -> Run:
    """Run a gear pair at constant commands, from the static deflection under them.

    Parameters
    ----------
    pair : GearPair
    duration : float
        Model time [s].
    sample_rate : float
        Samples per second [Hz].
    speed : float, optional
        Pinion speed [rad/s]; 104.72, or that of `initial_state`.
    load_torque : float, optional
        On the gear [N m]; 150, or that of `initial_state`.
    faults : sequence of Fault, optional
        What is wrong with the machine, such as gd.faults.RootCrack('pinion', tooth=5); nothing, or
        that of `initial_state`.
    anti_alias : bool
        Whether the samples are band-limited, as those of the node are; False gives raw values.
    rtol, atol : float
        Tolerances of the integrator.
    initial_state : State, optional
        `final_state` of an earlier run. This run goes on from there: both joined equal one run to
        the last bit. Other commands are approached at the rate limits; live parameters of `pair`
        and `faults` change as in `Simulator.change`.

    Returns
    -------
    Run
        With round(duration * sample_rate) samples.

    Raises
    ------
    ParameterError
        If an argument is out of its range, a fault does not fit the pair, or the initial state is
        of other samples or tolerances.
    IntegrationError
        If the integrator cannot go on.

    Examples
    --------
    >>> run = simulate(GearPair(), duration=0.1)
    >>> len(run)
    5120
    >>> bool(abs(run['mesh_force'].mean() - 150 / 0.055442) < 20)  # the torque over the base radius
    True
    >>> more = simulate(GearPair(), duration=0.1, initial_state=run.final_state)
    >>> float(more['t'][0])
    0.1
    """
    sampling: dict[str, Any] = {
        'sample_rate': sample_rate,
        'anti_alias': anti_alias,
        'rtol': rtol,
        'atol': atol,
    }
    commands = {'speed': speed, 'load_torque': load_torque}
    given: dict[str, Any] = {name: value for name, value in commands.items() if value is not None}
    if initial_state is None:
        simulator = Simulator(pair, faults=faults or (), **sampling, **given)
    else:
        _refuse_other_sampling(checked_state('initial_state', initial_state), sampling)
        simulator = _simulator_of(initial_state)
        new_faults = simulator.faults if faults is None else checked_faults(faults)
        if (checked_pair(pair), new_faults) != (simulator.pair, simulator.faults):
            simulator.change(pair=pair, faults=new_faults)
        if any(getattr(simulator.settings, name) != value for name, value in given.items()):
            simulator.command(**given)
    return _advance(simulator, simulator.settings.sample_count(duration, SAMPLES.itemsize))


def _refuse_other_sampling(state: State, sampling: dict[str, Any]) -> None:
    for name, value in sampling.items():
        before = getattr(state.settings, name)
        if value != before:
            raise ParameterError(
                f'{name} is {value!r}: initial_state is of a run with {before!r}; give {name}='
                f'{before!r}'
            )


def _simulator_of(state: State) -> Simulator:
    values = dataclasses.asdict(state.settings)
    simulator = Simulator(
        state.pair, drive=state.drive, faults=state.faults, ports=state.ports, **values
    )
    simulator.set_state(state)
    return simulator


def _advance(simulator: Simulator, count: int) -> Run:
    samples = np.empty(count, SAMPLES)
    events = [np.zeros(0, EVENTS)]
    for begin in range(0, count, _BLOCK):
        end = min(begin + _BLOCK, count)
        samples[begin:end] = simulator.advance(end - begin)
        events.append(simulator.take_events())
    return Run(
        samples,
        np.concatenate(events),
        simulator.pair,
        simulator.settings,
        simulator.faults,
        simulator.state(),
    )
