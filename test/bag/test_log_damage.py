"""Cut and damaged logs: what was whole is found, nothing wrong is returned in silence."""

import shutil
import warnings

import bag_support
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.records import Chunk, Message
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.writer import MCAP0_MAGIC
from rosbags.rosbag2 import Reader

import gear_dynamics.bag.mcap_file
from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.log import LogWarning
from gear_dynamics.bag.reader import read_log, read_messages
from gear_dynamics.bag.recover import recover

CASES = 200
SAMPLES_TOPIC = '/gear_pair/samples'


@pytest.fixture(scope='module', params=['none', 'lz4', 'zstd'])
def log(request, tmp_path_factory):
    """Return the bytes of a log of some thirty chunks, and what is in it."""
    published = bag_support.messages(60)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gear_dynamics.bag.mcap_file, 'CHUNK_SIZE', 8192)
        folder = bag_support.write_log(
            tmp_path_factory.mktemp(request.param), published, compression=request.param
        )
    (file,) = folder.glob('*.mcap')
    cases = CASES if request.param == 'zstd' else CASES // 4
    return file.read_bytes(), published, chunk_contents(file), cases


def chunk_contents(file):
    """Return end offset and messages of each chunk, by the mcap package."""
    with file.open('rb') as stream:
        indexes = make_reader(stream).get_summary().chunk_indexes
    with file.open('rb') as stream:
        records = StreamReader(stream, emit_chunks=True).records
        chunks = [record for record in records if isinstance(record, Chunk)]
    assert len(chunks) > 20
    return [
        (
            index.chunk_start_offset + index.chunk_length,
            [record.data for record in breakup_chunk(chunk) if isinstance(record, Message)],
        )
        for index, chunk in zip(indexes, chunks, strict=True)
    ]


def read_all(file):
    """Return the messages of a damaged log and the places that were named."""
    damage = []
    return [message.data for message in read_messages(file, on_damage=damage.append)], damage


