import json

import pytest

from gear_dynamics.machine.rig import rig_machine
from gear_dynamics.monitoring.baseline import Baseline, BaselineError, machine_text

RIG = rig_machine(34, 59, 6e-4, 6e-3, 150e-6, 33844.0)
OTHER = rig_machine(20, 59, 6e-4, 6e-3, 150e-6, 33844.0)


def learned(machine='a'):
    baseline = Baseline(3, machine)
    for value in (1.0, 2.0, float('nan'), 3.0, 100.0):
        baseline.learn((5, 7), 'x/rms', value)
    return baseline


def test_the_first_values_are_learned_and_no_more():
    baseline = learned()
    assert baseline.normal((5, 7), 'x/rms') == (2.0, 1.0, 3)
    assert baseline.mean((5, 7), 'x/rms') == 2.0
    baseline.learn((5, 8), 'x/rms', 1.0)
    assert baseline.normal((5, 8), 'x/rms') is None
    assert list(baseline.bins.values()) == [True, False]
    baseline.forget()
    assert baseline.normal((5, 7), 'x/rms') is None


def test_a_file_keeps_what_was_learned(tmp_path):
    path = tmp_path / 'baseline.json'
    learned().save(path)
    again = Baseline(3, 'a')
    again.load(path)
    assert again.normal((5, 7), 'x/rms') == (2.0, 1.0, 3)
    assert [each.name for each in tmp_path.iterdir()] == ['baseline.json']


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / 'baseline.json'
    learned().save(path)
    before = path.read_text()

    def full(_):
        raise OSError(28, 'No space left on device')

    monkeypatch.setattr('os.fsync', full)
    with pytest.raises(OSError, match='No space'):
        learned('b').save(path)
    assert path.read_text() == before


def test_another_machine_is_refused(tmp_path):
    path = tmp_path / 'baseline.json'
    Baseline(3, machine_text(RIG, 51200.0)).save(path)
    with pytest.raises(BaselineError, match=r'pinion 34.*not to.*pinion 20') as caught:
        Baseline(3, machine_text(OTHER, 51200.0)).load(path)
    assert '\n' not in str(caught.value)


def test_no_file_yet_is_no_error(tmp_path):
    Baseline(3).load(tmp_path / 'none.json')


@pytest.mark.parametrize(
    'change',
    [
        {'form': 2},
        {'bins': 3},
        {'bins': [1]},
        {'bins': [{'speed': 'x', 'load': 1, 'values': {}}]},
        {'bins': [{'speed': True, 'load': 1, 'values': {}}]},
        {'bins': [{'speed': 1, 'load': 1, 'values': {'x/rms': 3}}]},
        {'bins': [{'speed': 1, 'load': 1, 'values': {'x/rms': [float('nan')]}}]},
        {'bins': [{'speed': 1, 'load': 1, 'values': {'x/rms': ['1']}}]},
    ],
)
def test_a_damaged_file_is_one_clear_line(tmp_path, change):
    path = tmp_path / 'baseline.json'
    learned().save(path)
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(BaselineError, match=r'baseline\.json') as caught:
        Baseline(3, 'a').load(path)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('text', ['', '{', '[' * 100_000, '\x00', '[1]', 'null'])
def test_what_is_no_baseline_is_refused(tmp_path, text):
    path = tmp_path / 'baseline.json'
    path.write_text(text)
    with pytest.raises(BaselineError):
        Baseline(3, 'a').load(path)
