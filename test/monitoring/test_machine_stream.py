"""The live analysis of a machine by its file: any columns, stamps that jitter, gaps."""

import numpy as np
import pytest

from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.results import ConditionResult, TableResult
from gear_dynamics.monitoring.spans.analysis import SpanAnalysis
from gear_dynamics.monitoring.spans.data import Signal, Span
from gear_dynamics.monitoring.spans.stream import MachineMonitor

RATE = 12800.0
MACHINE = {
    'machine': 'gearbox',
    'sample_rate': RATE,
    'span': 0.5,
    'channels': {
        'housing': {'column': 'a', 'unit': 'g'},
        'cover': {'column': 'b', 'unit': 'm/s2'},
        'floor': {'column': 'c', 'unit': 'm/s2'},
    },
    'shafts': {'input': {'tacho': {'column': 'tacho'}}, 'output': {'driven_by': 'first'}},
    'wheels': {'p': {'shaft': 'input', 'teeth': 20}, 'g': {'shaft': 'output', 'teeth': 41}},
    'meshes': {'first': ['p', 'g']},
    'severity': {'limits_mm_s': [2.3, 4.5, 7.1]},
}


def samples(duration=2.0):
    t = np.arange(int(duration * RATE)) / RATE
    rows = np.zeros(len(t), [(name, np.float32) for name in ('tacho', 'c', 'a', 'b', 'unused')])
    rows['a'] = 0.5 * np.cos(2 * np.pi * 20 * 50 * t)
    rows['b'] = np.random.default_rng(1).normal(size=len(t))
    rows['c'] = 20 * np.cos(2 * np.pi * 100 * t)
    rows['tacho'] = np.mod(50 * t + 0.3, 1) < 0.1
    return rows


def fed(monitor, rows, width=128, jitter=0.0, skip=()):
    """Return the results of a stream in blocks, with stamps that jitter [s]."""
    random = np.random.default_rng(2)
    results = []
    for number in range(len(rows) // width):
        stamp = 10**18 + round(1e9 * (number * width / RATE + random.uniform(-jitter, jitter)))
        if number not in skip:
            block = rows[number * width : (number + 1) * width]
            results += monitor.add_block(stamp, block)
    return results


def conditions(results):
    return [each for each in results if isinstance(each, ConditionResult)]


def test_live_and_recorded_give_the_same_numbers():
    rows = samples()
    found = conditions(fed(MachineMonitor(Machine.from_mapping(MACHINE)), rows))
    assert len(found) == 4
    machine = Machine.from_mapping(MACHINE)
    engine = SpanAnalysis(machine)
    for number, result in enumerate(found):
        part = rows[number * 6400 : (number + 1) * 6400]
        start = number * 0.5
        channels = {
            each.name: Signal(part[each.source.column].astype(float) * each.scale, RATE, start)
            for each in machine.channels
        }
        shafts = {'input': Signal(part['tacho'].astype(float), RATE, start)}
        expected = engine.analyse(Span(start, 0.5, channels, shafts)).values
        for row in result.rows:
            for name, value in row.values.items():
                assert value == pytest.approx(expected[f'{row.subject}/{name}'], nan_ok=True)


def test_indicators_units_levels_and_spectrum():
    results = fed(MachineMonitor(Machine.from_mapping(MACHINE)), samples())
    housing, cover, floor, input_, output = conditions(results)[1].rows
    assert housing.values['first_harmonic_1'] == pytest.approx(0.5 * 9.80665, rel=1e-3)
    assert input_.values['speed'] == pytest.approx(2 * np.pi * 50, rel=1e-4)
    assert output.values['speed'] == pytest.approx(2 * np.pi * 50 * 20 / 41, rel=1e-4)
    # 20 m/s2 at 100 Hz are 22.5 mm/s RMS.
    assert floor.level == Level.ERROR
    assert 'zone D' in floor.message
    assert cover.level == Level.OK
    tables = [each for each in results if isinstance(each, TableResult)]
    spectrum = tables[0].rows
    assert spectrum.dtype.names == ('frequency', 'housing', 'cover', 'floor')
    assert spectrum['frequency'][np.argmax(spectrum['floor'])] == 100
    assert spectrum['floor'].max() == pytest.approx(20, rel=1e-3)


def test_stamps_that_jitter_are_no_gaps():
    monitor = MachineMonitor(Machine.from_mapping(MACHINE))
    assert len(conditions(fed(monitor, samples(), jitter=2e-4))) == 4
    assert (monitor.health.gaps, monitor.health.dropped.total()) == (0, 0)


def test_a_lost_block_is_a_gap_and_the_span_begins_anew():
    monitor = MachineMonitor(Machine.from_mapping(MACHINE))
    found = conditions(fed(monitor, samples(), jitter=2e-5, skip=[75]))
    assert (monitor.health.gaps, monitor.health.missing) == (1, 128)
    starts = [(each.span.start_ns - 10**18) / 1e9 for each in found]
    np.testing.assert_allclose(starts, [0, 76 * 0.01, 76 * 0.01 + 0.5], atol=1e-4)


def test_a_rate_that_is_not_stated_is_taken_from_the_stream():
    rows = samples()
    timed = np.zeros(len(rows), [('t', np.float32), *rows.dtype.descr])
    for name in rows.dtype.names:
        timed[name] = rows[name]
    timed['t'] = np.arange(len(rows)) % 128 / RATE
    machine = Machine.from_mapping({**MACHINE, 'sample_rate': None})
    assert len(conditions(fed(MachineMonitor(machine), timed))) == 4
    without = MachineMonitor(machine)
    assert fed(without, rows) == []
    assert without.health.dropped['rate'] > 0


def test_blocks_that_cannot_be_used_are_counted_by_kind():
    monitor = MachineMonitor(Machine.from_mapping(MACHINE))
    rows = samples(0.1)
    monitor.add_block(10**18, rows[:0])
    monitor.add_block(10**18, rows[['unused']])
    bad = rows.copy()
    bad['a'][3] = np.nan
    monitor.add_block(10**18, bad)
    monitor.add_block(10**18 + 10**9, rows)
    monitor.add_block(10**18, rows)
    assert monitor.health.dropped == {'empty': 1, 'columns': 1, 'not finite': 1, 'back': 1}
