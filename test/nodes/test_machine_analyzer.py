"""The analyzer with a machine file hears any columns of any publisher."""

import dataclasses

import pytest

pytest.importorskip('rclpy')

import ros_support

from gear_dynamics.bag.reader import read_log

MACHINE = ros_support.ROOT / 'examples' / 'machine.yaml'
PUBLISHER = str(ros_support.ROOT / 'examples' / 'machine_publisher.py')
ANALYZER = 'gear_dynamics.nodes.analyzer'


@dataclasses.dataclass
class Heard:
    conditions: list
    spectra: list
    numbers: list
    diagnostics: list
    folder: object


@pytest.fixture(scope='module')
def heard(tmp_path_factory):
    pytest.importorskip('rclpy', reason='rclpy is not installed')
    from diagnostic_msgs.msg import DiagnosticArray
    from sensor_msgs.msg import PointCloud2
    from std_msgs.msg import Float64

    folder = tmp_path_factory.mktemp('log')
    parameters = {
        'machine': MACHINE,
        'log_directory': folder,
        'log_free_floor': 0.0,
        'indicators': "['housing/first_harmonic_1']",
    }
    with (
        ros_support.free_domain() as domain,
        ros_support.Client(domain) as client,
        ros_support.Process(ANALYZER, domain, parameters) as analyzer,
    ):
        heard = Heard(
            client.collect(DiagnosticArray, 'gear_pair/condition'),
            client.collect(PointCloud2, 'gear_pair/spectrum'),
            client.collect(Float64, 'gear_pair/indicators/housing/first_harmonic_1'),
            client.collect(DiagnosticArray, '/diagnostics'),
            folder,
        )
        with ros_support.Process(PUBLISHER, domain, ros=False):
            ros_support.wait_until(lambda: len(heard.numbers) >= 2, 90, 'two spans')
        assert analyzer.stop() == 0
    return heard


def test_indicators_of_any_channels(heard):
    assert heard.numbers[0].data == pytest.approx(5, rel=0.05)
    names = [status.name for status in heard.conditions[0].status]
    assert names == [
        f'example_gearbox: {s}' for s in ('housing', 'cover', 'floor', 'input', 'output')
    ]


def test_spectra_have_the_channels_as_columns(heard):
    names = [field.name for field in heard.spectra[0].fields]
    assert names == ['frequency', 'housing', 'cover', 'floor', 'duration']


def test_stamps_of_a_wall_clock_are_no_gaps(heard):
    values = {
        value.key: value.value
        for message in heard.diagnostics
        for status in message.status
        for value in status.values
        if 'stream' in status.name
    }
    assert int(values['blocks']) > 50
    # A machine under load may hold a publisher up for more than half a block now and then.
    assert int(values['gaps']) < 0.1 * int(values['blocks'])


def test_the_stream_is_logged_as_it_came(heard):
    bag = next(path for path in heard.folder.iterdir() if path.is_dir())
    rows = read_log(bag, 'gear_pair/samples')
    assert {'housing', 'cover', 'floor', 'tacho'} <= set(rows.dtype.names)
    assert len(rows) >= 2 * 12800


def test_a_wrong_machine_file_is_one_line(tmp_path):
    path = tmp_path / 'machine.yaml'
    path.write_text('channels: {a: {unit: parsec}}\n')
    with (
        ros_support.free_domain() as domain,
        ros_support.Process(ANALYZER, domain, {'machine': path}) as analyzer,
    ):
        assert analyzer.wait(60) == 2
        assert "unit 'parsec' is not known" in analyzer.output
