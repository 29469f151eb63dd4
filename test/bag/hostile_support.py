"""MCAP files made to exhaust memory, time or patience, and all readers of the package on them.

Run as a script: `python hostile_support.py DIRECTORY [WORD...]` reads every file whose name has one
of the words (by default, all) with every reader, prints each failure that is not a clean refusal,
and at last the number of files and the largest memory in MB.
"""

import contextlib
import io
import itertools
import resource
import struct
import sys
import time
import traceback
import warnings
from pathlib import Path

import bag_support
import foreign_support as other
import lz4.frame
import numpy as np
import zstandard
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex, Message, Statistics

from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.command import main as log_command
from gear_dynamics.bag.log import Log
from gear_dynamics.bag.mcap_file import configuration_checksum
from gear_dynamics.bag.qos import first_profile
from gear_dynamics.bag.reader import read_log, read_messages
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.wire.messages import MessageError, deserialize, message_class, serialize
from gear_dynamics.wire.tables import TABLE_TYPE, columns_as_float32, encode_table

HUGE = (2**31, 2**36, 2**62, 2**63 - 1, 2**63, 2**64 - 1)
HEAD = other.record(other.string_schema()) + other.record(other.string_channel())
MESSAGES = b''.join(other.string_record(n) for n in range(5))
BOMB = 1 << 28
"""Bytes into which a small frame grows; more than the reader allows."""
SLOW = 60.0
"""Seconds of CPU after which a reader counts as hanging."""


def zeros(size, compression):
    """Return a frame of zeros that does not state its size."""
    block, parts = bytes(1 << 20), []
    if compression == 'zstd':
        packer = zstandard.ZstdCompressor(write_content_size=False).compressobj()
        parts = [packer.compress(block) for _ in range(size >> 20)] + [packer.flush()]
    else:
        packer = lz4.frame.LZ4FrameCompressor()
        parts = [packer.begin()] + [packer.compress(block) for _ in range(size >> 20)]
        parts.append(packer.flush())
    return b''.join(parts)


def bombs():
    for compression in ('zstd', 'lz4'):
        bomb = zeros(BOMB, compression)
        for size in (1000, 1 << 27, BOMB - 1, BOMB, *HUGE):
            name = f'{compression} bomb of 256 MiB that claims {size}'
            yield name, other.file_of(other.chunk(b'', compression, bomb, size))
        packed = other.chunk(b'', compression, bomb, BOMB)
        yield f'six {compression} chunks of 256 MiB', other.file_of(*[packed] * 6)
    stated = zstandard.compress(bytes(BOMB))
    yield 'stated size', other.file_of(other.chunk(b'', 'zstd', stated, 1000))
    message = Message(1, other.START, stated, other.START, 0)
    yield 'message bomb', other.file_of(HEAD, *[other.record(message)] * 20)
    inner = other.record(Chunk('zstd', zeros(BOMB, 'zstd'), 1, 1, 0, 1000))
    yield 'bomb in the index', other.file_of(HEAD, MESSAGES, summary=inner)
    yield 'compressed file', zeros(BOMB, 'zstd')
    yield 'no compression', other.file_of(other.chunk(HEAD + MESSAGES, '', size=1 << 40))


def lengths():
    sound = other.file_of(other.chunk(HEAD + MESSAGES, 'zstd'), HEAD, MESSAGES)
    for value, at in itertools.product(HUGE, range(9, 60, 4)):
        content = bytearray(sound)
        content[at : at + 8] = struct.pack('<Q', value)
        yield f'{value} at {at}', bytes(content)
    for value in HUGE:
        for opcode in Opcode:
            record = struct.pack('<BQ', opcode, value) + bytes(100)
            yield f'{opcode.name} of {value}', other.file_of(HEAD, MESSAGES, record)
        name = struct.pack('<HHI', 7, 1, value & 0xFFFFFFFF) + bytes(50)
        yield f'name of {value}', other.file_of(HEAD, other.raw_record(Opcode.CHANNEL, name))
        footer = struct.pack('<BQQQI', 2, 20, value, value, 0)
        yield f'index at {value}', sound[:-37] + footer + sound[-8:]


