import math
from pathlib import Path

import pytest

from gear_dynamics.monitoring.task import Normal
from gear_dynamics.monitoring.thresholds import (
    AlarmRule,
    Level,
    Limit,
    ThresholdError,
    Thresholds,
)

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


def levels(thresholds, values, normal=None):
    return [int(thresholds.level('a', 'rms', value, normal)) for value in values]


def test_lower_limits_have_hysteresis_too():
    limit = Limit(below_warn=10, below_error=5)
    found = levels(Thresholds({'a/rms': limit}, 0.1), [10.1, 10, 10.9, 11.1, 4, 5.4, 5.6])
    assert found == [0, 1, 1, 0, 2, 2, 1]


def test_a_level_needs_n_of_the_last_m_values():
    thresholds = Thresholds({'a/rms': Limit(10, 20)}, rule=AlarmRule(0.0, raised=2, of=3))
    found = levels(thresholds, [11, 1, 1, 11, math.nan, 12, 1, 1, 25, 25, 11, 1])
    assert found == [0, 0, 0, 0, 0, 1, 1, 0, 0, 2, 2, 1]


def test_a_latched_level_waits_for_acknowledgement():
    thresholds = Thresholds({'a/rms': Limit(10, 20)}, rule=AlarmRule(latch=True))
    assert levels(thresholds, [1, 25, 1, 11]) == [0, 2, 2, 2]
    thresholds.acknowledge()
    assert levels(thresholds, [1, 11, 1]) == [0, 1, 1]


def test_each_change_of_level_is_told_once():
    thresholds = Thresholds({'a/rms': Limit(10, 20)})
    levels(thresholds, [1, 11, 12, 25, 1])
    changes = thresholds.take_changes()
    assert [(each.before, each.after, each.value) for each in changes] == [
        (0, 1, 11),
        (1, 2, 25),
        (2, 0, 1),
    ]
    assert thresholds.take_changes() == []


def test_a_relative_limit_needs_a_baseline_and_lies_beyond_its_scatter():
    limit = Limit(warn=2.0, error=4.0, relative=True)
    assert levels(Thresholds({'a/rms': limit}), [1e9]) == [0]
    # No scatter: 2 and 4 times the mean of 5.
    assert levels(Thresholds({'a/rms': limit}), [9.9, 10, 20], Normal(5.0, 0.0, 5)) == [0, 1, 2]
    # Student's t with 4 degrees of freedom exceeds 7.173 with probability 1e-3; a new value of a
    # normal distribution known by 5 has sqrt(1 + 1/5) times the scatter: 5 + 7.858 x 2 = 20.72.
    found = levels(Thresholds({'a/rms': limit}), [20.7, 20.8], Normal(5.0, 2.0, 5))
    assert found == [0, 2]


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
        ('limits: {a/rms: {below_warn: 1, below_error: 2}}', 'below_warn 1 is below below_error 2'),
        ('limits: {a/rms: {warn: 3, relative: 1}}', 'relative is 1'),
        ('persistence: [3, 2]', 'persistence is [3, 2]'),
        ('persistence: [true, 2]', 'persistence is [True, 2]'),
        ('latch: 1', 'latch is 1'),
        ('false_alarms: 0', 'false_alarms is 0'),
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


@pytest.mark.parametrize('mean', [None, 1.0, 4.0])
def test_the_bounds_told_are_where_the_level_changes(mean):
    limit = Limit(warn=10, error=20, below_warn=-1, warn_times=3, error_times=10)
    normal = None if mean is None else Normal(mean, 0.0, 5)
    bounds = Thresholds({'*/rms': limit}).bounds('a', 'rms', normal)
    assert set(bounds) == {'warn', 'error', 'below_warn'}
    for word, level in (('warn', 1), ('error', 2)):
        at = [bounds[word] - 1e-6, bounds[word]]
        assert [levels(Thresholds({'*/rms': limit}), [x], normal)[0] for x in at] == [
            level - 1,
            level,
        ]
    assert levels(Thresholds({'*/rms': limit}), [-1.0], normal) == [1]


def test_there_are_no_bounds_without_a_limit_or_before_it_is_learned():
    thresholds = Thresholds({'*/rms': Limit(2, 4, relative=True)})
    assert thresholds.bounds('a', 'peak') == thresholds.bounds('a', 'rms') == {}
