"""`gd.write_log`: what is read back is the run, and other readers of bags take it."""

import numpy as np
import pytest
import yaml
from rosbags.rosbag2 import Reader

import gear_dynamics as gd
from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.log import Log
from gear_dynamics.bag.report import find_rig
from gear_dynamics.wire.messages import deserialize


@pytest.fixture(scope='module')
def run():
    return gd.simulate(gd.GearPair(), duration=0.03, sample_rate=51200.0, speed=300.0)


def test_samples_and_events_come_back(run, tmp_path):
    folder = gd.write_log(run, tmp_path / 'log', start=1.7e9)
    rows = gd.read_log(folder)
    assert len(rows) == len(run) == 1536
    for name in run.samples.dtype.names[1:]:
        np.testing.assert_array_equal(rows[name], run[name].astype(np.float32))
    # float32 of t within a block of 10 ms holds 1e-9 s
    np.testing.assert_allclose(rows['t'], run['t'] - run['t'][0], atol=2e-9)
    events = gd.read_log(folder, 'gear_pair/events')
    assert len(events) == len(run.events) > 0
    np.testing.assert_allclose(events['t'], run.events['t'] - run['t'][0], atol=2e-9)
    for name in ('kind', 'delta', 'delta_dot', 'cycle'):
        np.testing.assert_array_equal(events[name], run.events[name])


def test_the_log_is_sound_and_tells_of_the_rig(run, tmp_path):
    folder = gd.write_log(run, tmp_path / 'log', start=1.7e9)
    info = log_info(folder)
    assert info.whole
    assert {topic.name: topic.messages for topic in info.topics} == {
        '/gear_pair/configuration': 1,
        '/gear_pair/events': 3,
        '/gear_pair/label': 1,
        '/gear_pair/samples': 3,
    }
    assert all(topic.gaps == () for topic in info.topics)
    with Log(folder) as log:
        rig = find_rig(log)
        first = next(message for _, message in log.messages())
    assert first.channel.topic == '/gear_pair/configuration'
    assert (rig.pinion_teeth, rig.sample_rate, rig.block_size) == (34, 51200.0, 512)
    with Reader(folder) as reader:
        assert reader.message_count == 8
    text = info.configurations[0]['configuration']
    assert yaml.safe_load(text)['parameters']['speed'] == 300.0


def test_labels_of_the_faults_are_there_once_a_second(tmp_path):
    faults = [gd.faults.RootCrack('gear', tooth=7, severity=0.4), gd.faults.Wear(severity=0.1)]
    run = gd.simulate(gd.GearPair(), 2.1, sample_rate=2560.0, faults=faults, anti_alias=False)
    folder = gd.write_log(run, tmp_path / 'log', start=1.7e9)
    with Log(folder) as log:
        found = [m for _, m in log.messages() if m.channel.topic == '/gear_pair/label']
    assert len(found) == 3
    label = deserialize(found[0].data, 'diagnostic_msgs/msg/DiagnosticArray')
    assert [status.name for status in label.status] == [
        'gear_pair: root_crack',
        'gear_pair: wear',
    ]
    values = {each.key: each.value for each in label.status[0].values}
    assert values == run.labels[0].values()


def test_the_same_run_gives_the_same_bytes(run, tmp_path):
    contents = [
        (gd.write_log(run, tmp_path / each / 'log', start=5.0) / 'log_0.mcap').read_bytes()
        for each in ('a', 'b')
    ]
    assert contents[0] == contents[1]


def test_a_part_of_a_block_at_the_end_and_an_odd_rate(tmp_path):
    run = gd.simulate(gd.GearPair(), duration=0.02, sample_rate=51201.0)
    folder = gd.write_log(run, tmp_path / 'log')
    assert len(gd.read_log(folder)) == len(run)
    assert all(topic.gaps == () for topic in log_info(folder).topics)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'compression': 'gzip'}, "compression is 'gzip': it must be one of none, lz4, zstd"),
        ({'start': -1.0}, 'start is -1.0: it must be'),
        ({'start': float('nan')}, 'start is nan: it must be'),
        ({'run': 3}, 'run is a int: it must be what gd.simulate returns'),
        ({'folder': '.'}, r'\. exists: choose another folder'),
    ],
)
def test_what_cannot_be_written_is_named(run, tmp_path, arguments, words):
    with pytest.raises(LogError, match=words):
        gd.write_log(**{'run': run, 'folder': tmp_path / 'log', **arguments})
    assert not (tmp_path / 'log').exists()
