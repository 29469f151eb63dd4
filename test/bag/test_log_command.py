"""The `log` executable: what its verbs print, write and refuse."""

import csv

import bag_support
import numpy as np
import pytest
from rosbags.rosbag2 import Reader

import gear_dynamics as gd
from gear_dynamics.bag.command import main
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.machine.columns import SAMPLES
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.wire.tables import TABLE_TYPE, columns_as_float32, encode_table

BLOCKS = 30


@pytest.fixture
def folder(tmp_path):
    return bag_support.write_log(tmp_path / 'logs', bag_support.messages(BLOCKS))


def cut(folder):
    """Cut the only file of a bag folder in the middle of its index."""
    (file,) = folder.glob('*.mcap')
    file.write_bytes(file.read_bytes()[:-500])
    return file


def test_info_tells_of_topics_and_configuration(folder, capsys):
    assert main(['info', str(folder)]) == 0
    lines = capsys.readouterr().out.splitlines()
    words = [line.split() for line in lines]
    span = (BLOCKS - 1) * bag_support.STEP + bag_support.STEP + 500_000
    assert ['state', 'whole'] in words
    assert ['duration', f'{span * 1e-9:.3f}', 's'] in words
    rate = 1e9 / bag_support.STEP  # of the topic, not of the log
    assert ['/gear_pair/samples', TABLE_TYPE, str(BLOCKS), f'{rate:.3f}', '0'] in words
    assert ['/gear_pair/configuration', 'std_msgs/msg/String', '1', '-', '0'] in words
    assert '    pinion_teeth: 34' in lines
    assert '  versions: numpy: 2' in lines


def test_info_finds_gaps_and_cuts(tmp_path, capsys):
    published = bag_support.messages(BLOCKS)
    gone = {bag_support.START + number * bag_support.STEP for number in (10, 11, 20)}
    kept = [m for m in published if not (m.topic.endswith('samples') and m.publish_time in gone)]
    folder = bag_support.write_log(tmp_path / 'logs', kept)
    assert main(['info', str(folder)]) == 0
    out = capsys.readouterr().out
    assert '/gear_pair/samples: +0.002500 s at' in out
    assert '/gear_pair/samples: +0.001250 s at' in out
    cut(folder)
    assert main(['info', str(folder)]) == 0
    out = capsys.readouterr().out
    assert 'cut or damaged' in out
    assert '/gear_pair/samples: +0.002500 s at' in out


@pytest.mark.parametrize('configured', [False, True])
@pytest.mark.parametrize('samples', [0, 1, -1, 20])
def test_info_finds_a_gap_of_a_single_sample(tmp_path, configured, samples):
    """Of a log of 40 s: t of float32 alone would be off by a sample at its end."""
    rate = 51201.0
    rows = np.zeros(512, SAMPLES)
    rows['t'] = np.arange(512) / rate
    rows = columns_as_float32(rows, 0.0)
    text = configuration_text(gd.GearPair(), SimSettings(sample_rate=rate, monitor_rate=rate / 3))
    (tmp_path / 'logs').mkdir()
    with LogWriter(tmp_path / 'logs', {'text': text if configured else ''}, free_floor=0.0) as log:
        for number in range(4000):
            late = samples if number >= 1000 else 0
            stamp = bag_support.START + round((number * 512 + late) / rate * 1e9)
            data = encode_table(rows, stamp, 'f')
            log.write('/gear_pair/samples', TABLE_TYPE, data, stamp, stamp)
    (topic,) = log_info(next((tmp_path / 'logs').iterdir())).topics
    assert [round(gap.duration * rate) for gap in topic.gaps] == [samples] * bool(samples)


def test_recover_writes_a_sound_log_beside_the_cut_one(folder, capsys):
    file = cut(folder)
    assert main(['recover', str(folder)]) == 0
    sound = folder.with_name(folder.name + '_recovered')
    assert capsys.readouterr().out.splitlines()[-1].endswith(str(sound))
    with Reader(sound) as reader:
        published = bag_support.messages(BLOCKS)
        assert [bytes(data) for _, _, data in reader.messages()] == [m.data for m in published]
    assert main(['recover', str(file), '--output', str(sound)]) == 2
    assert 'exists' in capsys.readouterr().err


def test_recover_says_what_was_lost(folder, capsys):
    (file,) = folder.glob('*.mcap')
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 1
    file.write_bytes(content)
    assert main(['recover', str(folder)]) == 2  # the only chunk
    assert 'no message that can be saved' in capsys.readouterr().err


@pytest.mark.parametrize('file_format', ['npz', 'csv'])
def test_export_of_one_topic(folder, tmp_path, capsys, file_format):
    output = tmp_path / 'out'
    arguments = ['--topic', 'gear_pair/samples', '--format', file_format]
    assert main(['export', str(folder), *arguments, '--output', str(output)]) == 0
    file = output / f'gear_pair_samples.{file_format}'
    assert capsys.readouterr().out.split() == [str(file)]
    assert list(output.iterdir()) == [file]
    rows = gd.read_log(folder)
    for name, values in columns_of(file).items():
        np.testing.assert_array_equal(values.astype(float), rows[name])


