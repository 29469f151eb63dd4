"""Offered QoS profiles as logs have them: as words since Jazzy, as numbers before."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml

from gear_dynamics.bag.metadata import OfferedQos
from gear_dynamics.parameters.yaml_text import YamlError, parse_yaml

_WORDS: dict[str, dict[int, str]] = {
    'history': {0: 'system_default', 1: 'keep_last', 2: 'keep_all', 3: 'unknown'},
    'reliability': {
        0: 'system_default',
        1: 'reliable',
        2: 'best_effort',
        3: 'unknown',
        4: 'best_available',
    },
    'durability': {
        0: 'system_default',
        1: 'transient_local',
        2: 'volatile',
        3: 'unknown',
        4: 'best_available',
    },
    'liveliness': {
        0: 'system_default',
        1: 'automatic',
        2: 'manual_by_node',
        3: 'manual_by_topic',
        4: 'unknown',
        5: 'best_available',
    },
}
"""Policies by their numbers in rmw/types.h."""

_DURATIONS = ('deadline', 'lifespan', 'liveliness_lease_duration')
_INT64 = range(1 << 63)


def read_profiles(text: str) -> list[dict[str, Any]]:
    """Return the profiles in a channel's `offered_qos_profiles`, complete and as words.

    Parameters
    ----------
    text : str
        YAML sequence as rosbag2 of any version writes it; no profiles if it is none.
    """
    try:
        content = parse_yaml(text)
    except YamlError:
        return []
    profiles = content if isinstance(content, list) else []
    return [_complete(profile) for profile in profiles if isinstance(profile, Mapping)]


def first_profile(text: str) -> OfferedQos:
    """Return the first of the profiles, the default where there is none."""
    for profile in read_profiles(text):
        return OfferedQos(
            depth=profile['depth'],
            reliability=profile['reliability'],
            durability=profile['durability'],
            history=profile['history'],
        )
    return OfferedQos()


def in_words(text: str) -> str:
    """Return a YAML sequence of profiles as Jazzy writes it; unchanged if it is of Jazzy."""
    profiles = read_profiles(text)
    try:
        written = parse_yaml(text) if profiles else None
    except YamlError:
        written = None
    if written is None or written == profiles:
        return text
    return yaml.safe_dump(profiles, sort_keys=False).strip()


def _complete(profile: Mapping[Any, Any]) -> dict[str, Any]:
    """Return all nine keys, with defaults for what is missing or makes no sense."""
    complete = OfferedQos().profile()
    for key, words in _WORDS.items():
        value = profile.get(key)
        if isinstance(value, int):
            value = words.get(value)
        if value in words.values():
            complete[key] = value
    if _is_count(profile.get('depth')):
        complete['depth'] = profile['depth']
    for key in _DURATIONS:
        value = profile.get(key)
        if isinstance(value, Mapping) and all(_is_count(value.get(k)) for k in ('sec', 'nsec')):
            complete[key] = {'sec': value['sec'], 'nsec': value['nsec']}
    value = profile.get('avoid_ros_namespace_conventions')
    if isinstance(value, bool):
        complete['avoid_ros_namespace_conventions'] = value
    return complete


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value in _INT64
