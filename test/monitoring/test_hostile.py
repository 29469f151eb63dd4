"""Streams that no machine sends: nothing in them ends the work of the monitor."""

import dataclasses
import time
import warnings

import numpy as np
import pytest
from streams import RATE, RIG, START_NS, blocks, rotation, samples

from gear_dynamics.machine.columns import EVENTS
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import TableResult
from gear_dynamics.monitoring.statistics_task import StatisticsTask
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings

SLOWEST = 2.0  # seconds a block may take at most, far beyond what any takes


def monitor(**settings):
    made = Monitor(AnalyzerSettings(regime_cycles=64, **settings), Thresholds({}))
    made.configure(RIG)
    return made


def fed(made, stream):
    results = []
    for stamp, rows in stream:
        begin = time.monotonic()
        results += made.add_block(stamp, rows)
        assert time.monotonic() - begin < SLOWEST
    return results


def spoilt(column, values):
    rig = samples(rotation(1.2))
    rig[column] = values(np.arange(len(rig)))
    return rig


@pytest.mark.parametrize(
    ('column', 'values'),
    [
        *((angle, change)
          for angle in ('pinion_angle', 'gear_angle')
          for change in (
              lambda k: 1e6 * k,
              lambda k: -1e6 * k,
              lambda k: np.where(k < 30000, 0.0, 1e10),
              lambda k: 3.0 * k,
              lambda k: 0.0 * k,
              lambda k: np.random.default_rng(0).uniform(0, 6.28, len(k)),
          )),
        *(('delta', lambda k, c=c: c + 0.0 * k) for c in (0.0, 1e-42, 1e-300, 1e12, -1e12)),
        *(('delta_dot', lambda k, c=c: c + 0.0 * k) for c in (0.0, 1e-42)),
        *(('mesh_force', lambda k, c=c: c * (-1.0) ** k) for c in (1e-42, 1e-300, 1e12)),
        ('speed', lambda k: 1e12 * (-1.0) ** k),
        ('load_torque', lambda k: 1e12 * (-1.0) ** k),
        ('pinion_ax', lambda k: np.where(k == 20000, 1e12, 0.0)),
    ],
)  # fmt: skip
def test_absurd_values_do_no_harm(column, values):
    made = monitor()
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        results = fed(made, blocks(spoilt(column, values)))
    assert made.health.failed == {}
    assert [r for r in results if isinstance(r, TableResult) and r.name == 'spectrum']
    # What follows is analysed as if nothing had been.
    later = fed(made, blocks(samples(rotation(1.2)), start_ns=START_NS + 10**10))
    assert [r for r in later if isinstance(r, TableResult) and r.name == 'spectrum']


@pytest.mark.parametrize('value', [3e38, -3e38, 1e13])
def test_a_finite_but_absurd_block_is_dropped_and_counted(value):
    stream = list(blocks(samples(rotation(1.2))))
    stream[10][1]['delta'][3] = value
    made = monitor()
    fed(made, stream)
    assert made.health.dropped == {'absurd': 1}
    assert 'delta is' in made.health.last_fault
    assert 'in row 3' in made.health.last_fault


def test_a_block_of_a_million_rows_is_dropped():
    made = monitor()
    rows = samples(rotation(20.0))[:1_000_000]
    assert made.add_block(START_NS, rows) == []
    assert made.health.dropped == {'too long': 1}


def test_a_column_of_another_type_is_dropped():
    rows = next(blocks(samples(rotation(1.2))))[1]
    texts = rows.astype([(n, 'S4' if n == 'delta' else np.float32) for n in rows.dtype.names])
    made = monitor()
    assert made.add_block(START_NS, texts) == []
    assert made.health.dropped == {'columns': 1}


@pytest.mark.parametrize('t', [1e9, -1e9, 1e308])
def test_events_of_another_age_are_dropped(t):
    made = monitor()
    rows = np.zeros(3, EVENTS)
    rows['t'][1] = t
    assert made.add_events(START_NS, rows) == []
    assert made.health.dropped == {'events': 1}


@pytest.mark.parametrize('name', ['delta', 'delta_dot', 'cycle'])
@pytest.mark.parametrize('values', [(1e12, -1e12, 0.0), (0.0, 0.0, 0.0), (5.0, 4.0, 3.0)])
def test_absurd_events_do_no_harm(name, values):
    made = monitor()
    for stamp, block in list(blocks(samples(rotation(1.2)))):
        made.add_block(stamp, block)
        rows = np.zeros(3, EVENTS)
        rows['cycle'] = round((stamp - START_NS) / 1e7) * 3 + np.arange(3)
        rows['t'] = [0.0, 0.003, 0.006]
        rows[name] = values
        made.add_events(stamp, rows)
    assert made.health.failed == {}


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        *(({'pinion_teeth': teeth}, 'teeth') for teeth in (3, 10**6, 10**300)),
        ({'gear_teeth': 1001}, 'wheel gear has 1001 teeth'),
        *(({'sample_rate': rate}, 'sample_rate') for rate in (1e-300, 1e12)),
        ({'block_size': 10**9}, 'block_size'),
        ({'section_phase': 7.0}, 'section_phase'),
        *(({'gear_inertia': inertia}, 'inertia of shaft gear') for inertia in (1e7, 1e300)),
        *(({'half_backlash': b}, 'half_backlash') for b in (1e-300, 1e300)),
        ({'wn': 1e300}, 'natural_frequency'),
    ],
)
def test_an_impossible_machine_is_refused_and_the_old_one_kept(change, words):
    made = monitor()
    stream = list(blocks(samples(rotation(1.2))))
    fed(made, stream[:50])
    with pytest.raises(ValueError, match=words) as caught:
        made.configure(dataclasses.replace(RIG, **change))
    assert '\n' not in str(caught.value)
    assert [r for r in fed(made, stream[50:]) if isinstance(r, TableResult)]


def test_a_task_that_fails_is_counted_and_the_others_go_on(monkeypatch):
    push = StatisticsTask.push
    calls = iter(range(10**6))

    def fails_once(task, batch):
        if next(calls) == 40:
            raise FloatingPointError('seventh heaven')
        return push(task, batch)

    monkeypatch.setattr(StatisticsTask, 'push', fails_once)
    made = monitor()
    results = fed(made, blocks(samples(rotation(4.0))))
    assert made.health.failed == {'statistics': 1}
    assert made.health.last_failure == 'statistics: FloatingPointError: seventh heaven'
    names = {r.name for r in results if isinstance(r, TableResult)}
    assert {'spectrum', 'envelope_spectrum', 'order_spectrum'} <= names
    spans = [
        r.span for r in results if not isinstance(r, TableResult)
        and any('kurtosis' in row.values for row in r.rows)
    ]  # fmt: skip
    # The span that failed is left out; the next ones follow.
    assert len(spans) >= 2
    assert spans[0].start_ns >= START_NS + round(40 * 0.02 * 1e9)
    assert spans[0].duration == pytest.approx(1.0, abs=2048 / RATE)
