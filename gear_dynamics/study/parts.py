"""The results of a study's finished tasks on disk, from which a stopped study goes on."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
import io
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from gear_dynamics.digest import code_digest
from gear_dynamics.versions import versions

Arrays = dict[str, np.ndarray]
Task = Callable[..., Arrays]

_DIGEST = 32


class Parts:
    """Keeps the result of each task in a file of its own.

    The file's name tells the code and the arguments, so that a result of other code is never
    taken for one of this. Its content begins with a digest of the rest: a file that was damaged
    or cut short counts as missing, and the others hold.

    Parameters
    ----------
    directory : Path
        Is made if need be.

    Raises
    ------
    OSError
        If it cannot be made.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._code = fingerprint(code())
        self._used: set[Path] = set()
        directory.mkdir(parents=True, exist_ok=True)

    def read(self, task: Task, arguments: dict[str, Any]) -> Arrays | None:
        """Return the result of a task if it was kept."""
        path = self._file(task, arguments)
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            return None
        digest, packed = content[:_DIGEST], content[_DIGEST:]
        if hashlib.sha256(packed).digest() != digest:
            return None
        self._used.add(path)
        with np.load(io.BytesIO(packed)) as stored:
            return dict(stored)

    def write(self, task: Task, arguments: dict[str, Any], result: Arrays) -> None:
        """Keep the result of a task; it is there as a whole or not at all."""
        path = self._file(task, arguments)
        packed = io.BytesIO()
        arrays: dict[str, Any] = result
        np.savez(packed, **arrays)
        content = packed.getvalue()
        unfinished = path.with_suffix('.unfinished')
        self._used.add(path)
        try:
            unfinished.write_bytes(hashlib.sha256(content).digest() + content)
            os.replace(unfinished, path)
        finally:
            unfinished.unlink(missing_ok=True)

    def forget(self) -> None:
        """Remove what this study kept, and what older code left behind.

        What other arguments left stays: the study that it belongs to may still go on.
        """
        kept = set(self._directory.glob(f'*_{self._code}_*.part'))
        others = set(self._directory.iterdir()) - kept
        for path in self._used | others:
            path.unlink(missing_ok=True)
        if not any(self._directory.iterdir()):
            self._directory.rmdir()

    def close(self) -> None:
        """Remove the directory if nothing is kept in it."""
        with contextlib.suppress(OSError):
            self._directory.rmdir()

    def _file(self, task: Task, arguments: dict[str, Any]) -> Path:
        name = f'{task.__name__}_{self._code}_{fingerprint(arguments)}.part'
        return self._directory / name


@functools.cache
def code() -> dict[str, str]:
    """Return what decides results beside arguments: versions, and a digest of the sources."""
    return {**versions(), 'sources': code_digest()}


def fingerprint(value: Any) -> str:
    """Return a name for a value: equal for equal ones, and different for different ones."""
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
