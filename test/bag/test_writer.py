"""The log as independent readers see it, and its splits, limits and queue."""

import io
import itertools
import struct
import time

import bag_support
import numpy as np
import pytest
import yaml
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Chunk, MessageIndex
from mcap.stream_reader import get_chunk_data_stream
from mcap_ros2.decoder import DecoderFactory
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

import gear_dynamics.bag.folder
import gear_dynamics.bag.writer
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.reader import read_messages
from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.wire.messages import MessageError

NINE_KEYS = {
    'history',
    'depth',
    'reliability',
    'durability',
    'deadline',
    'lifespan',
    'liveliness',
    'liveliness_lease_duration',
    'avoid_ros_namespace_conventions',
}


@pytest.fixture(scope='module', params=['none', 'lz4', 'zstd'])
def bag(request, tmp_path_factory):
    published = bag_support.messages(60)
    directory = tmp_path_factory.mktemp(request.param)
    folder = bag_support.write_log(
        directory, published, compression=request.param, split_duration=0.04
    )
    return folder, bag_support.with_repeats(published, folder)


@pytest.mark.parametrize('single', [False, True])
def test_rosbags_reads_folder_and_file(bag, single):
    folder, published = bag
    files = bag_support.bag_files(folder)
    assert len(files) > 1
    store = get_typestore(Stores.ROS2_JAZZY)
    found = []
    for path in files if single else [folder]:
        with Reader(path) as reader:
            for connection in reader.connections:
                qos = connection.ext.offered_qos_profiles
                latched = connection.topic == '/gear_pair/configuration'
                durability = QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE
                assert [q.durability for q in qos] == [durability]
                assert qos[0].reliability == QosReliability.RELIABLE
                if not single:
                    assert connection.digest == store.hash_rihs01(connection.msgtype)
                    count = sum(m.topic == connection.topic for m in published)
                    assert connection.msgcount == count
            found += [
                (c.topic, c.msgtype, bytes(data), time) for c, time, data in reader.messages()
            ]
            if not single:
                assert reader.message_count == len(published)
                times = [m.log_time for m in published]
                assert reader.duration == max(times) - min(times) + 1
    assert sorted(found) == sorted((m.topic, m.type_name, m.data, m.log_time) for m in published)


def test_mcap_decodes_every_field_as_published(bag):
    folder, published = bag
    store = get_typestore(Stores.ROS2_JAZZY)
    found = []
    for path in bag_support.bag_files(folder):
        with path.open('rb') as stream:
            reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
            found += list(reader.iter_decoded_messages(log_time_order=False))
    assert len(found) == len(published)
    for read, message in zip(found, published, strict=True):
        assert read.schema.name == message.type_name
        assert read.channel.topic == message.topic
        assert read.message.log_time == message.log_time
        assert read.message.publish_time == message.publish_time
        same(read.decoded_message, store.deserialize_cdr(message.data, message.type_name))


def same(decoded, expected):
    """Compare messages of two libraries field by field."""
    if hasattr(expected, '__dataclass_fields__'):
        for name in expected.__dataclass_fields__:
            if name != '__msgtype__' and not name.isupper():  # constants are no fields
                same(getattr(decoded, name), getattr(expected, name))
    elif isinstance(expected, list):
        assert len(decoded) == len(expected)
        for one, other in zip(decoded, expected, strict=True):
            same(one, other)
    elif isinstance(expected, np.ndarray):
        assert bytes(decoded) == expected.tobytes()
    elif isinstance(expected, int) and isinstance(decoded, bytes):
        assert decoded == bytes([expected])
    else:
        assert decoded == expected


def test_files_are_what_rosbag2_expects(bag):
    folder, _ = bag
    for path in bag_support.bag_files(folder):
        with path.open('rb') as stream:
            reader = make_reader(stream)
            assert reader.get_header().profile == 'ros2'
            summary = reader.get_summary()
            records = {record.name: record.metadata for record in reader.iter_metadata()}
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            assert (channel.message_encoding, schema.encoding) == ('cdr', 'ros2msg')
            profiles = yaml.safe_load(channel.metadata['offered_qos_profiles'])
            assert [set(profile) for profile in profiles] == [NINE_KEYS]
            assert channel.metadata['topic_type_hash'].startswith('RIHS01_')
        for name in ('std_msgs/Header', 'sensor_msgs/PointField', 'builtin_interfaces/Time'):
            clouds = [s for s in summary.schemas.values() if s.name.endswith('PointCloud2')]
            assert all(f'MSG: {name}\n'.encode() in schema.data for schema in clouds)
        inner = yaml.safe_load(records['rosbag2']['serialized_metadata'])
        assert inner['version'] == 9
        assert inner['message_count'] == summary.statistics.message_count
        assert inner['relative_file_paths'] == [path.name]
        content = dict(records['gear_dynamics'])
        assert {key: content[key] for key in bag_support.CONFIGURATION} == (
            bag_support.CONFIGURATION
        )


