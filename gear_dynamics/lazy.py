"""Names of a package that are imported when they are first used."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any


def load(package: str, homes: Mapping[str, str], name: str) -> Any:
    """Return what a package exports under a name; the `__getattr__` of the package calls this.

    Parameters
    ----------
    package : str
        Full name of the package.
    homes : mapping of str to str
        The module of each exported name, relative to the package.
    name : str

    Raises
    ------
    AttributeError
        If the package exports no such name.
    """
    if name not in homes:
        raise AttributeError(f'module {package!r} has no attribute {name!r}')
    return getattr(importlib.import_module(f'{package}.{homes[name]}'), name)
