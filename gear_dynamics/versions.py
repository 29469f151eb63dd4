"""The versions of what bears upon results."""

from __future__ import annotations

import importlib.metadata
import platform
import re
from pathlib import Path

PACKAGES = ('numpy', 'scipy', 'numba')
"""Packages whose versions bear upon the numbers that a run gives."""


def versions() -> dict[str, str]:
    """Return the versions of Python, of this package and of PACKAGES by name."""
    return {
        'python': platform.python_version(),
        'gear_dynamics': __version__,
        **{name: importlib.metadata.version(name) for name in PACKAGES},
    }


def _version() -> str:
    manifest = Path(__file__).resolve().parents[1] / 'package.xml'
    if manifest.is_file():  # run from the source tree, whatever is installed
        found = re.search(r'<version>(.*?)</version>', manifest.read_text(encoding='utf-8'))
        if found:
            return found[1].strip()
    return importlib.metadata.version('gear_dynamics')


__version__ = _version()
