import math
from fractions import Fraction

import pytest

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.shaft import Angle, FixedSpeed, SpeedColumn, Tacho, TrackedSpeed
from gear_dynamics.machine.source import Source, Time

TEXT = """\
machine: test rig 1
sample_rate: 51200.0
span: 0.5
channels:
  housing: {column: housing_y, unit: m/s2}
  cover:   {file: 'cover*.wav', full_scale: 100.0, unit: m/s2}
  strain:  {column: 3, unit: V, sensitivity: 1.022e-2, quantity: m/s2}
shafts:
  input:  {tacho: {column: tacho, pulses: 1, level: 2.5}}
  output: {driven_by: first}
wheels:
  pinion: {shaft: input, teeth: 34}
  gear:   {shaft: output, teeth: 59}
meshes:
  first: [pinion, gear]
bearings:
  A: {shaft: input, elements: 9, element_diameter: 0.00794, pitch_diameter: 0.03904,
      channels: [housing], slip: 0.02}
  B: {shaft: output, orders: {outer: 3.585, inner: 5.415, element: 4.714, cage: 0.398}}
severity: {limits_mm_s: [2.3, 4.5, 7.1]}
"""


@pytest.fixture
def read(tmp_path):
    def read_text(text):
        path = tmp_path / 'machine.yaml'
        path.write_text(text, encoding='utf-8')
        return Machine.from_yaml(path)

    return read_text


def test_every_part_of_a_file_is_read(read):
    machine = read(TEXT)
    assert machine.name == 'test rig 1'
    assert machine.recording.sample_rate == 51200.0
    assert machine.recording.span == 0.5
    assert machine.channel('cover').source.file == 'cover*.wav'
    assert machine.channel('cover').scale == 100.0
    assert machine.channel('strain').source.column == 3
    assert machine.channel('strain').scale == pytest.approx(1 / 0.01022)
    assert machine.channel('strain').unit == 'm/s2'
    assert machine.shaft('input').speed == Tacho(Source('tacho'), 1.0, 2.5)
    assert machine.root('output')[1] == Fraction(34, 59)
    assert machine.bearings[0].orders['outer'] == pytest.approx(3.585, abs=1e-3)
    assert machine.bearings[1].orders['element'] == 4.714
    assert machine.severity.limits == pytest.approx((2.3e-3, 4.5e-3, 7.1e-3))
    assert [machine.severity.zone(v) for v in (1e-3, 4e-3, 5e-3, 8e-3)] == list('ABCD')


@pytest.mark.parametrize(
    ('text', 'speed'),
    [
        ('{speed_rpm: 1797}', FixedSpeed(1797 * math.pi / 30)),
        (
            '{speed_rpm: {nominal: 1400, within: 0.08}}',
            TrackedSpeed(1400 * 0.92 * math.pi / 30, 1400 * 1.08 * math.pi / 30),
        ),
        (
            '{track: {channel: housing, order: 34, from_rpm: 900, to_rpm: 1100}}',
            TrackedSpeed(30 * math.pi, 1100 * math.pi / 30, 'housing', 34.0),
        ),
        ("{speed: {column: '*RPM', unit: rpm}}", SpeedColumn(Source('*RPM'), 'rpm')),
        ('{angle: {column: enc, counts: 4096}}', Angle(Source('enc'), 4096.0)),
        ('{angle: {column: enc, unit: deg}}', Angle(Source('enc'), 360.0)),
        ('{}', None),
        ('', None),
    ],
)
def test_every_way_to_know_a_speed(read, text, speed):
    found = read(TEXT.replace('{tacho: {column: tacho, pulses: 1, level: 2.5}}', text))
    got = found.shaft('input').speed
    if isinstance(speed, TrackedSpeed):
        assert (got.lowest, got.highest) == pytest.approx((speed.lowest, speed.highest))
        assert (got.channel, got.order) == (speed.channel, speed.order)
    elif isinstance(speed, Angle):
        assert (got.source, got.revolution) == (speed.source, pytest.approx(speed.revolution))
    else:
        assert got == speed


