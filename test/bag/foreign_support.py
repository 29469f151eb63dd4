"""MCAP files as other writers make them: by `mcap.writer` with its options, and by hand."""

import io
import itertools
import struct
import zlib

import lz4.frame
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Channel, DataEnd, Footer, Header, Message, Metadata, Schema
from mcap.writer import MCAP0_MAGIC, CompressionType, IndexType, Writer

from gear_dynamics.wire.messages import message_class, serialize

STRING = 'std_msgs/msg/String'
START = 1_600_000_000_000_000_000
QOS_NUMBERS = (
    '- history: 3\n  depth: 0\n  reliability: 1\n  durability: 2\n'
    '  deadline:\n    sec: 2147483647\n    nsec: 4294967295\n'
    '  lifespan:\n    sec: 2147483647\n    nsec: 4294967295\n'
    '  liveliness: 1\n'
    '  liveliness_lease_duration:\n    sec: 2147483647\n    nsec: 4294967295\n'
    '  avoid_ros_namespace_conventions: false'
)
"""As rosbag2 of Humble writes it."""


def text_message(number):
    return serialize(message_class(STRING)(f'hello {number}'))


def string_log(
    topic='/chatter',
    type_name=STRING,
    count=20,
    times=None,
    metadata=None,
    encoding='cdr',
    schema=True,
    profile='ros2',
    data=text_message,
    **options,
):
    """Return the bytes of a log of texts, written with any options of `mcap.writer.Writer`."""
    stream = io.BytesIO()
    writer = Writer(stream, **options)
    writer.start(profile, 'another writer')
    number = writer.register_schema(type_name, 'ros2msg', b'string data\n') if schema else 0
    channel = writer.register_channel(topic, encoding, number, metadata or {})
    for sequence, time in enumerate(range(count) if times is None else times):
        at = START + time * 100_000_000
        writer.add_message(channel, at, data(sequence), at + 7, sequence)
    writer.finish()
    return stream.getvalue()


def writer_options():
    """Iterate over combinations of the writer's options, those of every conformance feature."""
    flags = ('use_chunking', 'use_statistics', 'use_summary_offsets', 'repeat_channels')
    for values in itertools.product((False, True), repeat=len(flags)):
        for index in (IndexType.NONE, IndexType.ALL, IndexType.CHUNK, IndexType.MESSAGE):
            options = dict(zip(flags, values, strict=True))
            yield {
                **options,
                'repeat_schemas': options['repeat_channels'],
                'index_types': index,
                'compression': CompressionType.ZSTD,
                'chunk_size': 200,
            }


def record(item, padding=b''):
    """Return the bytes of a record, with bytes that a later version may have appended."""
    builder = RecordBuilder()
    item.write(builder)
    data = builder.end()
    length = struct.pack('<Q', len(data) - 9 + len(padding))
    return data[:1] + length + data[9:] + padding


def raw_record(opcode, content):
    return struct.pack('<BQ', opcode, len(content)) + content


def chunk(records, compression='', data=None, size=None, start=START, end=START + 10**10):
    """Return a chunk record; data and size may contradict the records."""
    packers = {'': bytes, 'lz4': lz4.frame.compress, 'zstd': zstandard.compress}
    data = packers[compression](records) if data is None else data
    size = len(records) if size is None else size
    head = struct.pack('<QQQII', start, end, size, zlib.crc32(records), len(compression))
    content = head + compression.encode() + struct.pack('<Q', len(data)) + data
    return raw_record(Opcode.CHUNK, content)


def file_of(*records, summary=b'', profile='ros2'):
    """Return a file of records, with a summary section if there is one, and a footer."""
    data = MCAP0_MAGIC + record(Header(profile, 'by hand')) + b''.join(records)
    data += record(DataEnd(0))
    start = len(data) if summary else 0
    footer = record(Footer(start, 0, 0))
    crc = zlib.crc32(footer[:-4], zlib.crc32(summary))
    return data + summary + record(Footer(start, 0, crc)) + MCAP0_MAGIC


def string_schema(number=1, type_name=STRING):
    return Schema(number, b'string data\n', 'ros2msg', type_name)


def string_channel(number=1, topic='/chatter', schema=1):
    return Channel(number, topic, 'cdr', {}, schema)


def string_record(number, channel=1):
    at = START + number * 100_000_000
    return record(Message(channel, at, text_message(number), at, number))


def configuration(content):
    return record(Metadata('gear_dynamics', content))
