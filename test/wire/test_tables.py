"""Tables against rosbags' encoder, against rclpy, and against bytes that are no table."""

import contextlib

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from gear_dynamics.machine.columns import EVENTS, SAMPLES
from gear_dynamics.wire.tables import (
    SAMPLES_FLOAT32,
    TABLE_TYPE,
    TableError,
    columns_as_float32,
    decode_table,
    encode_table,
)

STAMP = 1_700_000_000_123_456_789

ALL_TYPES = np.dtype(
    [
        ('a', 'i1'),
        ('bb', 'u1'),
        ('ccc', '<i2'),
        ('d', '<u2'),
        ('e', '<i4'),
        ('f', '<u4'),
        ('g', '<f4'),
        ('höhe', '<f8'),
    ]
)


def random_rows(dtype, count, seed=1):
    raw = np.random.default_rng(seed).integers(0, 100, (count, dtype.itemsize), dtype=np.uint8)
    return raw.view(dtype).reshape(-1)


def cloud_by_rosbags(rows, stamp_ns, frame_id, **changes):
    """Build the same message field by field with rosbags alone."""
    store = get_typestore(Stores.ROS2_JAZZY)
    types = store.types
    numbers = {'i1': 1, 'u1': 2, 'i2': 3, 'u2': 4, 'i4': 5, 'u4': 6, 'f4': 7, 'f8': 8}
    point_field = types['sensor_msgs/msg/PointField']
    fields = [
        point_field(name, rows.dtype.fields[name][1], numbers[rows.dtype[name].str[1:]], 1)
        for name in rows.dtype.names
    ]
    time = types['builtin_interfaces/msg/Time'](*divmod(stamp_ns, 10**9))
    content = {
        'header': types['std_msgs/msg/Header'](time, frame_id),
        'height': 1,
        'width': len(rows),
        'fields': fields,
        'is_bigendian': False,
        'point_step': rows.dtype.itemsize,
        'row_step': rows.nbytes,
        'data': np.frombuffer(rows.tobytes(), np.uint8),
        'is_dense': True,
    }
    content.update(changes)
    return bytes(store.serialize_cdr(types[TABLE_TYPE](**content), TABLE_TYPE))


@pytest.mark.parametrize('dtype', [SAMPLES_FLOAT32, EVENTS, ALL_TYPES])
@pytest.mark.parametrize('count', [0, 1, 512])
@pytest.mark.parametrize('frame_id', ['', 'line_of_action', 'abc', 'ü'])
def test_bytes_are_those_of_rosbags(dtype, count, frame_id):
    rows = random_rows(dtype, count)
    data = encode_table(rows, STAMP, frame_id)
    assert data == cloud_by_rosbags(rows, STAMP, frame_id)
    table = decode_table(data)
    assert (table.stamp_ns, table.frame_id, table.rows.dtype.names) == (
        STAMP,
        frame_id,
        dtype.names,
    )
    assert table.rows.tobytes() == rows.tobytes()
    assert data[table.data_offset :][: rows.nbytes] == rows.tobytes()


def test_rclpy_reads_the_same_fields():
    serialization = pytest.importorskip('rclpy.serialization', reason='rclpy is not installed')
    from sensor_msgs.msg import PointCloud2

    rows = random_rows(ALL_TYPES, 7)
    cloud = serialization.deserialize_message(
        encode_table(rows, STAMP, 'line_of_action'), PointCloud2
    )
    assert cloud.header.stamp.sec * 10**9 + cloud.header.stamp.nanosec == STAMP
    assert cloud.header.frame_id == 'line_of_action'
    assert (cloud.height, cloud.width, cloud.point_step) == (1, 7, ALL_TYPES.itemsize)
    assert [field.name for field in cloud.fields] == list(ALL_TYPES.names)
    assert bytes(cloud.data) == rows.tobytes()
    again = decode_table(serialization.serialize_message(cloud))
    np.testing.assert_array_equal(again.rows, rows)


def test_rows_are_a_view_of_the_message():
    data = encode_table(random_rows(SAMPLES_FLOAT32, 10), STAMP, 'f')
    assert np.shares_memory(decode_table(data).rows, np.frombuffer(data, np.uint8))


