"""How fast logs are written and read, beside rosbags and mcap-ros2-support on the same messages.

Rates of writing are multiples of the default stream: 100 blocks/s of 512 samples x 13 float32.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer as Ros2Writer
from rosbags import rosbag2
from rosbags.rosbag2.enums import StoragePlugin
from rosbags.typesys import Stores, get_typestore

import gear_dynamics as gd
from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.wire.messages import deserialize, message_type
from gear_dynamics.wire.tables import SAMPLES_FLOAT32, TABLE_TYPE, columns_as_float32, encode_table

RATE = 51200
BLOCK = 512
BLOCKS_A_SECOND = RATE // BLOCK
BLOCK_NS = 10_000_000
TOPIC = '/gear_pair/samples'
TWO = ('t', 'delta')
START = 1_700_000_000_000_000_000


def simulated_rows(seconds: float) -> list[np.ndarray]:
    """Simulate the default pair, and cut the samples into blocks as they are published."""
    run = gd.simulate(gd.GearPair(), duration=seconds, sample_rate=float(RATE))
    blocks = [run[at : at + BLOCK] for at in range(0, len(run) - BLOCK + 1, BLOCK)]
    return [columns_as_float32(block, block['t'][0]) for block in blocks]


def messages(rows: list[np.ndarray], count: int) -> Iterator[tuple[int, bytes]]:
    """Iterate over stamps and messages, the rows over and over."""
    for number in range(count):
        stamp = START + number * BLOCK_NS
        yield stamp, encode_table(rows[number % len(rows)], stamp, 'line_of_action')


def fill(writer: LogWriter, blocks: Iterable[tuple[int, bytes]]) -> None:
    """Hand messages in as fast as they are written, so that none is dropped."""
    for number, (stamp, data) in enumerate(blocks):
        while number % 100 == 0 and writer.status().waiting > 1000:
            time.sleep(0.005)
        writer.write(TOPIC, TABLE_TYPE, data, stamp, stamp)


def write_ours(folder: Path, blocks: list[tuple[int, bytes]], compression: str) -> str:
    """Write with `LogWriter`, which also syncs to the disk; as fast as its queue empties."""
    writer = LogWriter(folder, {}, compression=compression, total_cap=1e12, free_floor=0.0)
    fill(writer, blocks)
    final = writer.close()
    return f'{final.messages} written, {final.dropped} lost'


def write_rosbags(folder: Path, blocks: list[tuple[int, bytes]]) -> str:
    store = get_typestore(Stores.ROS2_JAZZY)
    with rosbag2.Writer(folder / 'rosbags', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection(TOPIC, TABLE_TYPE, typestore=store)
        for stamp, data in blocks:
            writer.write(connection, stamp, data)
    return 'no compression, no sync'


def write_mcap_ros2(folder: Path, blocks: list[tuple[int, bytes]]) -> str:
    """Write decoded messages, which is the one way that mcap-ros2-support offers."""
    decoded = [(stamp, with_lists(data)) for stamp, data in blocks]
    with (folder / 'mcap_ros2.mcap').open('wb') as stream:
        writer = Ros2Writer(stream)
        definition = message_type(TABLE_TYPE).definition
        schema = writer.register_msgdef(TABLE_TYPE, definition)
        for stamp, message in decoded:
            writer.write_message(TOPIC, schema, message, log_time=stamp, publish_time=stamp)
        writer.finish()
    return 'zstd, no sync; encodes each message'


def with_lists(data: bytes) -> Any:
    """Return the decoded message in the form that mcap-ros2-support encodes."""
    message = deserialize(data, TABLE_TYPE)
    message.data = message.data.tolist()
    return message


class Timing(NamedTuple):
    """Seconds on the clock and of all cores, the second of which other programs bear less upon."""

    clock: float
    cpu: float
    result: Any


def timed(action: Callable[[], Any]) -> Timing:
    start, cpu = time.perf_counter(), time.process_time()
    result = action()
    return Timing(time.perf_counter() - start, time.process_time() - cpu, result)


def benchmark_writing(folder: Path, rows: list[np.ndarray], seconds: float) -> None:
    blocks = list(messages(rows, int(seconds * BLOCKS_A_SECOND)))
    size = sum(len(data) for _, data in blocks)
    print(f'\nwriting {len(blocks)} blocks, {size / 1e6:.0f} MB, {seconds:.0f} s of the stream')
    few = blocks[:300]
    cases: list[tuple[str, list, Callable]] = [
        ('LogWriter none', blocks, lambda b: write_ours(folder / 'none', b, 'none')),
        ('LogWriter lz4', blocks, lambda b: write_ours(folder / 'lz4', b, 'lz4')),
        ('LogWriter zstd', blocks, lambda b: write_ours(folder / 'zstd', b, 'zstd')),
        ('rosbags Writer', blocks, lambda b: write_rosbags(folder, b)),
        ('mcap-ros2-support', few, lambda b: write_mcap_ros2(folder, b)),
    ]
    message_type(TABLE_TYPE)  # loads the definitions, which takes 0.2 s once
    for name, given, write in cases:
        os.sync()  # what is still to be written is not this case's
        took = timed(lambda: write(given))  # noqa: B023 (called at once)
        streamed = len(given) / BLOCKS_A_SECOND
        rate = sum(len(data) for _, data in given) / 1e6 / took.clock
        print(
            f'  {name:<18} {streamed / took.clock:6.1f} x the stream, '
            f'{streamed / took.cpu:6.1f} x per core, {rate:5.0f} MB/s   {took.result}'
        )
    for compression in ('none', 'lz4', 'zstd'):
        used = sum(f.stat().st_size for f in (folder / compression).rglob('*.mcap'))
        print(f'  {compression:<5} leaves {100 * used / size:.0f} % of the bytes')


def read_rosbags(path: Path, count: int) -> int:
    store = get_typestore(Stores.ROS2_JAZZY)
    parts: list[np.ndarray] = []
    with rosbag2.Reader(path) as reader:
        for _, (connection, _, data) in zip(range(count), reader.messages(), strict=False):
            message: Any = store.deserialize_cdr(data, connection.msgtype)
            parts.append(np.frombuffer(message.data, SAMPLES_FLOAT32))
    return len(np.concatenate(parts))


def read_mcap_ros2(path: Path, count: int) -> int:
    parts = []
    with next(iter(sorted(path.glob('*_0.mcap')))).open('rb') as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, item in zip(range(count), reader.iter_decoded_messages(), strict=False):
            parts.append(np.frombuffer(item.decoded_message.data, SAMPLES_FLOAT32))
    return len(np.concatenate(parts))


def benchmark_reading(folder: Path, rows: list[np.ndarray], seconds: float) -> None:
    count = int(seconds * BLOCKS_A_SECOND)
    for compression in ('none', 'zstd'):
        target = folder / f'long_{compression}'
        with LogWriter(
            target, {}, compression=compression, total_cap=1e12, split_size=1e12, free_floor=0.0
        ) as writer:
            fill(writer, messages(rows, count))
        (bag,) = target.iterdir()
        size = count * len(next(messages(rows, 1))[1])
        on_disk = sum(file.stat().st_size for file in bag.glob('*.mcap'))
        print(f'\nreading {seconds / 60:.0f} min, {size / 1e6:.0f} MB of messages, {compression}')
        few = min(count, 2000)
        cases: list[tuple[str, int, Callable]] = [
            ('read_log, all columns', count, lambda b, _: len(gd.read_log(b))),
            ('read_log, t and delta', count, lambda b, _: len(gd.read_log(b, columns=TWO))),
            ('rosbags Reader', few, read_rosbags),
            ('mcap-ros2-support', few, read_mcap_ros2),
        ]
        for name, given, read in cases:
            took = timed(lambda: read(bag, given))  # noqa: B023 (called at once)
            assert took.result == given * BLOCK
            amount = given * size / count / 1e6
            print(
                f'  {name:<22} {amount / took.clock:6.0f} MB/s, {amount / took.cpu:6.0f} per core'
            )
        elapsed = fresh_info(bag)
        print(f'  log info, {on_disk / 1e9:.2f} GB   {elapsed:7.3f} s in a new process')
        shutil.rmtree(target)


def fresh_info(bag: Path) -> float:
    """Return how long `log_info` takes where nothing is loaded yet, imports not counted."""
    code = (
        'import sys, time; from gear_dynamics.bag.info import log_info\n'
        'start = time.perf_counter(); info = log_info(sys.argv[1])\n'
        'assert info.whole and info.messages; print(time.perf_counter() - start)'
    )
    root = str(Path(__file__).resolve().parents[1])
    environment = {**os.environ, 'PYTHONPATH': root}
    done = subprocess.run(
        [sys.executable, '-c', code, str(bag)],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or '').splitlines()[0])
    parser.add_argument('--folder', default=None, help='disk to measure (default: temporary)')
    parser.add_argument('--write-seconds', type=float, default=200.0, help='of the stream')
    parser.add_argument('--read-seconds', type=float, default=600.0, help='of the stream')
    arguments = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix='log_throughput_', dir=arguments.folder))
    try:
        rows = simulated_rows(2.0)
        benchmark_writing(folder, rows, arguments.write_seconds)
        benchmark_reading(folder, rows, arguments.read_seconds)
    finally:
        shutil.rmtree(folder)


if __name__ == '__main__':
    main()
