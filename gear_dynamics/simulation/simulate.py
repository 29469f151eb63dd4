"""One gear pair at constant commands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics.machine.columns import EVENTS, SAMPLES
from gear_dynamics.model.faults import Fault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.run import Run
from gear_dynamics.simulation.simulator import Simulator

_BLOCK = 1 << 16


def simulate(
    pair: GearPair,
    duration: float = 1.0,
    sample_rate: float = 51200.0,
    speed: float = 104.72,
    load_torque: float = 150.0,
    *,
    faults: Sequence[Fault] = (),
    anti_alias: bool = True,
    rtol: float = 1e-6,
    atol: float = 1e-9,
) -> Run:
    """Run a gear pair at constant commands, from the static deflection under them.

    Parameters
    ----------
    pair : GearPair
    duration : float
        Model time [s].
    sample_rate : float
        Samples per second [Hz].
    speed : float
        Pinion speed [rad/s].
    load_torque : float
        On the gear [N m].
    faults : sequence of Fault
        What is wrong with the machine, such as gd.faults.RootCrack('pinion', tooth=5).
    anti_alias : bool
        Whether the samples are band-limited, as those of the node are; False gives raw values.
    rtol, atol : float
        Tolerances of the integrator.

    Returns
    -------
    Run
        With round(duration * sample_rate) samples.

    Raises
    ------
    ParameterError
        If an argument is out of its range, or a fault does not fit the pair.
    IntegrationError
        If the integrator cannot go on.

    Examples
    --------
    >>> run = simulate(GearPair(), duration=0.1)
    >>> len(run)
    5120
    >>> bool(abs(run['mesh_force'].mean() - 150 / 0.055442) < 20)  # the torque over the base radius
    True
    """
    simulator = Simulator(
        pair,
        faults=faults,
        sample_rate=sample_rate,
        speed=speed,
        load_torque=load_torque,
        anti_alias=anti_alias,
        rtol=rtol,
        atol=atol,
    )
    count = simulator.settings.sample_count(duration, SAMPLES.itemsize)
    samples = np.empty(count, SAMPLES)
    events = [np.zeros(0, EVENTS)]
    for begin in range(0, count, _BLOCK):
        end = min(begin + _BLOCK, count)
        samples[begin:end] = simulator.advance(end - begin)
        events.append(simulator.take_events())
    return Run(
        samples, np.concatenate(events), simulator.pair, simulator.settings, simulator.faults
    )
