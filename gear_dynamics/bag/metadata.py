"""What rosbag2 needs beside the messages of a bag: offered QoS profiles and metadata.yaml."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml

from gear_dynamics.portable import sync_folder
from gear_dynamics.wire.messages import message_type
from gear_dynamics.wire.topics import Qos

METADATA_FILE = 'metadata.yaml'

_FOREVER = {'sec': 9223372036, 'nsec': 854775807}
"""RMW_DURATION_INFINITE: no deadline, no lifespan, no lease."""


@dataclasses.dataclass(frozen=True)
class OfferedQos(Qos):
    """The quality of service with which a topic was published, as rosbag2 writes it."""

    def profile(self) -> dict[str, Any]:
        """Return the nine keys that rosbag2 needs, policies as words."""
        return {
            'history': self.history,
            'depth': self.depth,
            'reliability': self.reliability,
            'durability': self.durability,
            'deadline': dict(_FOREVER),
            'lifespan': dict(_FOREVER),
            'liveliness': 'automatic',
            'liveliness_lease_duration': dict(_FOREVER),
            'avoid_ros_namespace_conventions': False,
        }

    def text(self) -> str:
        """Return the YAML sequence that stands in a channel's `offered_qos_profiles`."""
        return yaml.safe_dump([self.profile()], sort_keys=False).strip()


@dataclasses.dataclass(frozen=True, eq=False)
class LoggedTopic:
    """A logged topic, as it stands in a channel of an MCAP file and in metadata.yaml.

    One object a topic: it is the key under which messages are counted, by identity for speed.

    Attributes
    ----------
    name, type_name : str
        Topic and message type; the type is empty where there is no schema.
    encoding : str
        Of the messages.
    schema_encoding, schema : str, bytes
        Definition of the type.
    metadata : dict of str to str
        Of the channel: `offered_qos_profiles` and `topic_type_hash`.
    profiles : list of dict
        The offered QoS profiles, policies as words.
    """

    name: str
    type_name: str
    encoding: str
    schema_encoding: str
    schema: bytes
    metadata: dict[str, str]
    profiles: list[dict[str, Any]]

    @property
    def latched(self) -> bool:
        """Whether its last message counts for those who come later."""
        return any(p['durability'] == 'transient_local' for p in self.profiles)


def published_topic(name: str, type_name: str, qos: OfferedQos) -> LoggedTopic:
    """Return a topic of a Jazzy type, by absolute name, and by how it is published.

    Raises
    ------
    MessageError
        If Jazzy has no such type.
    """
    kind = message_type(type_name)
    metadata = {'offered_qos_profiles': qos.text(), 'topic_type_hash': kind.hash}
    definition = kind.definition.encode()
    return LoggedTopic(name, type_name, 'cdr', 'ros2msg', definition, metadata, [qos.profile()])


@dataclasses.dataclass(frozen=True)
class FileSummary:
    """One finished file, as metadata.yaml lists it.

    Attributes
    ----------
    name : str
        File name without folder.
    start_time, end_time : int
        Log time of the first and of the last message [ns]; 0 in an empty file.
    size : int
        Bytes.
    counts : dict
        Messages of each `LoggedTopic`.
    """

    name: str
    start_time: int
    end_time: int
    size: int
    counts: dict[LoggedTopic, int]

    @property
    def messages(self) -> int:
        """Messages of all topics."""
        return sum(self.counts.values())


def bag_information(files: Iterable[FileSummary]) -> dict[str, Any]:
    """Return the content of `rosbag2_bagfile_information`, version 9, of files in order."""
    files = list(files)
    counts: dict[LoggedTopic, int] = {}
    for file in files:
        for topic, count in file.counts.items():
            counts[topic] = counts.get(topic, 0) + count
    filled = [file for file in files if file.messages]
    start = min((file.start_time for file in filled), default=0)
    end = max((file.end_time for file in filled), default=start)
    return {
        'version': 9,
        'storage_identifier': 'mcap',
        'duration': {'nanoseconds': end - start},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': sum(counts.values()),
        'topics_with_message_count': [
            {'topic_metadata': _topic_metadata(topic), 'message_count': count}
            for topic, count in counts.items()
        ],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file.name for file in files],
        'files': [
            {
                'path': file.name,
                'starting_time': {'nanoseconds_since_epoch': file.start_time},
                'duration': {'nanoseconds': file.end_time - file.start_time},
                'message_count': file.messages,
            }
            for file in files
        ],
        'custom_data': None,
        'ros_distro': 'jazzy',
    }


def _topic_metadata(topic: LoggedTopic) -> dict[str, Any]:
    return {
        'name': topic.name,
        'type': topic.type_name,
        'serialization_format': topic.encoding,
        'offered_qos_profiles': topic.profiles,
        'type_description_hash': topic.metadata.get('topic_type_hash', ''),
    }


def write_metadata(folder: Path, files: Iterable[FileSummary]) -> None:
    """Replace metadata.yaml of a bag folder atomically: a crash leaves the old or the new file."""
    content = {'rosbag2_bagfile_information': bag_information(files)}
    temporary = folder / (METADATA_FILE + '.tmp')
    with temporary.open('w', encoding='utf-8') as stream:
        yaml.safe_dump(content, stream, sort_keys=False, allow_unicode=True)
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(folder / METADATA_FILE)
    sync_folder(folder)