def indexes():
    packed = other.chunk(HEAD + MESSAGES, 'zstd')
    start = 8 + len(other.record(other.Header('ros2', 'by hand')))

    whole, plain = len(packed), len(HEAD + MESSAGES)

    def about(offset=start, length=whole, more=0, size=plain):
        return other.record(
            ChunkIndex(length, offset, 'zstd', 10, other.START * 2, more, {1: 5}, 0, size)
        )

    def statistics(count, counts, channels=1, chunks=1):
        return other.record(
            Statistics(0, channels, counts, chunks, count, other.START, other.START, 0, 1)
        )

    yield '20 000 indexes of one chunk', other.file_of(packed, summary=HEAD + about() * 20_000)
    for value in HUGE:
        for field in ('offset', 'length', 'more', 'size'):
            summary = HEAD + about(**{field: value})
            yield f'index with {field} {value}', other.file_of(packed, summary=summary)
        claim = statistics(value, {1: value})
        yield f'{value} messages', other.file_of(packed, summary=HEAD + claim + about())
    for numbers in ({1: 2**63}, {9: 3}, {}, dict.fromkeys(range(1000), 2**64 - 1)):
        claim = statistics(sum(numbers.values()) % 2**64, numbers)
        yield f'statistics {len(numbers)}', other.file_of(packed, summary=HEAD + claim + about())
    yield 'index of nothing', other.file_of(packed, summary=HEAD)
    yield 'random index', other.file_of(packed, summary=np.random.default_rng(1).bytes(1000))


def names():
    for topic in ('a\0b', '/a\nb\x1b[2J', 'x' * 5_000_000, '', '/', '../../x', '/\u202e', 'ä' * 99):
        yield f'topic {topic[:9]!r}', other.string_log(topic)
        yield f'type {topic[:9]!r}', other.string_log(type_name=topic)
        yield f'encoding {topic[:9]!r}', other.string_log(encoding=topic)
        metadata = {topic: topic, 'offered_qos_profiles': topic}
        yield f'metadata {topic[:9]!r}', other.string_log(metadata=metadata)
    channels = [other.record(other.string_channel(n, f'/t{n}')) for n in range(1, 20_000)]
    schema = other.record(other.string_schema())
    yield '20 000 channels', other.file_of(schema, *channels, MESSAGES)
    yield 'no slash and slash', other.file_of(
        schema, *(other.record(other.string_channel(n, t)) for n, t in ((1, 'a'), (2, '/a'))),
        MESSAGES, other.string_record(3, 2),
    )  # fmt: skip
    for at in (0, 1, 2**63, 2**64 - 1):
        message = Message(1, at, other.text_message(0), 2**64 - 1 - at, 2**32 - 1)
        yield f'time {at}', other.file_of(HEAD, MESSAGES, other.record(message))


def texts():
    laughs = 'a0: &a0 [x, x]\n' + ''.join(
        f'a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n' for n in range(1, 40)
    )
    for text in ('[' * 100_000, '- ' * 100_000, laughs, 'x: ' + '9' * 5000, 'a: &a [*a]', '\0'):
        metadata = {'offered_qos_profiles': text}
        yield f'QoS {text[:9]!r}', other.string_log(metadata=metadata)
        for content in (
            {'configuration': text, 'log_time': '5'},
            {'configuration': text},
            {'a\nb\x1b': text, 'log_time': '9' * 5000},
            {'a': text, 'log_time': '-1'},
            {'a': text, 'log_time': '٣'},
        ):
            content['crc32'] = configuration_checksum(content)
            note = other.configuration(content)
            yield f'configuration {text[:9]!r} {list(content)}', other.file_of(HEAD, note, MESSAGES)
        message = serialize(message_class(other.STRING)(text))
        record = other.record(Message(1, other.START, message, other.START, 0))
        topic = '/gear_pair/configuration'
        named = other.record(other.string_schema()) + other.record(other.string_channel(1, topic))
        yield f'text {text[:9]!r}', other.file_of(named, record)


