import math
from pathlib import Path

import pytest

from gear_dynamics.monitoring.thresholds import Level, Limit, ThresholdError, Thresholds

ROOT = Path(__file__).resolve().parents[2]


def test_a_level_is_left_below_its_limit_by_the_hysteresis():
    thresholds = Thresholds({'a/rms': Limit(10, 20)}, hysteresis=0.1)
    values = [9.9, 10, 9.5, 8.9, 9.5, 25, 18.1, 17.9, 8.9]
    expected = [0, 1, 1, 0, 0, 2, 2, 1, 0]
    assert [int(thresholds.level('a', 'rms', value)) for value in values] == expected


def test_a_channels_own_limit_goes_before_that_of_all():
    thresholds = Thresholds({'*/rms': Limit(1, 2), 'b/rms': Limit(10, 20)})
    assert thresholds.level('a', 'rms', 3) is Level.ERROR
    assert thresholds.level('b', 'rms', 3) is Level.OK
    assert thresholds.level('b', 'peak', 3) is Level.OK


def test_not_a_number_holds_the_level():
    thresholds = Thresholds({'*/fm4': Limit(1, 2)})
    assert thresholds.level('a', 'fm4', math.nan) is Level.OK
    assert thresholds.level('a', 'fm4', 3) is Level.ERROR
    assert thresholds.level('a', 'fm4', math.nan) is Level.ERROR


def test_the_packages_own_file_is_good():
    assert Thresholds.from_yaml(ROOT / 'config' / 'thresholds.yaml')


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('limits: [', 'is not YAML: line '),
        ('- 1', 'must be a mapping of limits and'),
        ('limit: {}', 'must be a mapping of limits and'),
        ('hysteresis: 1.5', 'hysteresis is 1.5'),
        ('limits: {rms: {warn: 1}}', "'rms' must be named SUBJECT/NAME"),
        ('limits: {a/rms: 3}', 'a/rms must be a mapping of warn, error'),
        ('limits: {a/rms: {warn: x}}', "a/rms warn is 'x'"),
        ('limits: {a/rms: {warn: 3, error: 2}}', 'warn 3 is above error 2'),
    ],
)
def test_a_bad_file_is_one_clear_line(tmp_path, text, words):
    path = tmp_path / 'thresholds.yaml'
    path.write_text(text)
    with pytest.raises(ThresholdError) as caught:
        Thresholds.from_yaml(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)
    assert '\n' not in str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(ThresholdError, match='none'):
        Thresholds.from_yaml(tmp_path / 'none.yaml')