def rows_of(published):
    """Return what read_log must give for these sample messages."""
    numbers = [(m.publish_time - bag_support.START) // bag_support.STEP for m in published]
    return np.concatenate([bag_support.block_of_samples(number) for number in numbers])


def read_quietly(file):
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', LogWarning)
        return read_log(file, SAMPLES_TOPIC)


def check_rows(file, found, published):
    """Compare read_log with the sample messages that are among the messages found."""
    kept = set(found)
    samples = [m for m in published if m.topic == SAMPLES_TOPIC and m.data in kept]
    if not samples:
        with pytest.raises(LogError):
            read_quietly(file)
        return
    rows, expected = read_quietly(file), rows_of(samples)
    assert len(rows) == len(expected)
    for name in expected.dtype.names[1:]:
        np.testing.assert_array_equal(rows[name], expected[name])
    # Stamps count whole ns; t is float32 within a block of 1.25 ms.
    np.testing.assert_allclose(rows['t'], expected['t'] - expected['t'][0], atol=2e-9)


def test_a_truncation_loses_no_message_of_a_whole_chunk(log, tmp_path):
    content, published, chunks, cases = log
    random = np.random.default_rng(2024)
    file = tmp_path / 'cut.mcap'
    for size in random.integers(0, len(content), cases).tolist():
        file.write_bytes(content[:size])
        expected = [data for end, messages in chunks if end <= size for data in messages]
        found, damage = read_all(file)
        assert found == expected, size
        assert damage or len(found) == len(published), size
        info = log_info(file)
        assert (info.messages, info.whole) == (len(expected), False)
        check_rows(file, found, published)


def test_recover_makes_a_sound_log_of_a_truncated_one(log, tmp_path):
    content, published, chunks, cases = log
    random = np.random.default_rng(7)
    file, folder = tmp_path / 'cut.mcap', tmp_path / 'sound'
    for size in random.integers(0, len(content), cases // 10).tolist():
        file.write_bytes(content[:size])
        expected = [data for end, messages in chunks if end <= size for data in messages]
        if not expected:
            with pytest.raises(LogError):
                recover(file, folder)
            assert not folder.exists()
            continue
        recovery = recover(file, folder)
        assert recovery.messages == len(expected)
        assert recovery.lost or len(expected) == len(published)
        with Reader(folder) as reader:
            assert [bytes(data) for _, _, data in reader.messages()] == expected
        info = log_info(folder)
        assert info.whole
        assert info.configurations == log_info(file).configurations
        shutil.rmtree(folder)


def test_a_flipped_bit_gives_no_wrong_data_in_silence(log, tmp_path):
    content, published, _, cases = log
    random = np.random.default_rng(42)
    file, folder = tmp_path / 'flipped.mcap', tmp_path / 'sound'
    whole = [message.data for message in published]
    (sound_file := tmp_path / 'sound.mcap').write_bytes(content)
    sound = log_info(sound_file)
    for number, bit in enumerate(random.integers(0, 8 * len(content), cases).tolist()):
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        file.write_bytes(flipped)
        found, damage = read_all(file)
        remaining = iter(whole)
        assert all(data in remaining for data in found), bit  # a sub-sequence of what was sent
        assert found == whole or damage, bit
        check_rows(file, found, published)
        info = log_info(file)
        same = (info.messages, info.topics, info.configurations)
        assert same == (sound.messages, sound.topics, sound.configurations) or info.damage, bit
        if number % 10 == 0:
            recovery = recover(file, folder)
            assert recovery.lost or found == whole
            with Reader(folder) as reader:
                assert [bytes(data) for _, _, data in reader.messages()] == found
            shutil.rmtree(folder)


@pytest.mark.parametrize('compression', ['none', 'zstd'])
def test_a_cut_and_damaged_log_is_read_behind_the_damage(tmp_path, compression, monkeypatch):
    """Without an index, a length that is wrong must not lose what follows."""
    monkeypatch.setattr(gear_dynamics.bag.mcap_file, 'CHUNK_SIZE', 8192)
    published = bag_support.messages(60)
    folder = bag_support.write_log(tmp_path, published, compression=compression)
    (file,) = folder.glob('*.mcap')
    chunks = chunk_contents(file)
    content = bytearray(file.read_bytes())
    with file.open('rb') as stream:
        index = make_reader(stream).get_summary().chunk_indexes[5]
    content[index.chunk_start_offset + 3] ^= 0x40  # in the length of chunk 5
    file.write_bytes(content[:-100])
    found, damage = read_all(file)
    expected = [data for number, (_, each) in enumerate(chunks) if number != 5 for data in each]
    assert found == expected
    assert damage[0].offset == index.chunk_start_offset


@pytest.mark.parametrize('content', [b'', MCAP0_MAGIC, b'no log at all' * 100, bytes(10_000)])
def test_what_is_no_log_is_refused_in_one_line(tmp_path, content):
    file = tmp_path / 'no.mcap'
    file.write_bytes(content)
    actions = [read_quietly, lambda path: recover(path, tmp_path / 'new')]
    begins_as_one = content == MCAP0_MAGIC
    for action in actions if begins_as_one else [*actions, log_info]:
        with pytest.raises(LogError) as caught:
            action(file)
        assert '\n' not in str(caught.value)
        assert begins_as_one or str(caught.value) == f'{file}: this is no MCAP file'


def test_an_empty_file_among_others_is_told_and_left_out(tmp_path):
    """A power cut may leave one at the end."""
    published = bag_support.messages(30)
    folder = bag_support.write_log(tmp_path, published)
    (folder / f'{folder.name}_1.mcap').touch()
    found, damage = read_all(folder)
    assert found == [message.data for message in published]
    assert [str(each) for each in damage] == [f'{folder.name}_1.mcap, byte 0: this is no MCAP file']


def test_a_chunk_that_claims_too_much_is_not_tried(tmp_path, monkeypatch):
    published = bag_support.messages(30)
    folder = bag_support.write_log(tmp_path, published, compression='zstd')
    (file,) = folder.glob('*.mcap')
    with file.open('rb') as stream:
        index = make_reader(stream).get_summary().chunk_indexes[0]
    content = bytearray(file.read_bytes())
    content[index.chunk_start_offset + 9 + 16 + 6] = 0x7F  # uncompressed size
    file.write_bytes(content)
    found, damage = read_all(file)
    assert found == []
    assert 'claims' in str(damage[0])


def test_a_damaged_message_is_skipped_with_its_place(tmp_path):
    published = bag_support.messages(5)
    place = [m.topic for m in published].index(SAMPLES_TOPIC, 5)
    cut = published[place]
    published[place] = bag_support.Published(
        cut.topic, cut.type_name, cut.data[:-100], cut.log_time, cut.publish_time, cut.qos
    )
    folder = bag_support.write_log(tmp_path, published)
    with pytest.warns(LogWarning, match=rf'_0.mcap, byte \d+: .*{cut.log_time} ns is skipped'):
        rows = read_log(folder, SAMPLES_TOPIC)
    assert len(rows) == 4 * bag_support.BLOCK
