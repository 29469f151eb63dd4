"""Faults near their limit are named once, and not from result to result."""

import re

import numpy as np
import pytest

from gear_dynamics.monitoring.baseline import Baseline
from gear_dynamics.monitoring.judge import Judge
from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.naming import CLEARED, Naming
from gear_dynamics.monitoring.operating import Judgement
from gear_dynamics.monitoring.results import StreamSpan
from gear_dynamics.monitoring.task import Condition, Row
from gear_dynamics.monitoring.thresholds import AlarmRule, Limit, Thresholds

BIN, OTHER = (3, 4), (5, 6)
RULE = AlarmRule(0.1, raised=2, of=3)


def judge(limit=None):
    limits = {'*/local_fault': limit or Limit(warn=0.5, error=0.75)}
    return Judge(Thresholds(limits, rule=RULE), Baseline(3))


def judged(made, values, teeth=None, bin_=BIN, name='local_fault'):
    """The rows of a gear with these values of an indicator, one after the other."""
    found = []
    for number, value in enumerate(values):
        tooth = 17 if teeth is None else teeth[number % len(teeth)]
        condition = Condition(name, 'local fault', value, tooth, 59)
        row = Row('gear', {name: value}, message='the teeth are alike', conditions=[condition])
        result = made.result(StreamSpan(number * 10**9, 1.0), (row,), Judgement('', bin_))
        found.append(result.rows[0])
    return found


def local(tooth):
    return Condition('local_fault', 'local fault', 0.6, tooth, 59)


def names(rows):
    """The messages without the number, each change once."""
    texts = [row.message.replace('0.4', '0.6') for row in rows]
    return [text for text, before in zip(texts, ['', *texts], strict=False) if text != before]


def test_a_fault_near_its_limit_is_named_once():
    made = judge()
    # A fault whose certainty is at the limit, and noise about it.
    values = 0.5 + 0.1 * np.sign(np.random.default_rng(3).normal(size=200))
    rows = judged(made, values, teeth=[17, 18, 17])
    assert re.match(r'gear, tooth 1[78]: local fault, 0.6; first seen 00:00:', names(rows)[-1])
    assert len(names(rows)) <= 3
    changes = made.thresholds.take_changes()
    assert [(each.before, each.after) for each in changes] == [(Level.OK, Level.WARN)]


def test_a_fault_that_is_gone_is_no_longer_named():
    made = judge()
    judged(made, [0.9] * 3)
    rows = judged(made, [0.0] * (CLEARED + 3))
    named = [row.message.startswith('gear, tooth 17') for row in rows]
    assert named == [True] * (CLEARED - 1) + [False] * 4
    assert [row.level for row in rows][-1] == Level.OK
    assert len(made.thresholds.take_changes()) == 2


def test_a_state_in_which_a_fault_never_showed_does_not_clear_it():
    made = judge()
    judged(made, [0.9] * 3)
    rows = judged(made, [0.0] * 20, bin_=OTHER)
    assert all(row.level == Level.ERROR for row in rows)
    assert judged(made, [0.0] * CLEARED)[-1].level == Level.OK


def test_one_finding_is_not_enough():
    rows = judged(judge(), [0.9, 0.0, 0.0, 0.0, 0.9])
    assert [row.message for row in rows] == [
        'gear, tooth 17: local fault, 0.9, found once',
        *['gear, tooth 17: local fault, 0.9, found once'] * 2,
        'the teeth are alike',
        'gear, tooth 17: local fault, 0.9, found once',
    ]
    assert all(row.level == Level.OK for row in rows)


def test_findings_of_different_teeth_are_different_faults():
    naming = Naming(2, 3)
    for number, tooth in enumerate([3, 20, 40, 3, 10, 50]):
        naming.update('gear', BIN, [local(tooth)], number)
    assert not naming.named('gear')
    # Tooth 0 is beside tooth 58.
    for number, tooth in enumerate([0, 58]):
        naming.update('gear', BIN, [local(tooth)], number)
    assert [fault.condition.tooth for fault in naming.named('gear')] == [0]


@pytest.mark.parametrize(('learned', 'value', 'level'), [(0, 12, 1), (50, 120, 0), (50, 160, 1)])
def test_a_learned_value_raises_the_limit(learned, value, level):
    """Three times what is normal, where that is more than the limit of a machine not known."""
    limit = Limit(warn=10.0, error=1e9, warn_times=3.0)
    made = judge(limit)
    judged(made, [learned] * 3)
    made.thresholds.acknowledge()
    assert judged(made, [value] * 2)[-1].level == level


def test_a_named_tooth_changes_only_for_one_found_much_more_often():
    naming = Naming(2, 3)
    teeth = []
    for number, tooth in enumerate([7, 7, 5, 5, 7, 5, 5, 5, 5, 5]):
        naming.update('gear', BIN, [local(tooth)], number)
        teeth += [fault.condition.tooth for fault in naming.named('gear')]
    # One fault all the time, told anew when tooth 5 was found seven times and tooth 7 three times.
    assert teeth == [7] * 8 + [5]
