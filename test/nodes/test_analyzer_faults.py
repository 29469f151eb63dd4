"""The analyzer under bad input: it lives, counts, and says what is wrong."""

import numpy as np
import ros_support
from mcap.reader import make_reader
from monitoring.streams import blocks, rotation, samples

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.wire.messages import deserialize
from gear_dynamics.wire.tables import decode_table, encode_table

ANALYZER = 'gear_dynamics.nodes.analyzer'
DIAGNOSTICS = 'diagnostic_msgs/msg/DiagnosticArray'


def latest(messages, name):
    for data in reversed(messages):
        for status in deserialize(data, DIAGNOSTICS).status:
            if status.name == name:
                return status
    return None


def values(status):
    return {each.key: each.value for each in status.values}


def listen(client):
    from diagnostic_msgs.msg import DiagnosticArray
    from sensor_msgs.msg import PointCloud2

    return (
        client.collect(DiagnosticArray, '/diagnostics', raw=True),
        client.collect(PointCloud2, 'gear_pair/spectrum', raw=True),
    )


def configure(client):
    """Publish the configuration."""
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import String

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    configuration = client.publisher(String, 'gear_pair/configuration', latched)
    configuration.publish(String(data=configuration_text(GearPair(), SimSettings())))


def feed(client, diagnostics, messages):
    """Publish the configuration, and once it is known message bytes as samples."""
    from sensor_msgs.msg import PointCloud2

    configure(client)
    publisher = client.publisher(PointCloud2, 'gear_pair/samples', 1000)

    def configured():
        status = latest(diagnostics, 'gear_analyzer: stream')
        return status and values(status)['configured'] == 'true'

    ros_support.wait_until(configured)
    for data in messages:
        publisher.publish(data)


def open_log(directory):
    """The messages of the log in a directory, with the names of their types, by topic."""
    found = {}
    for path in directory.glob('gear_log_*/*.mcap'):
        with path.open('rb') as file:
            for schema, channel, message in make_reader(file).iter_messages():
                found.setdefault(channel.topic, []).append((schema.name, message))
    return found


def encoded(stream):
    return [encode_table(rows, stamp, 'line_of_action') for stamp, rows in stream]


def test_bad_messages_and_a_gap_are_counted_and_the_node_lives(domain, client, tmp_path):
    diagnostics, spectra = listen(client)
    stream = list(blocks(samples(rotation(4.0))))
    not_finite = stream[60][1].copy()
    not_finite['gear_ax'][3] = np.inf
    messages = encoded(stream)
    bad = [
        messages[60][:200],
        encode_table(stream[60][1], -5_000_000_000, 'x'),
        encode_table(not_finite, stream[60][0], 'x'),
        encode_table(not_finite[['t', 'delta']], stream[60][0], 'x'),
        encode_table(not_finite[:0], stream[60][0], 'x'),
        messages[10],
    ]
    parameters = {'log_directory': tmp_path, 'log_free_floor': 0.0}
    with ros_support.Process(ANALYZER, domain, parameters) as analyzer:
        feed(client, diagnostics, messages[:60] + bad + messages[60:200] + messages[230:])

        def done():
            status = latest(diagnostics, 'gear_analyzer: stream')
            return status and int(values(status)['blocks']) == len(messages) - 30

        ros_support.wait_until(done, 60, 'every block')
        found = values(latest(diagnostics, 'gear_analyzer: stream'))
        assert analyzer.stop() == 0
        warnings = [line for line in analyzer.output.splitlines() if '[WARN]' in line]
    dropped = {key: value for key, value in found.items() if key.startswith('dropped')}
    kinds = {'no table': 2, 'not finite': 1, 'columns': 1, 'empty': 1, 'back': 1}
    assert dropped == {f'dropped: {kind}': str(count) for kind, count in kinds.items()}
    assert found['gaps'] == '1'
    assert found['missing_samples'] == str(30 * 512)
    # 0.72 s each, one every 0.64 s: three to the gap at 2 s, two after it
    stamps = [(decode_table(data).stamp_ns - stream[0][0]) / 1e9 for data in spectra]
    np.testing.assert_allclose(stamps, [0, 0.64, 1.28, 2.3, 2.94], atol=1e-6)
    log = open_log(tmp_path)
    for topic in ('/gear_pair/spectrum', '/gear_pair/condition'):
        messages = log[topic]
        assert messages
        # What bears a stamp is logged with it as the time of publication.
        assert all(
            publish_time == stamp.sec * 10**9 + stamp.nanosec
            for publish_time, stamp in (
                (each.publish_time, deserialize(each.data, name).header.stamp)
                for name, each in messages
            )
        )
    # What bears none, or that of the clock, is logged with the time of the stream.
    ends = {stamp + 10_000_000 for stamp, _ in stream}
    times = [each.publish_time for _, each in log['/diagnostics']]
    begun = times.index(next(time for time in times if time in ends))
    assert set(times[begun:]) <= ends
    assert len(warnings) == 1
    assert 'messages dropped so far, the last because' in warnings[0]


