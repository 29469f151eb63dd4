"""Compiling what the studies run, before the first of their tasks."""

from __future__ import annotations

from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.model.nearby import nearby_growth
from gear_dynamics.study.initial import first_variations
from gear_dynamics.study.operation import default_operation


def warm_up() -> None:
    """Run all kernels of the studies once, for one mesh cycle."""
    operation = default_operation()
    run = ([operation.pair], operation.speed, operation.load_torque, 1)
    states = run_cycles(*run, vectors=first_variations(1)).states
    run_cycles(*run, states=states)
    nearby_growth(*run, states)
