"""Running the independent parts of a study: here or on a cluster, and on from where it stopped."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gear_dynamics.study.cluster import connect, map_on_cluster

Arrays = dict[str, np.ndarray]
Task = Callable[..., Arrays]


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
    """

    def __init__(
        self, parts: Path | None = None, cluster: str | None = None, progress: bool = False
    ) -> None:
        self._parts, self._progress = parts, progress
        self._client = connect(cluster) if cluster else None
        if parts is not None:
            parts.mkdir(parents=True, exist_ok=True)

    def run(self, task: Task, arguments: Sequence[dict[str, Any]], label: str = '') -> list[Arrays]:
        """Return the results of a task for each set of arguments, in their order.

        There is a progress bar if there is a label.
        """
        bar = self._bar(len(arguments) if label else 0, label)
        results: list[Arrays | None] = [self._kept(task, each) for each in arguments]
        missing = [i for i, result in enumerate(results) if result is None]
        bar.update(len(arguments) - len(missing))
        for i, result in self._compute(task, arguments, missing):
            results[i] = result
            self._keep(task, arguments[i], result)
            bar.update()
        bar.close()
        return [result for result in results if result is not None]

    def track(self, items: Sequence[Any], label: str) -> Iterator[Any]:
        """Yield things one after the other, with a progress bar."""
        bar = self._bar(len(items), label)
        for item in items:
            yield item
            bar.update()
        bar.close()

    def forget(self) -> None:
        """Remove the parts: the study is whole and written."""
        if self._parts is not None:
            shutil.rmtree(self._parts, ignore_errors=True)

    def close(self) -> None:
        """Leave the cluster."""
        if self._client is not None:
            self._client.close()

    def _compute(
        self, task: Task, arguments: Sequence[dict[str, Any]], missing: Sequence[int]
    ) -> Iterator[tuple[int, Arrays]]:
        if self._client is not None:
            yield from map_on_cluster(self._client, task, arguments, missing)
            return
        for i in missing:
            yield i, task(**arguments[i])

    def _bar(self, total: int, label: str) -> Any:
        from tqdm import tqdm

        return tqdm(total=total, desc=label, disable=not (self._progress and total))

    def _file(self, task: Task, arguments: dict[str, Any]) -> Path:
        assert self._parts is not None
        return self._parts / f'{task.__name__}_{fingerprint(arguments)}.npz'

    def _kept(self, task: Task, arguments: dict[str, Any]) -> Arrays | None:
        if self._parts is None:
            return None
        path = self._file(task, arguments)
        if not path.exists():
            return None
        with np.load(path) as stored:
            return dict(stored)

    def _keep(self, task: Task, arguments: dict[str, Any], result: Arrays) -> None:
        if self._parts is None:
            return
        path = self._file(task, arguments)
        # A part is whole or not there at all, whenever the study is stopped.
        unfinished = path.with_suffix('.unfinished')
        with unfinished.open('wb') as file:
            arrays: dict[str, Any] = result
            np.savez(file, **arrays)
        os.replace(unfinished, path)


def fingerprint(value: Any) -> str:
    """Return a name for arguments: equal for equal ones, and different for different ones."""
    digest = hashlib.sha256()
    for piece in _pieces(value):
        digest.update(piece)
        digest.update(b'\0')
    return digest.hexdigest()[:24]


def _pieces(value: Any) -> Iterable[bytes]:
    yield type(value).__name__.encode()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for field in dataclasses.fields(value):
            yield from _pieces((field.name, getattr(value, field.name)))
    elif isinstance(value, dict):
        for key, each in sorted(value.items()):
            yield from _pieces((key, each))
    elif isinstance(value, list | tuple):
        for each in value:
            yield from _pieces(each)
    elif isinstance(value, np.ndarray):
        yield f'{value.dtype.str} {value.shape}'.encode()
        yield np.ascontiguousarray(value).tobytes()
    else:
        yield repr(value).encode()


def chunks(count: int, size: int) -> list[slice]:
    """Return slices of at most `size` that cover `count` things.

    They do not depend on the machine, so that a study can go on elsewhere.
    """
    return [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]
