"""`gd.read_log` and the message iterator against what was handed to the writer."""

import dataclasses
import tracemalloc

import bag_support
import numpy as np
import pytest

import gear_dynamics as gd
import gear_dynamics.bag.mcap_file
import gear_dynamics.bag.source
from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.log import LogWarning
from gear_dynamics.bag.reader import read_messages
from gear_dynamics.machine.columns import EVENTS, SAMPLES
from gear_dynamics.wire.messages import message_class, serialize

BLOCKS = 40
SECONDS = bag_support.BLOCK / bag_support.RATE


@pytest.fixture(scope='module')
def published():
    return bag_support.messages(BLOCKS)


@pytest.fixture(scope='module')
def folder(published, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gear_dynamics.bag.mcap_file, 'CHUNK_SIZE', 16384)
        return bag_support.write_log(tmp_path_factory.mktemp('log'), published, split_duration=0.02)


def samples_of(first, last):
    return np.concatenate([bag_support.block_of_samples(n) for n in range(first, last)])


def same_samples(rows, expected):
    assert rows.dtype == SAMPLES
    assert len(rows) == len(expected)
    for name in SAMPLES.names[1:]:
        np.testing.assert_array_equal(rows[name], expected[name])
    # float32 of t within a block of 1.25 ms holds 6e-11 s; stamps hold 1 ns
    np.testing.assert_allclose(rows['t'], expected['t'], atol=1e-9)


@pytest.mark.parametrize('topic', ['gear_pair/samples', '/gear_pair/samples', 'samples'])
def test_samples_come_back_as_simulate_gives_them(folder, topic):
    same_samples(gd.read_log(folder, topic), samples_of(0, BLOCKS))


