"""One study of a name at a time in a folder: another would take its parts and its results away."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def alone(output: Path, study: str) -> Iterator[None]:
    """Hold the lock of a study in a folder.

    The lock is the system's and ends with the process, however that ends. The file that carries it
    may stay behind then, and hinders nobody.

    Parameters
    ----------
    output : Path
        Is made if need be.
    study : str
        Name.

    Raises
    ------
    ValueError
        If another process holds it.
    OSError
        If the folder cannot be written, or its file system has no locks.
    """
    # What is no folder is told by the file in it, as is a folder that cannot be written.
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
        # While it is held: no other can be removed.
        path.unlink(missing_ok=True)
        os.close(descriptor)


def _locked(path: Path) -> int | None:
    """Return the descriptor of the file with the lock, or None if another has it."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(descriptor, path):
                return descriptor
        except BlockingIOError:
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
