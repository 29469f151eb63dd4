"""Where and how the topics of a log are published again; no ROS node is needed to decide it."""

from __future__ import annotations

import re
from collections.abc import Collection

from gear_dynamics.bag.channel import LogChannel
from gear_dynamics.bag.qos import first_profile
from gear_dynamics.wire.topics import DIAGNOSTICS, Qos

REPLAYED_DIAGNOSTICS = '~/diagnostics'
"""Where recorded diagnostics are played: on /diagnostics they would seem to be of live nodes."""

DEEPEST = 10_000
"""Longest history that is taken from a log."""

_RIG = re.compile(r'(|/.*)/gear_pair/.*')


def replayed_names(topics: Collection[str], namespace: str) -> dict[str, str]:
    """Return the name under which each recorded topic is published.

    Parameters
    ----------
    topics : collection of str
        Recorded names.
    namespace : str
        That of the node. '/' leaves names as they were recorded; any other takes the place of the
        namespace of the recorded rig.
    """
    rigs = {match[1] for match in map(_RIG.fullmatch, topics) if match}
    recorded = rigs.pop() if len(rigs) == 1 else ''
    names = {}
    for topic in topics:
        if topic == DIAGNOSTICS.name:
            names[topic] = REPLAYED_DIAGNOSTICS
        elif namespace == '/':
            names[topic] = topic
        else:
            below = topic[len(recorded) :] if topic.startswith(f'{recorded}/') else topic
            names[topic] = namespace + '/' + below.lstrip('/')
    return names


def recorded_qos(channel: LogChannel) -> Qos:
    """Return the QoS that a topic was published with, as far as it matters to a listener."""
    offered = first_profile(channel.qos)
    best_effort = offered.reliability == 'best_effort'
    latched = offered.durability == 'transient_local'
    return Qos(
        depth=max(1, min(offered.depth, DEEPEST)),
        reliability='best_effort' if best_effort else 'reliable',
        durability='transient_local' if latched else 'volatile',
    )