def test_padded_and_big_endian_arrays_are_packed():
    aligned = np.zeros(3, np.dtype([('a', 'u1'), ('b', '>f8')], align=True))
    aligned['a'], aligned['b'] = (1, 2, 3), (0.5, -1.5, 2.5)
    rows = decode_table(encode_table(aligned, 0, '')).rows
    assert rows.dtype == np.dtype([('a', 'u1'), ('b', '<f8')])
    np.testing.assert_array_equal(rows['b'], aligned['b'])


def test_samples_are_published_as_float32_relative_to_the_stamp():
    samples = np.zeros(4, SAMPLES)
    samples['t'] = 1e6 + np.arange(4) / 51200
    samples['mesh_force'] = 2705.5
    published = columns_as_float32(samples, 1e6)
    assert published.dtype == SAMPLES_FLOAT32
    # 1e6 s hold 1.2e-10 s in float64; float32 of 6e-5 s holds 4e-12 s
    np.testing.assert_allclose(published['t'], np.arange(4) / 51200, atol=2e-10)
    np.testing.assert_array_equal(published['mesh_force'], np.float32(2705.5))


@pytest.mark.parametrize(
    ('rows', 'stamp', 'words'),
    [
        (np.zeros((2, 2), SAMPLES), 0, 'one dimension'),
        (np.zeros(2), 0, 'named columns'),
        (np.zeros(2, [('n', 'i8')]), 0, "'n' is int64"),
        (np.zeros(2, [('n', 'f4', 3)]), 0, "'n'"),
        (np.zeros(2, SAMPLES), 2**31 * 10**9, 'out of range'),
    ],
)
def test_what_is_no_table_is_refused(rows, stamp, words):
    with pytest.raises(TableError, match=words):
        encode_table(rows, stamp, 'f')


def field(name='a', offset=0, datatype=7, count=1):
    point_field = get_typestore(Stores.ROS2_JAZZY).types['sensor_msgs/msg/PointField']
    return point_field(name, offset, datatype, count)


@pytest.mark.parametrize(
    ('changes', 'words'),
    [
        ({'height': 2}, 'height is 2'),
        ({'width': 4}, '4 rows of 4 bytes make 16'),
        ({'point_step': 3}, 'does not fit point_step 3'),
        ({'row_step': 13}, 'row_step is 13'),
        ({'is_bigendian': True}, 'big-endian'),
        ({'fields': []}, 'no fields'),
        ({'fields': [field(datatype=9)]}, 'datatype 9'),
        ({'fields': [field(datatype=8)]}, 'does not fit'),
        ({'fields': [field(offset=2)]}, 'does not fit'),
        ({'fields': [field(count=2)]}, 'count 2'),
        ({'fields': [field(datatype=1), field(datatype=2)]}, 'make no table'),
        ({'data': np.zeros(11, np.uint8)}, '11 bytes of rows'),
        ({'data': np.zeros(0, np.uint8), 'point_step': 0}, 'does not fit'),
        ({'fields': [field(f'c{n}') for n in range(1025)]}, 'has 1025 fields: the limit is 1024'),
        ({'fields': [field('x' * 257)]}, "named 'xxxxxxxxxxxxxxxxxxxx': a name has 1 to 256"),
        ({'fields': [field('a\n')]}, 'printable characters'),
        ({'fields': [field('')]}, "named ''"),
        ({'point_step': 1 << 21}, 'point_step is 2097152: the limit is 1048576'),
    ],
)
def test_an_inconsistent_message_is_refused(changes, words):
    rows = np.zeros(3, [('a', '<f4')])
    with pytest.raises(TableError, match=words):
        decode_table(cloud_by_rosbags(rows, STAMP, 'f', **changes))


def test_cut_bytes_are_refused_at_every_length():
    data = encode_table(random_rows(ALL_TYPES, 3), STAMP, 'frame')
    for length in range(len(data)):
        with pytest.raises(TableError):
            decode_table(data[:length])


def test_flipped_bits_give_a_table_or_a_table_error():
    data = encode_table(random_rows(ALL_TYPES, 3), STAMP, 'frame')
    for bit in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[bit // 8] ^= 1 << bit % 8
        with contextlib.suppress(TableError):
            assert decode_table(bytes(flipped)).rows.nbytes <= len(data)
