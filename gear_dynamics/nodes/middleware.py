"""The Fast DDS profile that keeps one dead listener from starving the others."""

from __future__ import annotations

import os
from pathlib import Path

_VARIABLE = 'FASTRTPS_DEFAULT_PROFILES_FILE'


def use_profile() -> None:
    """Have Fast DDS read config/fastdds.xml, unless the user chose a profile.

    It gives a publisher a shared-memory segment large enough that blocks held for a listener that
    died or stopped do not push out those for the listeners that live.
    """
    chosen = os.environ.get(_VARIABLE) or os.environ.get('FASTDDS_DEFAULT_PROFILES_FILE')
    profile = config_file('fastdds.xml')
    if not chosen and profile is not None:
        os.environ[_VARIABLE] = str(profile)


def config_file(name: str) -> Path | None:
    """Return the path of a file of config/, in the source tree or under the install prefix."""
    root = Path(__file__).resolve().parents[2]
    candidates = [root / 'config' / name]
    candidates += [above / 'share' / 'gear_dynamics' / 'config' / name for above in root.parents]
    return next((path for path in candidates if path.is_file()), None)
