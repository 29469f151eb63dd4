"""Logs of other writers: every valid file is read as the mcap package reads it."""

import io
import itertools
import shutil

import foreign_support as other
import numpy as np
import pytest
import yaml
import zstandard
from mcap.reader import NonSeekingReader, make_reader
from mcap.writer import CompressionType
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2 import Reader

from gear_dynamics.bag import merge
from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.command import main
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.info_text import info_lines
from gear_dynamics.bag.log import Log, LogWarning
from gear_dynamics.bag.qos import first_profile, read_profiles
from gear_dynamics.bag.reader import read_log, read_messages
from gear_dynamics.bag.recover import recover


def expected(content):
    """Return the messages of a file as the mcap package reads it."""
    return [
        (channel.topic, schema.name if schema else '', m.sequence, m.log_time, m.data)
        for schema, channel, m in NonSeekingReader(io.BytesIO(content)).iter_messages()
    ]


def found(path):
    """Return the messages of a log; any damage is an error."""

    def refuse(damage):
        raise AssertionError(str(damage))

    return [
        (m.channel.topic, m.channel.type_name, m.sequence, m.log_time, m.data)
        for m in read_messages(path, on_damage=refuse)
    ]


@pytest.fixture
def write(tmp_path):
    def write(content, name='other_0.mcap'):
        file = tmp_path / 'bag' / name
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content)
        return file

    return write


def check_file(file, content, directory):
    """Check messages, numbers and a recovered copy against the mcap package."""
    messages = expected(content)
    assert found(file) == messages
    for check in (True, False):
        info = log_info(file, check)
        assert (info.messages, info.whole, info.damage) == (len(messages), True, ())
    folder = directory / 'sound'
    recovery = recover(file, folder)
    assert recovery.damage == ()
    assert found(folder) == messages
    if content[17:21] == b'ros2':
        with Reader(folder) as reader:
            assert [bytes(data) for _, _, data in reader.messages()] == [m[-1] for m in messages]
    shutil.rmtree(folder)


UNORDERED = [7 * number % 20 for number in range(20)]


def test_files_with_all_options_of_the_writer(write, tmp_path):
    for options in other.writer_options():
        for schema in (True, False):
            content = other.string_log(times=UNORDERED, schema=schema, **options)
            assert len(expected(content)) == 20, options
            check_file(write(content), content, tmp_path)


def padded_files():
    padded = other.record(other.string_schema(), b'abc') + other.record(
        other.string_channel(), b'x'
    )
    head = other.record(other.string_schema()) + other.record(other.string_channel())
    messages = b''.join(other.string_record(n) for n in range(5))
    for compression in ('', 'lz4', 'zstd'):
        yield other.file_of(other.chunk(head + messages, compression))
        packed = other.chunk(head + messages, compression)
        length = len(packed) - 9 + 3
        yield other.file_of(packed[:1] + length.to_bytes(8, 'little') + packed[9:] + b'pad')
    yield other.file_of(padded, messages)
    # Chunks that need the schema and the channel of an earlier one; and loose messages between.
    yield other.file_of(
        other.chunk(head + other.string_record(0)),
        other.string_record(1),
        other.chunk(other.string_record(2)),
        other.string_record(3),
    )


@pytest.mark.parametrize('number', range(8))
def test_padded_and_mixed_records(write, tmp_path, number):
    content = next(itertools.islice(padded_files(), number, None))
    check_file(write(content), content, tmp_path)


@pytest.mark.parametrize(('kind', 'loss'), [(0x40, True), (0x91, False)])
def test_records_of_unknown_kinds_are_skipped_and_told(write, kind, loss):
    """From 0x80 on, the specification leaves kinds to applications: nothing is missing then."""
    content = other.file_of(
        other.raw_record(kind, b'other'),
        other.record(other.string_schema()),
        other.record(other.string_channel()),
        other.string_record(0),
        other.raw_record(kind, b'other'),
    )
    damage = []
    path = write(content)
    assert len(list(read_messages(path, on_damage=damage.append))) == 1
    told = [(each.reason, each.loss) for each in damage]
    assert told == [(f'2 records of the unknown kind {kind} are skipped', loss)]
    info = log_info(path)
    assert info.whole is not loss
    lines = [line for line in info_lines(info) if 'unknown kind' in line]
    assert [line.split()[0] for line in lines] == ['damage' if loss else 'note']


def test_a_channel_may_be_told_of_in_a_later_chunk_of_an_earlier_time(write):
    """Read by log time, the second chunk comes first."""
    head = other.record(other.string_schema()) + other.record(other.string_channel())
    late = other.chunk(head + other.string_record(5), start=other.START + 5 * 10**8)
    early = other.chunk(other.string_record(1), end=other.START + 10**8)
    messages = found(write(other.file_of(late, early)))
    assert [m[2] for m in messages] == [1, 5]


