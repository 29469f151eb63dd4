"""What the next samples of a simulator depend on."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    COORDINATES,
    PSI,
    STATE_Q_SUM,
    VELOCITY,
)
from gear_dynamics.integrator.motion import Motion, copy_of, place_all_contacts, time_of
from gear_dynamics.integrator.series import advance_state
from gear_dynamics.integrator.tables import Fade
from gear_dynamics.model.faults import Fault, SpeedAndLoad
from gear_dynamics.model.faults.collection import machine_ports
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports
from gear_dynamics.model.system import system
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.run_settings import RunSettings


def model_ports(
    pair: GearPair, settings: RunSettings, ports: Ports, faults: Sequence[Fault] = ()
) -> Ports:
    """Return all ports of a machine: of its mesh, friction and faults, and those given."""
    commanded = SpeedAndLoad(settings.speed, settings.load_torque)
    return machine_ports(pair, faults, commanded) + ports


@kernel
def _advance(records, tau):
    advance_state(records[0], tau)


@dataclasses.dataclass(frozen=True, eq=False)
class State:
    """A simulator at one instant: give it to `Simulator.set_state`.

    Attributes
    ----------
    pair, settings, ports, faults, drive : as of the Simulator
    samples_done : int
        Samples that were handed out.
    motion, fade, held_events, filters
        Of the integrator, which may be ahead of the samples, and of the band limit.
    """

    pair: GearPair
    settings: RunSettings
    ports: Ports
    faults: tuple[Fault, ...]
    drive: bool
    samples_done: int
    motion: Motion
    fade: Fade
    held_events: tuple[np.ndarray, ...]
    filters: tuple

    def coordinates(self) -> np.ndarray:
        """Return x1, y1, x2, y2, th1, th2, their rates, and the integral of q at the last sample.

        (13,) [m, rad, per s]. The samples must be raw: band-limited ones are behind the motion.

        Raises
        ------
        ParameterError
            If the samples are band-limited.
        """
        if self.filters:
            raise ParameterError('anti_alias is True: the coordinates are those of raw samples')
        motion = copy_of(self.motion)
        record = motion.records[0]
        tau = time_of(record, int(record['sampling']['sample']) - 1)
        if record['step']['length'] >= 0:
            _advance(motion.records, tau)
        y = record['state'].copy()
        turn = system(self.pair).angles
        for begin in (PSI, VELOCITY + PSI):
            y[begin : begin + 2] = turn @ y[begin : begin + 2]
        return y

    def at(self, coordinates: np.ndarray) -> State:
        """Return the state at the start of a run with other coordinates, (13,) as above.

        Raises
        ------
        ParameterError
            If the run is past its start.
        """
        motion = copy_of(self.motion)
        record = motion.records[0]
        if self.samples_done or record['counts']['steps'] or record['step']['length'] >= 0:
            raise ParameterError('only a run at its start can be given other coordinates')
        y = np.array(coordinates, float)
        turn = np.linalg.inv(system(self.pair).angles)
        for begin in (PSI, VELOCITY + PSI):
            y[begin : begin + 2] = turn @ y[begin : begin + 2]
        record['state'][: 2 * COORDINATES + 1] = y[: STATE_Q_SUM + 1]
        place_all_contacts(motion.records)
        return dataclasses.replace(self, motion=motion)


def checked_state(name: str, state: Any) -> State:
    """Return what must be a state.

    Raises
    ------
    ParameterError
        If it is anything else.
    """
    if not isinstance(state, State):
        raise ParameterError(
            f'{name} is {state!r}: it must be the final_state of a run, or the state() of a '
            'Simulator'
        )
    return state
