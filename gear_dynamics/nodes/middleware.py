"""The Fast DDS profile that keeps one dead listener from starving the others."""

from __future__ import annotations

import os

from gear_dynamics.config_files import config_file

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