def test_metadata_yaml_has_version_9_and_policies_as_words(bag):
    folder, published = bag
    content = yaml.safe_load((folder / 'metadata.yaml').read_text())
    information = content['rosbag2_bagfile_information']
    assert information['version'] == 9
    assert information['storage_identifier'] == 'mcap'
    assert information['ros_distro'] == 'jazzy'
    assert information['relative_file_paths'] == [
        path.name for path in bag_support.bag_files(folder)
    ]
    assert sum(file['message_count'] for file in information['files']) == len(published)
    for topic in information['topics_with_message_count']:
        profile = topic['topic_metadata']['offered_qos_profiles'][0]
        assert set(profile) == NINE_KEYS
        assert profile['history'] == 'keep_last'
        assert profile['liveliness_lease_duration'] == {'sec': 9223372036, 'nsec': 854775807}


def test_names_of_folder_and_files(bag):
    folder, _ = bag
    assert folder.name.startswith('gear_log_')
    for number, path in enumerate(bag_support.bag_files(folder)):
        assert path.name == f'{folder.name}_{number}.mcap'


def test_a_file_ends_after_its_duration(tmp_path):
    published = bag_support.messages(60)
    folder = bag_support.write_log(tmp_path, published, split_duration=0.02)
    spans = []
    for path in bag_support.bag_files(folder):
        with Reader(path) as reader:
            spans.append((reader.start_time, reader.end_time))
    for (begin, end), (start, _) in itertools.pairwise(spans):
        assert 20e6 <= end - begin < 20e6 + 2 * bag_support.STEP
        assert end <= start + 1


def test_a_file_ends_at_its_size_and_old_ones_go(tmp_path):
    published = bag_support.messages(4000)
    folder = bag_support.write_log(
        tmp_path, published, compression='none', split_size=2e6, total_cap=8e6
    )
    files = bag_support.bag_files(folder)
    sizes = [path.stat().st_size for path in files]
    # A file may be larger by the chunk that reached the limit and by its index.
    assert all(2e6 <= size < 2e6 + 1.2e6 + 2e5 for size in sizes[:-1])
    assert sum(sizes) <= 8e6 + 1.4e6
    numbers = [int(path.stem.rsplit('_', 1)[1]) for path in files]
    assert numbers[0] > 0
    assert numbers == list(range(numbers[0], numbers[-1] + 1))
    with Reader(folder) as reader:
        kept = [bytes(data) for _, _, data in reader.messages()]
    configuration = published[0].data
    assert kept[0] == configuration
    assert kept.count(configuration) == len(files)
    stream = [data for data in kept if data != configuration]
    assert stream == [m.data for m in published][-len(stream) :]


def test_every_file_of_a_split_log_begins_with_the_configuration(tmp_path):
    """So that each can be analysed alone; it arrives as the first message of its file does."""
    published = bag_support.messages(60)
    folder = bag_support.write_log(tmp_path, published, split_duration=0.01)
    files = bag_support.bag_files(folder)
    assert len(files) > 3
    for file in files:
        first, second = itertools.islice(read_messages(file), 2)
        assert first.channel.topic == '/gear_pair/configuration'
        assert first.data == published[0].data
        assert first.publish_time == published[0].publish_time
        assert first.log_time == (second.log_time if file != files[0] else bag_support.START)


def test_a_change_of_configuration_is_noted(tmp_path):
    changed = {**bag_support.CONFIGURATION, 'parameters': 'pinion_teeth: 34\nseed: 2'}
    with LogWriter(tmp_path, bag_support.CONFIGURATION, free_floor=0.0) as writer:
        for message in bag_support.messages(20):
            bag_support.hand_in(writer, message)
        writer.configure(changed)
    info = log_info(next(tmp_path.iterdir()))
    assert [c['parameters'] for c in info.configurations] == [
        bag_support.CONFIGURATION['parameters'],
        changed['parameters'],
    ]


def test_the_writer_does_not_wake_for_each_message(tmp_path, monkeypatch):
    """Woken for each, it waited for Python's lock each time: under load, a kill lost 1.7 s."""
    monkeypatch.setattr(gear_dynamics.bag.writer, 'SYNC_INTERVAL', 1e6)
    published = bag_support.messages(20)
    with LogWriter(tmp_path, {}, free_floor=0.0) as writer:
        for message in published:
            bag_support.hand_in(writer, message)
        assert writer.status().waiting == len(published)
        monkeypatch.setattr(gear_dynamics.bag.writer, 'BATCH_SIZE', 0)
        bag_support.hand_in(writer, published[0])
        end = time.monotonic() + 20
        while writer.status().waiting:
            assert time.monotonic() < end
            time.sleep(0.01)
        assert writer.status().messages == len(published) + 1


