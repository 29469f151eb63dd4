"""Compiling what the studies run, before the first of their tasks."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.dynamics.nearby import nearby_growth
from gear_dynamics.study.initial import first_variations
from gear_dynamics.study.operation import default_operation
from gear_dynamics.study.tasks import Runner


class CompilingRunner(Runner):
    """A runner that compiles when the first tasks come: then a study has accepted its arguments.

    Parameters
    ----------
    compile_ : callable, optional
        Compiles what the tasks run.
    parts, cluster, progress
        As of Runner.
    """

    def __init__(
        self,
        compile_: Callable[[], None] | None,
        parts: Path | None,
        cluster: str | None = None,
        progress: bool = False,
    ) -> None:
        super().__init__(parts, cluster, progress)
        self._compile = compile_

    @contextlib.contextmanager
    def progress(self, count: int, label: str) -> Iterator[None]:
        """Show one progress bar for the tasks that are run within, once all is compiled."""
        if self._compile is not None:
            self._compile()
            self._compile = None
        with super().progress(count, label):
            yield


def warm_up() -> None:
    """Run all kernels of the studies once, for one mesh cycle."""
    operation = default_operation()
    run = ([operation.pair], operation.speed, operation.load_torque, 1)
    states = run_cycles(*run, vectors=first_variations(1)).states
    run_cycles(*run, states=states)
    nearby_growth(*run, states)