def cloud(fields, **values):
    """Return the bytes of a cloud of given fields (name, offset, datatype, count)."""
    field = message_class('sensor_msgs/msg/PointField')
    header = message_class('std_msgs/msg/Header')(
        message_class('builtin_interfaces/msg/Time')(values.pop('sec', 5), values.pop('nsec', 0)),
        'f',
    )
    content = {
        'height': 1,
        'width': 2,
        'fields': [field(*each) for each in fields],
        'is_bigendian': False,
        'point_step': 8,
        'row_step': 16,
        'data': np.zeros(16, np.uint8),
        'is_dense': True,
    }
    return serialize(message_class(TABLE_TYPE)(header=header, **{**content, **values}))


def table_log(datas, topic='/gear_pair/samples'):
    schema = other.record(other.string_schema(1, TABLE_TYPE))
    channel = other.record(other.string_channel(1, topic))
    messages = [
        other.record(Message(1, other.START + n, data, other.START + n, n))
        for n, data in enumerate(datas)
    ]
    return other.file_of(other.chunk(schema + channel + b''.join(messages), 'zstd'))


def clouds():
    pair = [('t', 0, 7, 1), ('x', 4, 7, 1)]
    for name, fields in (
        ('20 000 fields', [(f'f{n}', 0, 7, 1) for n in range(20_000)]),
        ('long name', [('t', 0, 7, 1), ('x' * 70_000, 4, 7, 1)]),
        ('alike', [('t', 0, 7, 1), ('t', 4, 7, 1)]),
        ('empty name', [('', 0, 7, 1), ('t', 4, 7, 1)]),
        ('odd names', [('a\0b', 0, 7, 1), ('../x\n', 4, 7, 1)]),
        ('types', [('t', 0, 200, 1), ('x', 4, 0, 1)]),
        ('counts', [('t', 0, 7, 2**32 - 1), ('x', 4, 7, 0)]),
        ('offsets', [('t', 2**32 - 1, 7, 1), ('x', 2**31, 7, 1)]),
        ('overlap', [('t', 0, 8, 1), ('x', 1, 7, 1)]),
        ('bytes as t', [('t', 0, 1, 1), ('x', 4, 7, 1)]),
        ('none', []),
    ):
        yield name, table_log([cloud(fields)])
    for values in (
        {'width': 2**32 - 1},
        {'height': 2**32 - 1},
        {'point_step': 2**32 - 1},
        {'point_step': 0, 'row_step': 0, 'data': np.zeros(0, np.uint8)},
        {'width': 0, 'row_step': 0, 'data': np.zeros(0, np.uint8), 'point_step': 2**32 - 1},
        {'row_step': 2**32 - 1},
        {'is_bigendian': True},
        {'sec': -1},
        {'sec': -(2**31), 'nsec': 2**32 - 1},
    ):
        yield f'cloud with {values}', table_log([cloud(pair, **values)] * 3)
    whole = cloud(pair)
    yield 'cut clouds', table_log([whole[:n] for n in range(len(whole))])
    samples = bag_support.block_of_samples(0)
    for value in (np.nan, np.inf, -np.inf, 1e300, 3e38, 1e-42):
        for column in ('t', 'speed', 'gear_ay'):
            spoilt = samples.copy()
            spoilt[column] = value
            with np.errstate(over='ignore'):
                rows = columns_as_float32(spoilt, 0.0)
            datas = [encode_table(rows, 10**9 * n, 'f') for n in range(150)]
            yield f'{column} of {value}', table_log(datas)
    rows = columns_as_float32(np.zeros(512, samples.dtype), 0.0)
    stamps = (0, 2**31 * 10**9 - 1, 5, 10**18)
    yield 'stamps', table_log([encode_table(rows, stamp, 'f') for stamp in stamps * 40])


