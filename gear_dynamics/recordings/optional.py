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
        If the package is not installed, or does not fit the others; the message says what to do.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        raise RecordingError(f'{purpose} needs {package}: pip install {package}') from None
    except ImportError as error:
        reason = ' '.join(str(error).split())
        raise RecordingError(f'{purpose} needs {package}, which cannot start: {reason}') from None