@pytest.mark.parametrize('file_format', ['npz', 'csv'])
def test_export_of_all_topics(folder, capsys, file_format):
    assert main(['export', str(folder), '--format', file_format]) == 0
    output = folder.with_name(folder.name + '_export')
    assert sorted(path.stem for path in output.iterdir()) == [
        'diagnostics',
        'gear_pair_cmd_speed',
        'gear_pair_configuration',
        'gear_pair_events',
        'gear_pair_samples',
    ]
    values = columns_of(output / f'diagnostics.{file_format}')
    assert values['key'].tolist() == ['blocks', 'gaps'] * (BLOCKS // 10)
    assert values['value'].tolist() == ['0', '0', '10', '0', '20', '0']
    text = columns_of(output / f'gear_pair_configuration.{file_format}')['data']
    assert text.tolist() == ['parameters:\n  pinion_teeth: 34\n']


def columns_of(file):
    if file.suffix == '.npz':
        with np.load(file) as content:
            return dict(content)
    with file.open(newline='', encoding='utf-8') as stream:
        names, *rows = csv.reader(stream)
    return {
        name: np.array(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)
    }


def test_a_log_of_which_nothing_is_left_gives_exit_code_2(folder, capsys):
    (file,) = folder.glob('*.mcap')
    file.write_bytes(file.read_bytes()[:20])
    for verb in ('info', 'export'):
        assert main([verb, str(file)]) == 2
        *_, last = capsys.readouterr().err.splitlines()
        assert last.startswith(('log: nothing in the log', 'log: the log has nothing'))


def sine_log(tmp_path, blocks):
    """Log of a run whose gear vibrates at the mesh frequency, with its configuration."""
    text = configuration_text(gd.GearPair(), SimSettings())
    published = []
    for number in range(blocks):
        samples = np.zeros(512, SAMPLES)
        samples['t'] = (number * 512 + np.arange(512)) / 51200
        samples['speed'] = 104.72
        samples['gear_ay'] = 100 * np.sin(104.72 * 34 * samples['t'])
        stamp = bag_support.START + number * 10_000_000
        data = encode_table(columns_as_float32(samples, samples['t'][0]), stamp, 'f')
        published.append(
            bag_support.Published(
                '/gear_pair/samples', TABLE_TYPE, data, stamp, stamp, bag_support.RELIABLE
            )
        )
    (tmp_path / 'logs').mkdir()
    with LogWriter(tmp_path / 'logs', {'text': text}, free_floor=0.0) as writer:
        for message in published:
            bag_support.hand_in(writer, message)
    return next((tmp_path / 'logs').iterdir())


def test_plot_draws_a_report(tmp_path, capsys):
    image = pytest.importorskip('matplotlib.image')
    folder = sine_log(tmp_path, 100)
    assert main(['plot', str(folder)]) == 0
    file = folder.with_name(folder.name + '.png')
    assert capsys.readouterr().out.split() == [str(file)]
    picture = image.imread(file)
    assert min(picture.shape[:2]) > 500
    assert picture[..., :3].std() > 0.05


def test_plot_of_a_constant_channel_says_nothing(tmp_path, recwarn, capsys):
    pytest.importorskip('matplotlib')
    assert main(['plot', str(sine_log(tmp_path, 40)), '--channel', 'mesh_force']) == 0
    assert capsys.readouterr().err == ''
    assert not recwarn.list


def test_the_spectrum_of_the_report_is_calibrated(tmp_path):
    from gear_dynamics.bag.log import Log
    from gear_dynamics.bag.report import find_rig, gather_segments

    with Log(sine_log(tmp_path, 100)) as log:
        segments = gather_segments(log, 'gear_ay')
        assert find_rig(log).pinion_teeth == 34
    spectrum = segments.steady_spectrum()
    frequency = 104.72 * 34 / (2 * np.pi)
    # A Hann window reads a sine between two lines up to 1.42 dB, that is 15 %, low.
    assert 85 < spectrum.max() <= 100.1
    assert abs(segments.frequency[spectrum.argmax()] - frequency) < segments.frequency[1]
    np.testing.assert_allclose(segments.rms, 100 / np.sqrt(2), rtol=0.01)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (['info', 'nowhere'], 'nowhere: there is no such file or folder'),
        (['info', 'JUNK'], 'junk: this is no MCAP file'),
        (['export', 'JUNK'], 'junk: this is no MCAP file'),
        (['export', 'LOG', '--topic', 'x'], "there is no topic 'x'"),
        (['plot', 'LOG'], 'fewer than 8192 samples in a row'),
        (['plot', 'LOG', '--output', '/proc/nothing/x.png'], 'fewer than'),
        (['recover', 'LOG', '--output', '/proc/nothing'], '/proc/nothing'),
        (['export', 'LOG', '--output', '/proc/nothing'], '/proc/nothing'),
    ],
)
def test_errors_are_one_line_and_exit_code_2(folder, capsys, arguments, words):
    (junk := folder.parent / 'junk').write_text('no log')
    given = [{'LOG': str(folder), 'JUNK': str(junk)}.get(a, a) for a in arguments]
    assert main(given) == 2
    out, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if not line.startswith('exporting')]
    assert len(lines) == 1
    assert words in lines[0]
    assert out == ''


def test_unknown_verbs_and_options_exit_with_2(capsys):
    for arguments in ([], ['tell'], ['info'], ['export', 'x', '--format', 'xlsx']):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 2
