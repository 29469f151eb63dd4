"""Running the independent parts of a study: here or on a cluster, and on from where it stopped."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from gear_dynamics.study.cache import Task, TaskCache
from gear_dynamics.study.cluster import Cluster
from gear_dynamics.study.outcome import Arrays


class Runner:
    """Runs tasks and keeps what they return.

    A task is a function at the top of a module with plain arguments; it returns a mapping of
    arrays that depends on nothing but these, so that it is the same wherever it ran.

    Parameters
    ----------
    parts : Path, optional
        Directory in which the result of each task is kept as soon as it is there. A task whose
        result is found there is not run again. Without it nothing is kept.
    cluster : str, optional
        Address of a Dask scheduler, or `local` to start one on this machine. Without it tasks run
        here, one after the other, each over all cores.
    progress : bool
        Show a progress bar with the time left.

    Attributes
    ----------
    computed, taken : int
        How many tasks were run, and how many results were found.
    """

    def __init__(
        self, parts: Path | None = None, cluster: str | None = None, progress: bool = False
    ) -> None:
        self.computed = self.taken = 0
        self._progress = progress
        self._bar: Any = None
        self._parts = None if parts is None else TaskCache(parts)
        self._cluster: Cluster | None = None
        try:
            if cluster is not None:
                self._cluster = Cluster(cluster)
        except BaseException:
            self.close()
            raise

    @property
    def at_once(self) -> bool:
        """Whether tasks run at once, each on a core of a cluster: then they are best cut small.

        Here one at a time has all cores, and should hold motions for all of them.
        """
        return self._cluster is not None

    def run(self, task: Task, arguments: Sequence[dict[str, Any]], label: str = '') -> list[Arrays]:
        """Return the results of a task for each set of arguments, in their order.

        With a label there is a progress bar, if none is shown yet by `progress`.
        """
        if label and self._bar is None:
            with self.progress(len(arguments), label):
                return self.run(task, arguments)
        if self._bar is not None:
            # Some tasks follow from the results of others, and are not counted before.
            self._bar.total = max(self._bar.total, self._bar.n + len(arguments))
        results = [self._kept(task, each) for each in arguments]
        missing = [i for i, result in enumerate(results) if result is None]
        self._skip(len(arguments) - len(missing))
        for i, result in self._compute(task, arguments, missing):
            results[i] = result
            if self._parts is not None:
                self._parts.write(task, arguments[i], result)
            self.computed += 1
            if self._bar is not None:
                self._bar.update()
        return [result for result in results if result is not None]

    @contextlib.contextmanager
    def progress(self, count: int, label: str) -> Iterator[None]:
        """Show one progress bar for the tasks that are run within, `count` in all."""
        from tqdm import tqdm

        with tqdm(total=count, desc=label, disable=not self._progress) as self._bar:
            try:
                yield
            finally:
                self._bar = None

    def forget(self) -> None:
        """Remove what was kept: the study is whole and written."""
        if self._parts is not None:
            self._parts.forget()

    def close(self) -> None:
        """Leave the cluster, and no empty directory."""
        if self._cluster is not None:
            self._cluster.close()
        if self._parts is not None:
            self._parts.close()

    def _skip(self, taken: int) -> None:
        """Count what was there before; it says nothing of the time left."""
        self.taken += taken
        if self._bar is not None and not self._bar.disable:
            self._bar.initial += taken
            self._bar.last_print_n += taken
            self._bar.n += taken
            self._bar.refresh()

    def _kept(self, task: Task, arguments: dict[str, Any]) -> Arrays | None:
        return None if self._parts is None else self._parts.read(task, arguments)

    def _compute(
        self, task: Task, arguments: Sequence[dict[str, Any]], missing: Sequence[int]
    ) -> Iterator[tuple[int, Arrays]]:
        if self._cluster is not None:
            yield from self._cluster.map(task, arguments, missing)
            return
        for i in missing:
            yield i, task(**arguments[i])


def chunks(count: int, size: int) -> list[slice]:
    """Return slices of at most `size` that cover `count` things.

    They do not depend on how many cores or workers there are, so that a study can go on elsewhere.
    """
    return [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]