def messages():
    """Yield logs of other types, with sizes in the CDR that are not there or are too many."""
    status = message_class('diagnostic_msgs/msg/DiagnosticStatus')
    pair = message_class('diagnostic_msgs/msg/KeyValue')
    many = bag_support.diagnostics(5, 1)
    many.status = [status(0, 'a', 'b', 'c', [pair(str(n), 'x') for n in range(20_000)])]
    wide = bag_support.diagnostics(5, 1)
    long = pair('k', 'x' * 1_000_000)
    wide.status = [status(0, 'a', 'b', 'c', [long, *(pair('k', 'v') for _ in range(2_000))])]
    array = message_class('std_msgs/msg/Float64MultiArray')
    layout = message_class('std_msgs/msg/MultiArrayLayout')([], 0)
    numbers = array(layout, np.zeros(1_000_000))
    for name, datas in (
        (bag_support.DIAGNOSTICS, [serialize(many)]),
        (bag_support.DIAGNOSTICS, [serialize(wide)] * 3),
        ('std_msgs/msg/Float64MultiArray', [serialize(numbers)]),
        ('std_msgs/msg/String', [b'', bytes(3), bytes(4), b'\0\1\0\0\xff\xff\xff\xff', bytes(99)]),
        ('sensor_msgs/msg/JointState', [bytes(n) for n in range(60)]),
        ('sensor_msgs/msg/JointState', [b'\0\1\0\0' + b'\xff' * n for n in range(80)]),
        ('std_msgs/msg/UInt64', [b'\0\1\0\0' + b'\xff' * 8, b'\0\1\0\0' + bytes(8)]),
    ):
        schema = other.record(other.string_schema(1, name))
        channel = other.record(other.string_channel(1, '/gear_pair/condition'))
        records = [
            other.record(Message(1, other.START + n, data, other.START + n, n))
            for n, data in enumerate(datas)
        ]
        yield f'{name} {len(datas)}', other.file_of(schema, channel, *records)


def hostile_files():
    """Iterate over names and contents of all files."""
    for group in (bombs, lengths, indexes, names, texts, clouds, messages):
        for name, content in group():
            yield f'{group.__name__}: {name}', content


def read_rows(path, scratch):
    with Log(path) as log:
        topics = log.topics()
    for topic in itertools.islice(topics, 3):
        with contextlib.suppress(LogError):
            read_log(path, topic)
        with contextlib.suppress(LogError):
            read_log(path, topic, start=1.0, end=2.0)


def replay(path, scratch):
    """Do what the replay node does with each message."""
    for message in read_messages(path):
        first_profile(message.channel.qos)
        with contextlib.suppress(MessageError):
            text = getattr(deserialize(message.data, message.channel.type_name), 'data', None)
            if isinstance(text, str):
                with contextlib.suppress(ValueError):
                    Rig.from_text(text)


def command(verb, *options, output=None):
    def run(path, scratch):
        target = ['--output', str(scratch / output)] if output else []
        code = log_command([verb, str(path), *options, *target])
        if code not in (0, 1, 2):
            raise AssertionError(f'exit code {code}')

    return run


READERS = {
    'rows': read_rows,
    'replay': replay,
    'info': command('info'),
    'quick': command('info', '--quick'),
    'recover': command('recover', output='sound'),
    'npz': command('export', output='npz'),
    'csv': command('export', '--format', 'csv', output='csv'),
    'plot': command('plot', output='plot.png'),
}


def failure(read, path, scratch):
    """Return what went wrong in a reader, in one line; empty if it read or refused cleanly."""
    begin = time.process_time()
    out, err = io.StringIO(), io.StringIO()
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            read(path, scratch)
    except LogError as error:
        return 'two lines' if '\n' in str(error) else ''
    except Exception:
        return traceback.format_exc(limit=-3).replace('\n', ' | ')
    took = time.process_time() - begin
    if took > SLOW:
        return f'took {took:.1f} s'
    if any(
        len(line) > 5000 or '\x1b' in line for line in (out.getvalue() + err.getvalue()).split('\n')
    ):
        return 'printed what a terminal should not get'
    return ''


def main(directory, words):
    warnings.simplefilter('ignore')
    count = 0
    for name, content in hostile_files():
        if not any(word in name for word in words):
            continue
        folder = directory / str(count)
        folder.mkdir()
        (path := folder / 'hostile.mcap').write_bytes(content)
        for reader, read in READERS.items():
            reason = failure(read, path, folder)
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
            if reason:
                print(f'{name}; {reader}; {memory} MB: {reason}', flush=True)
        path.unlink()
        count += 1
    print(count, memory)


if __name__ == '__main__':
    main(Path(sys.argv[1]), sys.argv[2:] or [''])
