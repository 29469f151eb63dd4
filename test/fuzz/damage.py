"""What may happen to bytes, to the records of an MCAP file, and to texts."""

import struct
import zlib
from pathlib import Path

from hypothesis import strategies as st

CORPUS = Path(__file__).parent / 'corpus'
"""Small texts and logs of many forms: in them, most damage hits structure and not content."""

MAGIC = b'\x89MCAP0\r\n'
CHUNK = 6
SIZES = (0, 1, 2, 9, 255, 2**16, 2**31 - 1, 2**31, 2**32 - 1, 2**36, 2**62, 2**63, 2**64 - 1)
"""Lengths, offsets and counts that a writer never means."""


@st.composite
def damaged_bytes(draw, originals):
    """Bytes with a few places overwritten, cut out, doubled or inserted, or the end cut off."""
    data = bytearray(draw(st.sampled_from(originals)))
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, max(len(data) - 1, 0)))
        length = draw(st.integers(1, 40))
        kind = draw(st.sampled_from(('flip', 'size', 'number', 'cut', 'double', 'insert', 'end')))
        if kind == 'flip':
            data[place : place + 1] = bytes([draw(st.integers(0, 255))])
        elif kind == 'size':
            data[place : place + 4] = struct.pack('<I', draw(st.sampled_from(SIZES)) % 2**32)
        elif kind == 'number':
            data[place : place + 8] = struct.pack('<Q', draw(st.sampled_from(SIZES)))
        elif kind == 'cut':
            del data[place : place + length]
        elif kind == 'double':
            data[place:place] = data[place : place + length]
        elif kind == 'insert':
            data[place:place] = draw(st.binary(min_size=1, max_size=length))
        else:
            del data[place:]
    return bytes(data)


def check_refusal(error):
    """A refusal is one line, of our own wording."""
    assert str(error).strip()
    assert '\n' not in str(error)
    assert not isinstance(error, UnicodeError)


def split(data):
    """Return the records of bytes without damage, as [opcode, content] each."""
    records, at = [], 0
    while at + 9 <= len(data):
        opcode, length = struct.unpack_from('<BQ', data, at)
        records.append([opcode, bytes(data[at + 9 : at + 9 + length])])
        at += 9 + length
    return records


def join(records):
    return b''.join(struct.pack('<BQ', opcode, len(data)) + data for opcode, data in records)


@st.composite
def damaged_records(draw, records):
    """Records with some left out, doubled, moved, retyped, or their content damaged."""
    records = [list(record) for record in records]
    for _ in range(draw(st.integers(1, 3))):
        place = draw(st.integers(0, len(records) - 1)) if records else 0
        kind = draw(st.sampled_from(('drop', 'double', 'move', 'retype', 'content', 'content')))
        if not records:
            break
        if kind == 'drop':
            del records[place]
        elif kind == 'double':
            records.insert(place, list(records[place]))
        elif kind == 'move':
            records.insert(draw(st.integers(0, len(records) - 1)), records.pop(place))
        elif kind == 'retype':
            records[place][0] = draw(st.integers(0, 255))
        else:
            records[place][1] = draw(damaged_bytes([records[place][1]]))
    return records


@st.composite
def damaged_logs(draw, originals):
    """MCAP files whose records are damaged, with lengths and checksums that fit nevertheless."""
    records = split(draw(st.sampled_from(originals))[len(MAGIC) : -len(MAGIC)])
    chunks = [i for i, (opcode, _) in enumerate(records) if opcode == CHUNK]
    if chunks and draw(st.booleans()):
        record = records[draw(st.sampled_from(chunks))]
        record[1] = draw(_damaged_chunks(record[1]))
    else:
        records = draw(damaged_records(records))
    return MAGIC + join(records) + MAGIC


@st.composite
def _damaged_chunks(draw, content):
    """A chunk of a file without compression, whose inner records are damaged."""
    times, (size, _) = content[:16], struct.unpack_from('<QI', content, 16)
    (length,) = struct.unpack_from('<I', content, 28)
    inner = content[32 + length + 8 :]
    if len(inner) != size:  # compressed: damage what says so
        return draw(damaged_bytes([content]))
    inner = join(draw(damaged_records(split(inner))))
    size = draw(st.sampled_from((len(inner), len(inner), len(inner), *SIZES)))
    name = draw(st.sampled_from((b'', b'', b'', b'zstd', b'lz4', b'none')))
    head = struct.pack('<QII', size, zlib.crc32(inner), len(name)) + name
    return times + head + struct.pack('<Q', len(inner)) + inner


TOKENS = (
    *('*a', '&a', '<<: *a', '!!python/object:os.system x', '!!binary x', '- ', '{', '}', '[', ']'),
    *('1e999', '-1', 'nan', '.inf', '0x10', '1_000', '9' * 5000, 'true', 'null', '~', "''", '?'),
    *('|', '\t', '\n', '\0', '\ufeff', '\u2028', ': ', '#', '---', '...', '%YAML 9.9'),
    *('[' * 200, 'a: ' * 50),
)


@st.composite
def damaged_texts(draw, originals):
    """Texts with words, lines and marks of YAML replaced, doubled, cut or put in."""
    text = draw(st.sampled_from(originals))
    for _ in range(draw(st.integers(1, 4))):
        begin = draw(st.integers(0, len(text)))
        end = draw(st.integers(begin, min(begin + 30, len(text))))
        same = st.just(text[begin:end])
        put = draw(st.one_of(st.sampled_from(TOKENS), st.text(max_size=10), same))
        text = text[:begin] + put * draw(st.integers(0, 2)) + text[end:]
    return text