def test_blocks_that_overtake_the_configuration_wait_for_it(domain, client):
    from sensor_msgs.msg import PointCloud2

    diagnostics, spectra = listen(client)
    stream = list(blocks(samples(rotation(2.0))))
    with ros_support.Process(ANALYZER, domain, {'log': False}) as analyzer:
        publisher = client.publisher(PointCloud2, 'gear_pair/samples', 1000)

        def unconfigured():
            status = latest(diagnostics, 'gear_analyzer: stream')
            return status and status.message.startswith('samples come, but no configuration')

        ros_support.wait_until(lambda: publisher.get_subscription_count(), 90, 'the analyzer')
        for data in encoded(stream):
            publisher.publish(data)
        ros_support.wait_until(unconfigured)
        configure(client)
        ros_support.wait_until(lambda: spectra, 30, 'a spectrum')
        assert analyzer.stop() == 0
    assert decode_table(spectra[0]).stamp_ns == stream[0][0]


def test_a_namespace_makes_a_second_analyzer(domain, client):
    from sensor_msgs.msg import PointCloud2

    spectra = client.collect(PointCloud2, '/rig1/gear_pair/spectrum', raw=True)
    arguments = ['-r', '__ns:=/rig1']
    with (
        ros_support.Process('gear_dynamics.nodes.sim', domain, arguments=arguments),
        ros_support.Process(ANALYZER, domain, {'log': False}, arguments) as analyzer,
    ):
        ros_support.wait_until(lambda: spectra, 90, 'a spectrum of rig1')
        assert analyzer.stop() == 0


def test_wrong_input_at_the_start_gives_a_line_and_exit_code_2(domain, tmp_path):
    (tmp_path / 'limits.yaml').write_text('limits: {a/rms: {warn: 3, error: 2}}')
    (tmp_path / 'file').write_text('in the way')
    (tmp_path / 'names.yaml').write_text('limits: {"*/pinion_fm5": {warn: 3}}')
    cases = [
        (['-p', 'spectrum_window:=round'], ['spectrum_window', "'round'", "'hann'"]),
        (['-p', 'spectrum_lenght:=1024'], ['spectrum_lenght', 'spectrum_length']),
        (['-p', f'thresholds:={tmp_path}/limits.yaml'], ['a/rms', 'above error']),
        (['-p', f'thresholds:={tmp_path}/names.yaml'], ['pinion_fm5', 'pinion_fm4']),
        (['-p', "indicators:=['mesh_force/rsm']"], ['indicators', 'mesh_force/rms']),
        (['-p', f'log_directory:={tmp_path}/log'], ['log_directory', f'{tmp_path}/log', 'no such']),
        (['-p', f'log_directory:={tmp_path}/file'], ['log_directory', f'{tmp_path}/file']),
        (['-p', 'log_free_floor:=1e15'], ['log_directory', 'are free', 'make room']),
    ]
    for arguments, words in cases:
        with ros_support.Process(ANALYZER, domain, arguments=arguments) as analyzer:
            assert analyzer.wait(60) == 2, arguments
            lines = analyzer.output.splitlines()
            assert len(lines) == 1, analyzer.output
            assert all(word in lines[0] for word in words), lines[0]
