"""A sound log out of a cut or damaged one."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from gear_dynamics.bag.bag_writer import BagWriter
from gear_dynamics.bag.channel import Damage, LogChannel, LogError
from gear_dynamics.bag.log import Log, LogPath
from gear_dynamics.bag.metadata import LoggedTopic
from gear_dynamics.bag.qos import in_words, read_profiles


@dataclasses.dataclass(frozen=True)
class Recovery:
    """The result of a recovery.

    Attributes
    ----------
    folder : Path
        The sound bag folder.
    messages : int
        Messages in it.
    damage : tuple of Damage
        Where the log was damaged.
    """

    folder: Path
    messages: int
    damage: tuple[Damage, ...]

    @property
    def lost(self) -> tuple[Damage, ...]:
        """The places at which messages may have been lost."""
        return tuple(damage for damage in self.damage if damage.loss)


def recover(path: LogPath, folder: Path, compression: str = 'zstd') -> Recovery:
    """Copy all messages that can be read into a new bag folder, in the order of the files.

    Bytes, times and sequence numbers of the messages, schemas and what is said of the channels
    are copied as they are. QoS policies as numbers become words, as the metadata of Jazzy needs
    them.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files; they are left as they are.
    folder : Path
        Where the sound log goes; must not exist.
    compression : str
        'none', 'lz4' or 'zstd'.

    Raises
    ------
    LogError
        If there is no such log, the folder exists, or nothing can be saved.
    OSError
        If the disk is full or the folder cannot be made.
    """
    found: list[Damage] = []
    with Log(path, found.append) as log:
        if next(log.messages_as_written(), None) is None:
            raise LogError('there is no message that can be saved')
        profile = next((s.profile for s in log.sources if s.profile is not None), 'ros2')
        try:
            bag = BagWriter(folder, compression, profile)
        except FileExistsError:
            raise LogError(f'{folder} exists: choose another folder') from None
        for source in log.sources:
            for record in source.configurations():
                bag.configure(record, int(record['log_time']))
        topics: dict[LogChannel, LoggedTopic] = {}
        for _, message in log.messages_as_written():
            topic = topics.get(message.channel)
            if topic is None:
                topic = topics[message.channel] = _topic(message.channel)
            data = bytes(message.data)
            bag.write(topic, data, message.log_time, message.publish_time, message.sequence)
        bag.finish()
        return Recovery(folder, bag.messages, tuple(found))


def _topic(channel: LogChannel) -> LoggedTopic:
    metadata = dict(channel.metadata)
    if channel.qos:
        metadata['offered_qos_profiles'] = in_words(channel.qos)
    return LoggedTopic(
        name=channel.topic,
        type_name=channel.type_name,
        encoding=channel.encoding,
        schema_encoding=channel.schema_encoding,
        schema=channel.schema,
        metadata=metadata,
        profiles=read_profiles(channel.qos),
    )
