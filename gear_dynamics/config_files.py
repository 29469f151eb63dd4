"""The files that come with the package, wherever it is installed."""

from __future__ import annotations

from pathlib import Path


def config_file(name: str) -> Path | None:
    """Return the path of a file of config/, in the source tree or under the install prefix."""
    root = Path(__file__).resolve().parents[1]
    candidates = [root / 'config' / name]
    candidates += [above / 'share' / 'gear_dynamics' / 'config' / name for above in root.parents]
    return next((path for path in candidates if path.is_file()), None)
