"""The cache of a study: results of finished tasks, and the lock of the folder they are in."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
import io
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from gear_dynamics.digest import code_digest
from gear_dynamics.study.outcome import Arrays
from gear_dynamics.versions import versions

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

Task = Callable[..., Arrays]

_DIGEST = 32


class TaskCache:
    """Keeps the result of each task in a file of its own.

    The file's name is a digest of the code and the arguments, so that results of other code are
    never used. The content begins with a digest of the rest: a damaged or incomplete file counts as
    missing.

    Parameters
    ----------
    directory : Path
        Created if it does not exist.

    Raises
    ------
    OSError
        If it cannot be created.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._code = fingerprint(code())
        self._used: set[Path] = set()
        directory.mkdir(parents=True, exist_ok=True)

    def read(self, task: Task, arguments: dict[str, Any]) -> Arrays | None:
        """Return the result of a task, or None if it is not stored."""
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
        """Write the result of a task, completely or not at all."""
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
        """Remove the results of this study, and those of older code.

        Results for other arguments stay: their study may still be resumed.
        """
        kept = set(self._directory.glob(f'*_{self._code}_*.part'))
        others = set(self._directory.iterdir()) - kept
        for path in self._used | others:
            path.unlink(missing_ok=True)
        if not any(self._directory.iterdir()):
            self._directory.rmdir()

    def close(self) -> None:
        """Remove the directory if it is empty."""
        with contextlib.suppress(OSError):
            self._directory.rmdir()

    def _file(self, task: Task, arguments: dict[str, Any]) -> Path:
        name = f'{task.__name__}_{self._code}_{fingerprint(arguments)}.part'
        return self._directory / name


@functools.cache
def code() -> dict[str, str]:
    """Return what determines results beside arguments: versions and a digest of the sources."""
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


@contextlib.contextmanager
def alone(output: Path, study: str) -> Iterator[None]:
    """Hold the lock of a study in a folder.

    Two runs of one study in one folder would delete each other's files. The lock belongs to the
    operating system and ends with the process. A lock file that is left behind locks nothing.

    Parameters
    ----------
    output : Path
        Created if it does not exist.
    study : str
        Name.

    Raises
    ------
    ValueError
        If another process holds it.
    OSError
        If the folder cannot be written, or its file system has no locks.
    """
    # Opening the lock file reports a path that is no folder, or cannot be written.
    with contextlib.suppress(FileExistsError):
        output.mkdir(parents=True)
    path = output / f'.{study}_lock'
    descriptor = _locked(path)
    if descriptor is None:
        raise ValueError(
            f'{output}: another study {study} is at work there: wait for its end, or name another '
            'directory with --output'
        )
    try:
        yield
    finally:
        # While the lock is held, so that no other process's file is removed. Windows cannot.
        with contextlib.suppress(PermissionError):
            path.unlink(missing_ok=True)
        os.close(descriptor)


def _locked(path: Path) -> int | None:
    """Return the descriptor of the file with the lock, or None if another has it."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _lock(descriptor)
            if _is_at(descriptor, path):
                return descriptor
        except (BlockingIOError, PermissionError):
            os.close(descriptor)
            return None
        except BaseException:
            os.close(descriptor)
            raise
        # Who had it has removed the file since it was opened.
        os.close(descriptor)


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path))
    except FileNotFoundError:
        return False


def _lock(descriptor: int) -> None:
    """Lock an open file at once, or raise.

    The package filelock would do the same, but rosdep has no key for it.
    """
    if fcntl is None:
        import msvcrt

        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
    else:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
