"""Compiling what the studies run, before the first of their tasks."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

from gear_dynamics import dynamics
from gear_dynamics.study.operating_point import default_operating_point
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
    point = default_operating_point()
    run = ([point.pair], point.speed, point.load_torque, 1)
    states = dynamics.run_cycles(*run, vectors=dynamics.first_tangent_vectors(1)).states
    dynamics.run_cycles(*run, states=states)
    dynamics.nearby_growth(*run, states)