def test_forms_of_recordings(read):
    machine = read(
        'time: {columns: [1, 2, 3, 4], units: [h, min, s, us]}\nspan: record\nfiles: series\n'
        'rows: {name: channel, samples: signal, rate: fs}\n'
        'channels: {a: {sample_rate: {column: bearing.sr}}}\n'
        'severity: {standard: ISO 10816-3, group: 2, support: rigid}\n'
    )
    assert machine.recording.time == Time((1, 2, 3, 4), ('h', 'min', 's', 'us'))
    assert machine.recording.span is None
    assert machine.recording.files == 'series'
    assert machine.recording.rows.rate == 'fs'
    assert machine.channel('a').source.sample_rate == 'bearing.sr'
    assert machine.channel('a').unit == 'unknown'
    assert machine.severity.limits == pytest.approx((1.4e-3, 2.8e-3, 4.5e-3))


ORDERS = '{outer: 3.585, inner: 5.415, element: 4.714, cage: 0.398}'


def test_orders_of_a_bearing_may_be_some_of_them(read):
    machine = read(TEXT.replace(ORDERS, '{inner: 5.415, outer: 3.585}'))
    assert machine.bearings[1].orders == {'outer': 3.585, 'inner': 5.415}


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('channels:', 'chanels:', "no key 'chanels': did you mean 'channels'"),
        ('teeth: 34', 'teeth: 34.5', 'wheel pinion: teeth is 34.5: it must be a whole number'),
        ('teeth: 34', 'teeth: -3', 'wheel pinion has -3 teeth'),
        ('teeth: 34', 'tooth: 34', "wheel pinion has no key 'tooth'"),
        ('unit: V', 'unit: volts/g', "channel strain: unit 'volts/g' is not known"),
        (', quantity: m/s2', '', 'sensitivity and quantity belong together'),
        ('sample_rate: 51200.0', 'sample_rate: 0', 'sample_rate is 0: it must be'),
        ('[pinion, gear]', '[pinion]', 'mesh first has 1 wheels'),
        ('column: 3', 'column: 0', 'counted from 1'),
        ('elements: 9', 'elements: 1', 'bearing A: elements is 1'),
        ('outer: 3.585', 'outer: 0', 'bearing B: orders: outer is 0'),
        ('outer: 3.585', 'auter: 3.585', "orders has no key 'auter': did you mean 'outer'"),
        (ORDERS, '{}', 'bearing B: orders is empty: give one of outer, inner, element, cage'),
        ('driven_by: first', 'driven_by: third', "names 'third'"),
        ('{driven_by: first}', '{driven_by: first, speed_rpm: 3}', 'one of them must go'),
        ('[2.3, 4.5, 7.1]', '[2.3, 1.5, 7.1]', 'must rise'),
        ('span: 0.5', 'span: [1]', 'span is'),
        ('pulses: 1,', 'pulses: none,', 'pulses is'),
    ],
)
def test_a_wrong_file_is_refused_in_one_line_that_names_it(read, old, new, words):
    assert old in TEXT
    with pytest.raises(ValueError, match=words) as caught:
        read(TEXT.replace(old, new))
    assert '\n' not in str(caught.value)
    assert 'machine.yaml' in str(caught.value)


@pytest.mark.parametrize('text', ['', '3', '[1]', 'channels: {}', 'a: ['])
def test_other_text_is_refused(read, text):
    with pytest.raises(ValueError, match=r'machine\.yaml: '):
        read(text)


def test_shafts_that_drive_each_other_are_refused(read):
    text = TEXT.replace('{tacho: {column: tacho, pulses: 1, level: 2.5}}', '{driven_by: first}')
    with pytest.raises(ValueError, match='in a circle: input, output'):
        read(text)


@pytest.mark.parametrize(
    'speed',
    [
        '{tacho: {column: tacho, pulses: 1, level: 2.5}}',
        '{angle: {column: enc, counts: 4096}}',
        '{speed: {column: rpm, unit: Hz}}',
        '{track: {channel: housing, order: 34, from_rpm: 900, to_rpm: 1100}}',
        '{speed_rpm: 1797}',
        '{inertia: 0.1}',
    ],
)
def test_a_machine_comes_back_from_its_mapping(read, speed):
    machine = read(TEXT.replace('{tacho: {column: tacho, pulses: 1, level: 2.5}}', speed))
    again = Machine.from_mapping(machine.to_mapping())
    assert again.to_mapping() == machine.to_mapping()
    assert again.channels == machine.channels
    assert again.bearings == machine.bearings