def test_folder_file_and_several(folder):
    files = sorted(folder.glob('*.mcap'), key=lambda path: int(path.stem.rsplit('_', 1)[1]))
    assert len(files) > 1
    same_samples(gd.read_log(files), samples_of(0, BLOCKS))
    same_samples(gd.read_log([str(file) for file in reversed(files)]), samples_of(0, BLOCKS))
    first = gd.read_log(files[0])
    same_samples(first, samples_of(0, len(first) // bag_support.BLOCK))


@pytest.mark.parametrize(
    ('start', 'end'), [(None, 0.01), (0.01, None), (0.0101, 0.0307), (0.02, 0.02), (1.0, 2.0)]
)
def test_a_time_range_is_exact_to_the_row(folder, start, end):
    whole = gd.read_log(folder)
    low, high = -np.inf if start is None else start, np.inf if end is None else end
    expected = whole[(whole['t'] >= low) & (whole['t'] < high)]
    np.testing.assert_array_equal(gd.read_log(folder, start=start, end=end), expected)


@pytest.mark.parametrize('lateness', ['steady', 'growing'])
def test_a_part_of_a_long_log_is_found_without_reading_it_all(tmp_path, monkeypatch, lateness):
    second = 1_000_000_000
    published = [
        dataclasses.replace(
            m, log_time=m.log_time + (m.publish_time - bag_support.START) * (lateness == 'growing')
        )
        for m in bag_support.messages(1000, step=second)
    ]
    monkeypatch.setattr(gear_dynamics.bag.mcap_file, 'CHUNK_SIZE', 8192)
    folder = bag_support.write_log(tmp_path, published)
    whole = gd.read_log(folder)
    read = []
    unpack = gear_dynamics.bag.source.unpack_chunk
    monkeypatch.setattr(
        gear_dynamics.bag.source, 'unpack_chunk', lambda data: read.append(1) or unpack(data)
    )
    gd.read_log(folder)
    all_chunks = len(read)
    for start, end in ((None, 10.0005), (500.0003, 502.0), (990.0, None), (2000.0, None)):
        read.clear()
        low, high = -np.inf if start is None else start, np.inf if end is None else end
        expected = whole[(whole['t'] >= low) & (whole['t'] < high)]
        np.testing.assert_array_equal(gd.read_log(folder, start=start, end=end), expected)
        assert lateness == 'growing' or len(expected) == 0 or len(read) < all_chunks / 2


def test_columns_are_chosen_and_ordered(folder):
    whole = gd.read_log(folder)
    rows = gd.read_log(folder, start=0.01, end=0.02, columns=('mesh_force', 'delta'))
    inside = (whole['t'] >= 0.01) & (whole['t'] < 0.02)
    assert rows.dtype.names == ('mesh_force', 'delta')
    assert rows.dtype.itemsize == 16
    for name in rows.dtype.names:
        np.testing.assert_array_equal(rows[name], whole[name][inside])
    assert gd.read_log(folder, end=0.01, columns=['t']).dtype.names == ('t',)


def test_events_keep_their_types_and_share_the_time_of_the_samples(folder):
    rows = gd.read_log(folder, 'gear_pair/events')
    expected = []
    for number in range(BLOCKS):
        events = bag_support.block_of_events(number)
        events['t'] += number * SECONDS
        expected.append(events)
    expected = np.concatenate(expected)
    assert rows.dtype == EVENTS
    np.testing.assert_allclose(rows['t'], expected['t'], atol=1e-9)
    for name in EVENTS.names[1:]:
        np.testing.assert_array_equal(rows[name], expected[name])


def test_other_messages_are_rows_of_their_fields(folder, tmp_path):
    commands = gd.read_log(folder, 'gear_pair/cmd/speed')
    assert commands.dtype.names == ('t', 'data')
    np.testing.assert_array_equal(commands['data'], np.arange(0.0, BLOCKS, 10.0))
    values = gd.read_log(folder, '/diagnostics')
    assert values.dtype.names == ('t', 'name', 'level', 'message', 'key', 'value')
    blocks = values[values['key'] == 'blocks']
    np.testing.assert_array_equal(blocks['value'].astype(int), np.arange(0, BLOCKS, 10))
    np.testing.assert_allclose(blocks['t'], np.arange(0, BLOCKS, 10) * SECONDS, atol=1e-9)

    vector = message_class('geometry_msgs/msg/Vector3')
    time = message_class('builtin_interfaces/msg/Time')
    header = message_class('std_msgs/msg/Header')
    published = []
    for n in range(5):
        stamp = bag_support.START + n * 10**6
        message = message_class('geometry_msgs/msg/AccelStamped')(
            header(time(*divmod(stamp, 10**9)), 'line_of_action'),
            message_class('geometry_msgs/msg/Accel')(vector(n, 2 * n, 0.0), vector(0.0, 0.0, 0.0)),
        )
        published.append(
            bag_support.Published(
                '/gear_pair/gear/acceleration',
                'geometry_msgs/msg/AccelStamped',
                serialize(message),
                stamp,
                stamp,
                bag_support.RELIABLE,
            )
        )
    rows = gd.read_log(bag_support.write_log(tmp_path, published), 'gear_pair/gear/acceleration')
    np.testing.assert_array_equal(rows['accel.linear.y'], 2.0 * np.arange(5))
    np.testing.assert_allclose(rows['t'], np.arange(5) * 1e-3, atol=1e-9)


def test_a_namespace_may_be_left_out_if_there_is_one_rig(tmp_path):
    def rig(name):
        return [
            bag_support.Published(
                f'/{name}{m.topic}', m.type_name, m.data, m.log_time, m.publish_time, m.qos
            )
            for m in bag_support.messages(3)
        ]

    one = bag_support.write_log(tmp_path / 'one', rig('a'))
    same_samples(gd.read_log(one), samples_of(0, 3))
    two = bag_support.write_log(tmp_path / 'two', sorted(rig('a') + rig('b'), key=by_time))
    same_samples(gd.read_log(two, '/b/gear_pair/samples'), samples_of(0, 3))
    with pytest.raises(LogError, match="2 topics match 'gear_pair/samples'"):
        gd.read_log(two)


def by_time(message):
    return message.log_time


def test_two_logs_are_merged_by_log_time(tmp_path, published):
    halves = [
        bag_support.write_log(tmp_path / str(number), published[number::2]) for number in (0, 1)
    ]
    merged = list(read_messages(halves))
    assert [m.log_time for m in merged] == sorted(m.log_time for m in published)
    assert sorted(m.data for m in merged) == sorted(m.data for m in published)


def test_messages_are_what_was_handed_in(folder, published):
    found = list(read_messages(folder))
    expected = bag_support.with_repeats(published, folder)
    for read, message in zip(found, expected, strict=True):
        assert type(read.data) is bytes
        assert (read.channel.topic, read.channel.type_name, read.data) == (
            message.topic,
            message.type_name,
            message.data,
        )
        assert (read.log_time, read.publish_time) == (message.log_time, message.publish_time)
        assert read.channel.qos == message.qos.text()
        assert read.path.parent == folder


def test_messages_of_topics_and_of_a_time(folder, published):
    start, end = published[20].log_time, published[60].log_time
    found = read_messages(folder, ['/gear_pair/events'], start, end)
    expected = [
        m.data for m in published if m.topic == '/gear_pair/events' and start <= m.log_time < end
    ]
    assert [m.data for m in found] == expected


def test_a_log_that_is_being_written_is_read_so_far(folder, tmp_path):
    file = next(iter(sorted(folder.glob('*.mcap'))))
    cut = tmp_path / 'cut.mcap'
    cut.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.warns(LogWarning, match='the file is cut'):
        rows = gd.read_log(cut)
    same_samples(rows, samples_of(0, len(rows) // bag_support.BLOCK))


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'topic': 'gear_pair/sample'}, 'there is no topic .gear_pair/sample.*; it has /diagn'),
        ({'columns': ['force']}, "no column 'force'; there are t, pinion_ax"),
        ({'path': 'nowhere'}, 'nowhere: there is no such file'),
        ({'path': []}, 'no log was given'),
        ({'start': 'a'}, "start is 'a': it must be a number of seconds"),
        ({'end': float('nan')}, 'end is nan: it must be'),
        ({'columns': 'delta'}, "columns is 'delta': it must be a list of names"),
        ({'columns': []}, r'columns is \[\]: it must be'),
    ],
)
def test_what_is_not_there_is_named(folder, arguments, words):
    with pytest.raises(LogError, match=words) as caught:
        gd.read_log(**{'path': folder, **arguments})
    assert '\n' not in str(caught.value)


def test_an_empty_folder_is_named(tmp_path):
    with pytest.raises(LogError, match=r'there is no \.mcap file'):
        gd.read_log(tmp_path)


def test_memory_is_bounded_by_what_is_kept(tmp_path):
    """A long log, of which one column of a short time is asked for."""
    published = bag_support.messages(3000)
    folder = bag_support.write_log(tmp_path, published, compression='none')
    size = sum(file.stat().st_size for file in folder.glob('*.mcap'))
    gd.read_log(folder, end=0.01)
    tracemalloc.start()
    try:
        rows = gd.read_log(folder, start=1.0, end=1.1, columns=['delta'])
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert len(rows) == round(0.1 * bag_support.RATE)
    # A chunk of 1 MiB, its unpacked form and the first 65536 rows of 8 bytes.
    assert peak < 4e6 < size / 2
