"""The command: tables, report, words and exit codes."""

import contextlib
import csv
import io
import re

import forms
import numpy as np
import pytest

from gear_dynamics.recordings.command import main

pytest.importorskip('pandas')

RATE = 12800.0
MACHINE = """\
machine: motor
sample_rate: 12800
channels:
  housing: {column: x, unit: m/s2}
shafts:
  motor: {speed_rpm: 1800}
bearings:
  A: {shaft: motor, orders: {outer: 3.585, inner: 5.415, element: 4.714, cage: 0.398}}
severity: {standard: ISO 10816-3, group: 2, support: rigid}
"""


def damaged_bearing(order=3.60, duration=3.0, rate=RATE, seed=1):
    """Return noise, and impacts at an order of a shaft of 30 revolutions/s that ring at 3 kHz."""
    random = np.random.default_rng(seed)
    t = np.arange(int(duration * rate)) / rate
    x = random.normal(size=len(t)) + 3 * np.sin(2 * np.pi * 30 * t)
    for impact in np.arange(0.01, duration - 0.02, 1 / (30 * order)):
        # Rolling elements slip: the instants scatter by half a percent of their distance.
        first = int((impact + random.normal() * 0.005 / (30 * order)) * rate)
        ring = np.arange(100) / rate
        x[first : first + 100] += 8 * np.exp(-ring * 1500) * np.sin(2 * np.pi * 3000 * ring)
    return x


@pytest.fixture
def analyse(tmp_path):
    def run(values, machine=MACHINE, columns='x'):
        if values is not None:
            np.savetxt(tmp_path / 'a.csv', values, '%.6g', ',', header=columns, comments='')
        (tmp_path / 'machine.yaml').write_text(machine, encoding='utf-8')
        arguments = [str(tmp_path / 'a.csv'), '--machine', str(tmp_path / 'machine.yaml')]
        return main([*arguments, '--output', str(tmp_path / 'out')])

    return run


@pytest.fixture(scope='module')
def diagnosis(tmp_path_factory):
    """Return what is said of a damaged bearing, and the folder with the results."""
    folder = tmp_path_factory.mktemp('diagnosis')
    np.savetxt(folder / 'a.csv', damaged_bearing(), '%.6g', header='x', comments='')
    (folder / 'machine.yaml').write_text(MACHINE, encoding='utf-8')
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        code = main(
            [
                *(str(folder / 'a.csv'), '--machine', str(folder / 'machine.yaml')),
                *('--output', str(folder / 'out')),
            ]
        )
    assert code == 0
    return said.getvalue(), folder / 'out'


def test_a_fault_is_named_in_words_and_table(diagnosis):
    said, folder = diagnosis
    assert '! bearing A on channel housing: clear signs of a fault of the outer race' in said
    assert 'zone' in said
    with (folder / 'indicators.csv').open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 3
    assert float(rows[0]['housing/A_outer_order']) == pytest.approx(3.60, abs=0.02)
    units = dict(csv.reader((folder / 'units.csv').open()))
    assert units['housing/rms'] == 'm/s2'
    assert set(rows[0]) == set(units) - {'column'}


def test_the_parquet_file_holds_the_same_table(diagnosis):
    if forms.pyarrow is None:
        pytest.skip('pyarrow is not there')
    import pandas as pd

    parquet = pd.read_parquet(diagnosis[1] / 'indicators.parquet')
    text = pd.read_csv(diagnosis[1] / 'indicators.csv')
    np.testing.assert_allclose(parquet['housing/rms'], text['housing/rms'])


def test_the_report_stands_alone(diagnosis):
    page = (diagnosis[1] / 'report.html').read_text(encoding='utf-8')
    assert re.findall(r'(?:src|href)="(?!data:)', page) == []
    assert 'http' not in re.sub(r'base64,[^"]*', '', page)
    assert page.count('<img') >= 4
    assert 'bearing A on channel housing' in page
    assert 'x of a.csv' in page


def test_a_healthy_bearing_has_no_fault(analyse, capsys):
    noise = np.random.default_rng(2).normal(size=int(3 * RATE))
    assert analyse(noise) == 0
    said = capsys.readouterr().out
    assert 'no fault stands out' in said
    assert '!' not in said.replace('! channel', '')  # noise this loud is in zone D


def test_only_the_orders_that_are_given_are_watched(analyse, tmp_path, capsys):
    machine = MACHINE.replace(', element: 4.714, cage: 0.398', '')
    assert analyse(damaged_bearing(), machine) == 0
    assert 'fault of the outer race' in capsys.readouterr().out
    header = (tmp_path / 'out' / 'indicators.csv').read_text(encoding='utf-8').splitlines()[0]
    watched = re.findall(r'housing/A_(\w+)_level', header)
    assert watched == ['outer', 'inner']


def test_one_channel_that_fails_is_said_and_the_others_go_on(analyse, capsys):
    machine = MACHINE.replace('channels:', 'channels:\n  cover: {column: y}')
    assert analyse(damaged_bearing(), machine) == 0
    assert "not analysed: channel cover: a.csv has no column 'y'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('column: x', 'column: y', "no column 'y'"),
        ('sample_rate: 12800\n', '', 'states no sample rate'),
        ('motor: {speed', 'motor: {sped', 'no key'),
        ('shaft: motor', 'shaft: pump', "names 'pump'"),
    ],
)
def test_where_nothing_can_be_analysed_there_is_one_line_and_exit_code_2(
    analyse, capsys, old, new, words
):
    assert old in MACHINE
    assert analyse(damaged_bearing(duration=0.5), MACHINE.replace(old, new)) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count('\n') == 1


def test_a_recording_that_is_not_there(analyse, capsys):
    assert analyse(None) == 2
    assert 'does not exist' in capsys.readouterr().err


@pytest.mark.parametrize(
    ('values', 'words'),
    [
        (np.zeros(12800), 'channel housing is all zeros'),
        (np.full(12800, 2.0), 'channel housing is constant at 2 m/s2'),
        (5 + np.random.default_rng(1).normal(size=12800), 'has an offset of'),
    ],
)
def test_channels_that_tell_nothing_are_said_so(analyse, capsys, values, words):
    assert analyse(values) == 0
    assert words in capsys.readouterr().out
