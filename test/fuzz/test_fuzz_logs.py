"""Damaged logs: each reader gives what is sound, with a warning, or refuses in one line."""

import io
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pytest
from bag import bag_support
from fuzz.damage import CORPUS, check_refusal, damaged_bytes, damaged_logs
from hypothesis import given
from mcap.writer import CompressionType, Writer

from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.log import LogWarning
from gear_dynamics.bag.reader import read_log
from gear_dynamics.bag.recover import recover
from gear_dynamics.wire.messages import message_type

PUBLISHED = bag_support.messages(6)


def our_log(compression):
    with tempfile.TemporaryDirectory() as folder:
        log = bag_support.write_log(Path(folder), PUBLISHED, compression=compression)
        return next(log.glob('*.mcap')).read_bytes()


def other_log(**options):
    """Return a log as the MCAP library writes it."""
    stream = io.BytesIO()
    writer = Writer(stream, **options)
    writer.start(profile='ros2', library='other')
    channels = {}
    for number, each in enumerate(PUBLISHED):
        if each.topic not in channels:
            about = message_type(each.type_name)
            schema = writer.register_schema(each.type_name, 'ros2msg', about.definition.encode())
            channels[each.topic] = writer.register_channel(each.topic, 'cdr', schema)
        writer.add_message(
            channels[each.topic], each.log_time, each.data, each.publish_time, number
        )
    writer.finish()
    return stream.getvalue()


OURS = [our_log(compression) for compression in ('none', 'lz4', 'zstd')]
OTHERS = [
    other_log(use_chunking=False),
    other_log(compression=CompressionType.NONE, chunk_size=4000),
    other_log(compression=CompressionType.ZSTD, use_statistics=False, repeat_schemas=False),
]
CORPUS_LOGS = [path.read_bytes() for path in sorted(CORPUS.glob('*.mcap'))]


def readings(data):
    """Read with every reader; return the rows, the log that was recovered, and the warnings."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter('always')
        path = Path(folder, 'log.mcap')
        path.write_bytes(data)
        rows = lost = None
        for read in (log_info, read_log, lambda path: recover(path, Path(folder, 'saved'))):
            try:
                result = read(path)
            except LogError as error:
                check_refusal(error)
                continue
            if read is read_log:
                rows = result
            elif hasattr(result, 'lost'):
                lost = result.lost
        assert all(issubclass(warning.category, LogWarning) for warning in caught)
        assert len(caught) < 100
        return rows, lost, bool(caught)


@pytest.mark.parametrize('original', [*OURS, *OTHERS], ids=range(6))
def test_sound_logs_are_read_without_a_warning(original):
    rows, lost, warned = readings(original)
    assert len(rows) == 6 * bag_support.BLOCK
    assert not lost
    assert not warned


WHOLE = {row.tobytes() for row in readings(OURS[0])[0]}


@given(data=damaged_bytes(OURS))
def test_each_row_of_a_damaged_log_is_an_original_one_or_there_is_a_warning(data):
    rows, _, warned = readings(data)
    if rows is not None and not warned:
        assert {row.tobytes() for row in rows} == WHOLE


@given(data=damaged_logs([*OURS, *OTHERS, *CORPUS_LOGS]))
def test_records_that_make_no_sense_stop_no_reader(data):
    rows, _, _ = readings(data)
    assert rows is None or isinstance(rows, np.ndarray)


@given(data=damaged_bytes(CORPUS_LOGS))
def test_small_logs_of_other_writers_that_are_damaged_stop_no_reader(data):
    readings(data)