def test_an_overflow_is_counted(tmp_path, monkeypatch):
    published = bag_support.messages(20)
    limit = sum(len(m.data) for m in published) // 2
    monkeypatch.setattr(gear_dynamics.bag.writer, 'QUEUE_SIZE', limit)
    writer = LogWriter(tmp_path, {}, free_floor=0.0)
    with writer._condition:  # the thread cannot take anything out meanwhile
        for message in published:
            bag_support.hand_in(writer, message)
    status = writer.close()
    assert status.overflows > 0
    assert status.dropped == status.overflows
    assert status.messages + status.dropped == len(published)
    assert log_info(status.path).messages == status.messages


def test_a_writer_that_fails_says_why(tmp_path, monkeypatch):
    def fail(*arguments):
        raise RuntimeError('out of ideas')

    published = bag_support.messages(3)
    monkeypatch.setattr(gear_dynamics.bag.folder.BagFolder, 'write', fail)
    writer = LogWriter(tmp_path, {}, free_floor=0.0)
    bag_support.hand_in(writer, published[0])
    writer._thread.join(20)
    status = writer.status()
    assert (status.state, status.reason) == ('off', 'the writer failed: RuntimeError: out of ideas')
    for message in published[1:]:
        bag_support.hand_in(writer, message)
    assert writer.close().dropped == len(published) - 1


def test_a_wrong_type_topic_or_option_is_refused(tmp_path):
    with LogWriter(tmp_path, {}, free_floor=0.0) as writer:
        with pytest.raises(MessageError, match=r"did you mean 'std_msgs/msg/String'"):
            writer.write('/a', 'std_msgs/msg/Strin', b'', 0, 0)
        with pytest.raises(ValueError, match='must be absolute'):
            writer.write('a', bag_support.STRING, b'', 0, 0)
        with pytest.raises(ValueError, match='out of range'):
            writer.write('/a', bag_support.STRING, b'', -1, 0)
    with pytest.raises(ValueError, match='compression is'):
        LogWriter(tmp_path, {}, compression='gzip')
    with pytest.raises(ValueError, match='split_size is 0'):
        LogWriter(tmp_path, {}, split_size=0)


def test_two_logs_in_the_same_second_have_folders_of_their_own(tmp_path):
    with LogWriter(tmp_path, {}, free_floor=0.0), LogWriter(tmp_path, {}, free_floor=0.0):
        pass
    assert len(list(tmp_path.iterdir())) == 2


def test_indexes_point_at_what_they_name(bag):
    """Readers in C++ seek by the message indexes and the summary offsets."""
    folder, _ = bag
    for path in bag_support.bag_files(folder):
        content = path.read_bytes()
        with path.open('rb') as stream:
            summary = make_reader(stream).get_summary()
        messages = 0
        for chunk in summary.chunk_indexes:
            records = chunk_records(content, chunk)
            at = chunk.chunk_start_offset + chunk.chunk_length
            assert sorted(chunk.message_index_offsets.values())[0] == at
            for channel, offset in chunk.message_index_offsets.items():
                opcode, length = struct.unpack_from('<BQ', content, offset)
                assert opcode == Opcode.MESSAGE_INDEX
                index = MessageIndex.read(
                    ReadDataStream(io.BytesIO(content[offset + 9 : offset + 9 + length]))
                )
                assert index.channel_id == channel
                for log_time, place in index.records:
                    found = struct.unpack_from('<BQHIQ', records, place)
                    assert (found[0], found[2], found[4]) == (Opcode.MESSAGE, channel, log_time)
                    assert chunk.message_start_time <= log_time <= chunk.message_end_time
                messages += len(index.records)
        assert messages == summary.statistics.message_count
        assert len(summary.chunk_indexes) == summary.statistics.chunk_count
        check_summary_offsets(content)


def chunk_records(content, index):
    stream = ReadDataStream(io.BytesIO(content[index.chunk_start_offset + 9 :]))
    return get_chunk_data_stream(Chunk.read(stream), validate_crc=True)[0].read(
        index.uncompressed_size
    )


def check_summary_offsets(content):
    footer = struct.unpack_from('<BQQQI', content, len(content) - 37)
    assert footer[:2] == (Opcode.FOOTER, 20)
    start, at, groups = footer[2], footer[3], {}
    while content[at] == Opcode.SUMMARY_OFFSET:
        group, first, length = struct.unpack_from('<BQQ', content, at + 9)
        groups[group] = (first, length)
        at += 9 + 17
    assert at == len(content) - 37
    for opcode, (first, length) in groups.items():
        place = first
        while place < first + length:
            kind, size = struct.unpack_from('<BQ', content, place)
            assert kind == opcode
            place += 9 + size
        assert place == first + length
    assert min(first for first, _ in groups.values()) == start
    assert set(groups) == {
        Opcode.SCHEMA,
        Opcode.CHANNEL,
        Opcode.STATISTICS,
        Opcode.CHUNK_INDEX,
        Opcode.METADATA_INDEX,
    }
