"""How functions are compiled, and where compiled ones are kept from one start to the next.

Numba's own cache looks at one file: a function that calls an edited function of another file would
run with the old one in it. Here each module's kernels are kept in a folder that is named by a
digest of the module and of all that it imports, so that edited code is compiled.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import platform
import shutil
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
import numpy as np
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.misc.appdirs import AppDirs

from gear_dynamics.digest import ROOT, module_digest
from gear_dynamics.linking import Kernel, LinkedCacheImpl

KEPT = 30 * 86400.0
"""Time after which a folder of kernels that no start has used is removed [s]."""


def kernel(function: Callable | None = None, **options: Any) -> Any:
    """Compile a function when it is first called, and keep it on disk.

    A division by zero gives inf as in NumPy, which spares a test at each division. Never fastmath:
    chaotic runs must repeat to the last bit.

    Parameters
    ----------
    function : callable
    **options
        Of `numba.njit`, such as parallel=True.
    """
    if function is None:
        return functools.partial(kernel, **options)
    if numba.config.DISABLE_JIT:
        return _plain(function)
    compiled = Kernel(function, targetoptions={'nopython': True, 'error_model': 'numpy', **options})
    try:
        compiled._cache, compiled.linked._cache = _KernelCache(function), _LinkedCache(function)
    except RuntimeError:  # no folder can be written, or it is not of this package
        if Path(function.__code__.co_filename).resolve().is_relative_to(ROOT):
            _warn_of_no_folder()
    return compiled


def _plain(function: Callable) -> Callable:
    """Return a kernel as it runs where nothing is compiled: fields of records are attributes."""

    def attributed(value: Any) -> Any:
        if isinstance(value, np.ndarray) and value.dtype.names:
            return value.view(np.recarray)
        if isinstance(value, tuple) and hasattr(value, '_fields'):
            return type(value)(*map(attributed, value))
        return value

    @functools.wraps(function)
    def run(*arguments: Any) -> Any:
        return function(*map(attributed, arguments))

    return run


def cache_folder() -> Path:
    """Return the folder of all compiled kernels: of this user, or within NUMBA_CACHE_DIR."""
    if numba.config.CACHE_DIR:
        return Path(numba.config.CACHE_DIR) / ROOT.name
    return Path(AppDirs(ROOT.name, appauthor=False).user_cache_dir) / 'kernels'


class _Locator:
    """Tells Numba where the kernels of a module are kept; the names are Numba's."""

    def __init__(self, function: Callable, file: str) -> None:
        self._py_file = file  # Numba's warnings name it
        self._line = function.__code__.co_firstlineno
        self._folder = _folder(Path(file).resolve())

    @classmethod
    def from_function(cls, function: Callable, file: str) -> _Locator | None:
        with contextlib.suppress(OSError, ValueError):
            return cls(function, file)
        return None

    def ensure_cache_path(self) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> str:
        return self._folder.name

    def get_disambiguator(self) -> str:
        return str(self._line)


class _CacheImpl(CompileResultCacheImpl):
    _locator_classes = [_Locator]  # noqa: RUF012


class _LinkedCacheImpl(LinkedCacheImpl):
    _locator_classes = [_Locator]  # noqa: RUF012


class _KernelCache(FunctionCache):
    """Numba's cache of one function, in the folder above; what goes wrong there stops nobody."""

    _impl_class = _CacheImpl

    def load_overload(self, signature: Any, context: Any) -> Any:
        try:
            return super().load_overload(signature, context)
        except Exception:  # a damaged file may raise anything, and counts as missing
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        # A full disk costs the next start its time, and this one nothing.
        with contextlib.suppress(OSError):
            super().save_overload(signature, result)
            _remove_unused()


class _LinkedCache(_KernelCache):
    _impl_class = _LinkedCacheImpl


def _folder(file: Path) -> Path:
    """Return the folder for the kernels of a module as it is now.

    Raises
    ------
    ValueError
        If the file is not of the package.
    OSError
        If the folder cannot be made or written, or the sources cannot be read.
    """
    file.relative_to(ROOT)
    parts = [_digest(file, int(time.monotonic())), numba.__version__, llvmlite.__version__]
    parts += [platform.python_version(), platform.machine()]
    parts += [numba.config.CPU_NAME or _processor()]
    name = hashlib.sha256('\0'.join(parts).encode()).hexdigest()[:16]
    return _used(cache_folder() / f'{file.stem}-{name}')


@functools.lru_cache
def _digest(file: Path, second: int) -> str:
    """Return the digest of a module, looked up once a second: a module may have many kernels."""
    return module_digest(file)


@functools.cache
def _processor() -> str:
    return llvmlite.binding.get_host_cpu_name()


@functools.cache
def _used(folder: Path) -> Path:
    """Return a folder that can be written, and mark it as used today."""
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise PermissionError(f'{folder} cannot be written')
    with contextlib.suppress(PermissionError):  # of another user, in a folder that both write
        os.utime(folder)
    return folder


@functools.cache
def _remove_unused() -> None:
    """Remove the folders that no start has used for long; whose code they are is not asked."""
    oldest = time.time() - KEPT
    for folder in cache_folder().iterdir():
        with contextlib.suppress(FileNotFoundError):  # another process removes it too
            if folder.stat().st_mtime < oldest:
                shutil.rmtree(folder, ignore_errors=True)


@functools.cache
def _warn_of_no_folder() -> None:
    warnings.warn(
        f'{cache_folder()} cannot be written: every start compiles for half a minute; '
        'set NUMBA_CACHE_DIR to a folder of your own',
        RuntimeWarning,
        stacklevel=3,
    )
