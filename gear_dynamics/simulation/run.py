"""The result of a simulation."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from gear_dynamics.model.faults import Fault
from gear_dynamics.model.faults.label import Label, labels
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.run_settings import RunSettings
from gear_dynamics.simulation.state import State


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Run:
    """Samples and events of a simulation, and what they were computed from.

    A run can be used as its array of samples: `run['mesh_force']` is a column, `run[100:200]` a
    part, `len(run)` the number of samples, `np.asarray(run)` the structured array.

    Parameters
    ----------
    samples : (n,) array of SAMPLES
        SI units; t is since the start of the first run.
    events : (m,) array of EVENTS
        Within the time of the samples, in order of time.
    pair : GearPair
    settings : RunSettings
        As they are at the end of the run.
    faults : tuple of Fault
        What was wrong with the machine.
    final_state : State
        For `simulate(..., initial_state=run.final_state)`, which goes on from there; None if the
        run was put together from samples.
    """

    samples: np.ndarray
    events: np.ndarray
    pair: GearPair
    settings: RunSettings
    faults: tuple[Fault, ...] = ()
    final_state: State | None = None

    @property
    def labels(self) -> tuple[Label, ...]:
        """What was wrong with the machine, and the orders at which it shows."""
        return labels(self.faults, self.pair)

    def __len__(self) -> int:
        return len(self.samples)

    def __getitem__(self, key: Any) -> Any:
        return self.samples[key]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        if copy:
            return np.array(self.samples, dtype)
        return np.asarray(self.samples, dtype)

    def __repr__(self) -> str:
        return (
            f'<Run: {len(self)} samples at {self.settings.sample_rate:g} Hz, '
            f'{len(self.events)} events, {self.settings.speed:g} rad/s, '
            f'{self.settings.load_torque:g} N m>'
        )
