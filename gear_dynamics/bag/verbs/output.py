"""Where the verbs put what they make, unless told otherwise."""

from __future__ import annotations

from pathlib import Path


def beside(log: str, ending: str) -> Path:
    """Return a path beside a log, named after it."""
    path = Path(log).resolve()
    return path.with_name(path.name.removesuffix('.mcap') + ending)