def test_overlap_beyond_the_memory_is_told(write, monkeypatch):
    head = other.record(other.string_schema()) + other.record(other.string_channel())
    chunks = [
        other.chunk(head + other.string_record(n) + other.string_record(9 - n)) for n in range(4)
    ]
    file = write(other.file_of(*chunks))
    assert [m[2] for m in found(file)] == [0, 1, 2, 3, 6, 7, 8, 9]
    monkeypatch.setattr(merge, 'MOST_HELD', 500)
    damage = []
    messages = list(read_messages(file, on_damage=damage.append))
    assert sorted(m.sequence for m in messages) == [0, 1, 2, 3, 6, 7, 8, 9]
    assert 'too much overlaps in time' in damage[0].reason
    assert not damage[0].loss


@pytest.mark.parametrize('name', ['chatter', '/chatter'])
@pytest.mark.parametrize('asked', ['chatter', '/chatter'])
def test_a_topic_with_or_without_a_slash(write, tmp_path, capsys, name, asked):
    file = write(other.string_log(name))
    assert read_log(file, asked)['data'][3] == 'hello 3'
    arguments = ['export', str(file), '--topic', asked, '--output', str(tmp_path)]
    assert main(arguments) == 0
    assert (tmp_path / 'chatter.npz').exists()


