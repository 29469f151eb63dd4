"""The names of all indicators that `condition` can hold."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from gear_dynamics.machine.columns import CHANNELS

_STATISTICS = ('mean', 'rms', 'std', 'peak', 'crest_factor', 'kurtosis', 'skewness')
_ENVELOPE = tuple(
    f'envelope_{name}' for name in ('low', 'high', 'band_kurtosis', 'frequency', 'amplitude')
)
_OF_AVERAGE = (
    *('fm0', 'fm4', 'm6a', 'm8a', 'na4', 'nb4', 'energy_ratio'),
    *('sideband_index', 'sideband_level_factor'),
)
_OF_CHANNEL = (
    *_STATISTICS,
    *_ENVELOPE,
    *(f'{wheel}_{name}' for wheel in ('pinion', 'gear') for name in _OF_AVERAGE),
)
_CONTACT = ('out_of_contact', 'contact_losses_per_second', 'back_impacts_per_second')
_MOTION = (
    *('mesh_frequency', 'period', 'recurrence', 'zero_one_k'),
    *('lyapunov', 'lyapunov_uncertainty'),
)

INDICATORS = frozenset(
    f'{subject}/{name}'
    for subjects, names in (
        (CHANNELS, _OF_CHANNEL),
        (('contact',), _CONTACT),
        (('motion',), _MOTION),
    )
    for subject in subjects
    for name in names
)
"""Every SUBJECT/NAME."""


def check_names(names: Iterable[str]) -> None:
    """Check that every name is an indicator, or `*/NAME` for that of every subject.

    Raises
    ------
    ValueError
        If one is not; the message tells the nearest that is.
    """
    known = INDICATORS | {f'*/{each.split("/")[1]}' for each in INDICATORS}
    for name in names:
        if name not in known:
            nearest = difflib.get_close_matches(name, sorted(known), 1, 0)
            raise ValueError(f'{name!r} is no indicator: the nearest is {nearest[0]!r}')
