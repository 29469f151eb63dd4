"""Libraries for formats that not everybody needs."""

from __future__ import annotations

import importlib
from typing import Any

from gear_dynamics.recordings.table import RecordingError


def optional_module(module: str, package: str, purpose: str) -> Any:
    """Import a module of an optional package.

    Raises
    ------
    RecordingError
        If the package is not installed; the message says how to get it.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        raise RecordingError(f'{purpose} needs {package}: pip install {package}') from None
