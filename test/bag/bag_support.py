"""Small logs with known content."""

import dataclasses

import numpy as np
from mcap.reader import make_reader

from gear_dynamics.bag.metadata import OfferedQos
from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.machine.columns import EVENTS, SAMPLES
from gear_dynamics.wire.messages import message_class, serialize
from gear_dynamics.wire.tables import TABLE_TYPE, columns_as_float32, encode_table

RATE = 51200.0
BLOCK = 64
START = 1_700_000_000_000_000_000
STEP = 1_250_000  # 64 / 51200 s in ns, a whole number
STRING = 'std_msgs/msg/String'
FLOAT = 'std_msgs/msg/Float64'
DIAGNOSTICS = 'diagnostic_msgs/msg/DiagnosticArray'
RELIABLE = OfferedQos()
CONFIGURATION = {'parameters': 'pinion_teeth: 34\nseed: 1', 'versions': 'numpy: 2'}
LATCHED = OfferedQos(1, 'reliable', 'transient_local')


@dataclasses.dataclass(frozen=True)
class Published:
    topic: str
    type_name: str
    data: bytes
    log_time: int
    publish_time: int
    qos: OfferedQos


def block_of_samples(number):
    """Return the samples of a block: random, all different, with t in seconds of the run."""
    values = np.random.default_rng(number).normal(size=(BLOCK, len(SAMPLES.names)))
    samples = values.astype(np.float32).astype(float).view(SAMPLES).reshape(-1)
    samples['t'] = (number * BLOCK + np.arange(BLOCK)) / RATE
    return samples


def block_of_events(number):
    events = np.zeros(number % 3, EVENTS)
    events['t'] = np.arange(len(events)) * 1e-4
    events['kind'], events['delta'] = number % 5, number * 1e-6
    return events


def messages(blocks, step=STEP):
    """Return what a small rig publishes: configuration, samples, events, diagnostics, commands."""
    text = message_class(STRING)('parameters:\n  pinion_teeth: 34\n')
    published = [
        Published('/gear_pair/configuration', STRING, serialize(text), START, START, LATCHED)
    ]
    for number in range(blocks):
        stamp = START + number * step
        arrival = stamp + STEP + 500_000
        samples = block_of_samples(number)
        rows = columns_as_float32(samples, samples['t'][0])
        for name, table in (('samples', rows), ('events', block_of_events(number))):
            data = encode_table(table, stamp, 'line_of_action')
            topic = f'/gear_pair/{name}'
            published.append(Published(topic, TABLE_TYPE, data, arrival, stamp, OfferedQos(100)))
        if number % 10 == 0:
            data = serialize(diagnostics(stamp, number))
            published.append(Published('/diagnostics', DIAGNOSTICS, data, arrival, stamp, RELIABLE))
            data = serialize(message_class(FLOAT)(float(number)))
            published.append(
                Published('/gear_pair/cmd/speed', FLOAT, data, arrival, arrival, RELIABLE)
            )
    return published


def diagnostics(stamp, number):
    time = message_class('builtin_interfaces/msg/Time')(*divmod(stamp, 10**9))
    header = message_class('std_msgs/msg/Header')(time, '')
    pairs = [('blocks', str(number)), ('gaps', '0')]
    values = [message_class('diagnostic_msgs/msg/KeyValue')(*pair) for pair in pairs]
    status = message_class('diagnostic_msgs/msg/DiagnosticStatus')
    return message_class(DIAGNOSTICS)(header, [status(0, 'gear_sim: stream', 'ok', '', values)])


def write_log(directory, published, **options):
    """Write messages with a `LogWriter`; return the bag folder."""
    options.setdefault('free_floor', 0.0)
    with LogWriter(directory, CONFIGURATION, **options) as writer:
        for message in published:
            hand_in(writer, message)
        final = writer.close()
    assert final.reason == ''
    folder = next(path for path in directory.iterdir() if path.is_dir())
    latched = {message.topic for message in published if message.qos == LATCHED}
    repeated = number_of(bag_files(folder)[-1]) * len(latched)
    assert (final.dropped, final.messages, final.waiting) == (0, len(published) + repeated, 0)
    return folder


def bag_files(folder):
    return sorted(folder.glob('*.mcap'), key=number_of)


def number_of(file):
    return int(file.stem.rsplit('_', 1)[1])


def with_repeats(published, folder):
    """Return what stands in the log: each file but the first begins with the configuration."""
    expected, place = list(published), 0
    for file in bag_files(folder):
        with file.open('rb') as stream:
            about = make_reader(stream).get_summary().statistics
        if place:
            again = dataclasses.replace(published[0], log_time=about.message_start_time)
            expected.insert(place, again)
        place += about.message_count
    return expected


def hand_in(writer, message):
    writer.write(
        message.topic,
        message.type_name,
        message.data,
        message.log_time,
        message.publish_time,
        message.qos,
    )