def test_a_type_that_is_not_of_jazzy(write, tmp_path, capsys):
    file = write(other.string_log(type_name='my_msgs/msg/Text'))
    with pytest.raises(LogError, match=r"/chatter cannot be read as rows: 'my_msgs/msg/Text' is"):
        read_log(file, '/chatter')
    assert main(['export', str(file), '--output', str(tmp_path / 'out')]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len([line for line in lines if 'cannot be read as rows' in line]) == 1
    recovery = recover(file, tmp_path / 'sound')
    assert (recovery.messages, recovery.damage) == (20, ())
    assert found(tmp_path / 'sound') == found(file)


def test_another_encoding_is_named(write):
    file = write(other.string_log(encoding='json'))
    with pytest.raises(LogError, match="its encoding is 'json', that of ROS 2 is 'cdr'"):
        read_log(file, '/chatter')


def test_info_gives_the_rate_of_a_topic_over_its_own_time(tmp_path):
    for topic, times in (('/a', range(0, 50)), ('/b', range(500, 1000, 10))):
        file = tmp_path / f'bag{topic}.mcap'
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(other.string_log(topic, times=times))
    info = log_info(tmp_path / 'bag')
    assert [topic.rate for topic in info.topics] == pytest.approx([10.0, 1.0])
    assert info.checked
    quick = log_info(tmp_path / 'bag', check=False)
    assert [topic.messages for topic in quick.topics] == [50, 50]
    assert [topic.rate for topic in quick.topics] == [None, None]


def test_info_notices_a_damaged_chunk_and_an_index_that_lies(write):
    content = bytearray(other.string_log())
    content[200] ^= 1
    info = log_info(write(bytes(content)))
    assert not info.whole
    assert 'a chunk of' in info.damage[0].reason
    assert info.damage[-1].reason == 'the index lists 20 messages, 0 can be read'


def test_recover_keeps_channel_metadata_and_puts_numbers_of_policies_into_words(write, tmp_path):
    metadata = {'offered_qos_profiles': other.QOS_NUMBERS, 'topic_type_hash': 'RIHS01_x', 'a': 'b'}
    file = write(other.string_log(metadata=metadata))
    recover(file, tmp_path / 'sound')
    (copy,) = (tmp_path / 'sound').glob('*.mcap')
    with copy.open('rb') as stream:
        (channel,) = make_reader(stream).get_summary().channels.values()
    assert channel.metadata['a'] == 'b'
    assert channel.metadata['topic_type_hash'] == 'RIHS01_x'
    (profile,) = yaml.safe_load(channel.metadata['offered_qos_profiles'])
    about = yaml.safe_load((tmp_path / 'sound' / 'metadata.yaml').read_text())
    (topic,) = about['rosbag2_bagfile_information']['topics_with_message_count']
    assert topic['topic_metadata']['offered_qos_profiles'] == [profile]
    assert profile['reliability'] == 'reliable'
    assert profile['durability'] == 'volatile'
    assert profile['history'] == 'unknown'
    assert profile['deadline'] == {'sec': 2147483647, 'nsec': 4294967295}
    with Reader(tmp_path / 'sound') as reader:
        (connection,) = reader.connections
        (qos,) = connection.ext.offered_qos_profiles
        assert qos.reliability == QosReliability.RELIABLE
        assert qos.durability == QosDurability.VOLATILE


def test_profiles_in_words_are_kept_and_nonsense_gives_the_default(write, tmp_path):
    words = first_profile('').text()
    assert read_profiles(words)[0]['reliability'] == 'reliable'
    for text in ('', '3', '- 3', '[{depth: -1, history: [], reliability: 77}]', 'a: [', '[' * 99):
        assert first_profile(text) == first_profile('')
    file = write(other.string_log(metadata={'offered_qos_profiles': words}))
    recover(file, tmp_path / 'sound')
    (copy,) = (tmp_path / 'sound').glob('*.mcap')
    with copy.open('rb') as stream:
        (channel,) = make_reader(stream).get_summary().channels.values()
    assert channel.metadata['offered_qos_profiles'] == words


def test_recover_goes_on_behind_a_message_of_an_unknown_channel(write, tmp_path, capsys):
    head = other.record(other.string_schema()) + other.record(other.string_channel())
    messages = [other.string_record(n, channel=9 if n == 2 else 1) for n in range(8)]
    file = write(other.file_of(other.chunk(head + b''.join(messages))))
    assert main(['recover', str(file), '--output', str(tmp_path / 'sound')]) == 1
    out = capsys.readouterr().out
    assert 'lost: ' in out
    assert 'messages of the unknown channel 9 are lost: 1 of them' in out
    assert [m[2] for m in found(tmp_path / 'sound')] == [0, 1, 3, 4, 5, 6, 7]


def test_recover_keeps_the_order_of_the_file(write, tmp_path):
    file = write(other.string_log(times=UNORDERED))
    recover(file, tmp_path / 'sound')
    with Log(tmp_path / 'sound') as log:
        times = [m.log_time for _, m in log.messages_as_written()]
    assert times == [other.START + time * 100_000_000 for time in UNORDERED]
    assert found(tmp_path / 'sound') == found(file)


def test_nothing_to_recover_is_an_error(write, tmp_path, capsys):
    file = write(other.string_log(count=0))
    assert main(['recover', str(file), '--output', str(tmp_path / 'sound')]) == 2
    assert 'no message that can be saved' in capsys.readouterr().err
    assert not (tmp_path / 'sound').exists()


def test_messages_and_files_that_rosbag2_compressed(write, tmp_path):
    plain = other.string_log()
    messages = found(write(plain))
    packed = other.string_log(data=lambda n: zstandard.compress(other.text_message(n)))
    assert found(write(packed)) == messages
    recover(tmp_path / 'bag', tmp_path / 'sound')
    assert found(tmp_path / 'sound') == messages
    shutil.rmtree(tmp_path / 'bag')
    file = write(zstandard.compress(plain), 'other_0.mcap.zstd')
    assert found(tmp_path / 'bag') == messages
    assert found(file) == messages
    assert log_info(tmp_path / 'bag').messages == 20


def test_sqlite_and_ros_1_bags_are_refused_with_a_hint(tmp_path):
    folder = tmp_path / 'bag'
    folder.mkdir()
    (folder / 'bag_0.db3').write_bytes(b'SQLite format 3\0' + bytes(100))
    for path in (folder, folder / 'bag_0.db3'):
        with pytest.raises(LogError, match=r'SQLite bag.*`ros2 bag convert`'):
            read_log(path)
    (folder / 'old.bag').write_bytes(b'#ROSBAG V2.0\n' + bytes(100))
    with pytest.raises(LogError, match='bag of ROS 1'):
        read_log(folder / 'old.bag')


def test_a_cut_fastwrite_file_gives_its_whole_messages(write):
    """`ros2 bag record --storage-preset-profile fastwrite` writes no chunks and no CRC."""
    content = other.string_log(use_chunking=False, compression=CompressionType.NONE)
    file = write(content[: content.index(b'hello 12')])
    with pytest.warns(LogWarning, match='the file is cut'):
        rows = read_log(file, '/chatter')
    np.testing.assert_array_equal(rows['data'], [f'hello {n}' for n in range(12)])


def test_a_file_that_was_not_closed_says_that_nothing_is_cut_off(write):
    head = other.record(other.string_schema()) + other.record(other.string_channel())
    content = other.file_of(head, other.string_record(0))
    content = content[: content.index(other.string_record(0)) + len(other.string_record(0))]
    damage = []
    assert len(list(read_messages(write(content), on_damage=damage.append))) == 1
    (told,) = damage
    assert told.reason == 'the file was not closed: it ends behind a whole record'
    assert not told.loss
