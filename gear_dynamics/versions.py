"""The versions of what bears upon results."""

from __future__ import annotations

import importlib.metadata
import platform

PACKAGES = ('gear_dynamics', 'numpy', 'scipy', 'numba')
"""Packages whose versions bear upon the numbers that a run gives."""


def versions() -> dict[str, str]:
    """Return the versions of Python and of PACKAGES by name."""
    return {'python': platform.python_version(), **{name: _version(name) for name in PACKAGES}}


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return 'not installed'  # run from the source tree
