import dataclasses
import re
import tracemalloc

import numpy as np
import pytest
from streams import RATE, RIG, START_NS, blocks, rotation, samples

from gear_dynamics.machine.columns import CHANNELS, EVENTS, EventKind
from gear_dynamics.monitoring.catalogue import check_names, indicators
from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult, TableResult
from gear_dynamics.monitoring.thresholds import Limit, Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings

MESH = 104.72 * 34 / (2 * np.pi)  # Hz


def monitor(limits=None, **settings):
    made = Monitor(AnalyzerSettings(**settings), Thresholds(limits or {}))
    made.configure(RIG)
    return made


def fed(made, stream):
    return [result for stamp, rows in stream for result in made.add_block(stamp, rows)]


def tables(results, name):
    return [r for r in results if isinstance(r, TableResult) and r.name == name]


def rows(results, subject, key):
    return [
        (result.span, row)
        for result in results
        if isinstance(result, ConditionResult)
        for row in result.rows
        if row.subject == subject and key in row.values
    ]


@pytest.fixture(scope='module')
def steady():
    angle = rotation(5.0, turned=1.0)
    modulated = 3 * (1 + 0.4 * np.cos(angle)) * np.cos(34 * angle)
    of_gear = 2 * (1 + 0.5 * np.cos(angle * 34 / 59)) * np.cos(34 * angle)
    force = 2700 + 100 * np.sqrt(2) * np.cos(34 * angle)
    rig = samples(angle, pinion_ay=modulated, gear_ay=of_gear, mesh_force=force)
    return rig, fed(monitor(), blocks(rig))


def test_spectrum_has_the_mesh_line_and_says_its_span(steady):
    found = tables(steady[1], 'spectrum')
    rows = found[0].rows
    assert rows.dtype.names == ('frequency', *CHANNELS)
    line = np.argmax(rows['mesh_force'][5:]) + 5
    assert rows['frequency'][line] == pytest.approx(MESH, abs=RATE / 8192)
    assert rows['mesh_force'][0] == pytest.approx(2700, rel=1e-5)
    # 8 segments of 8192, each half over the one before
    assert found[0].span.duration == pytest.approx((7 * 4096 + 8192) / RATE)
    spans = [table.span.start_ns for table in found]
    assert spans[0] == START_NS
    assert np.diff(spans) == pytest.approx(8 * 4096 / RATE * 1e9, abs=1)


def test_flat_top_rms_reads_the_mesh_line_within_a_thousandth(steady):
    made = monitor(spectrum_window='flattop', spectrum_scale='rms')
    table = tables(fed(made, blocks(steady[0])), 'spectrum')[0].rows
    inside = np.abs(table['frequency'] - MESH) < 100
    assert table['mesh_force'][inside].max() == pytest.approx(100, rel=1e-3)


def test_results_do_not_depend_on_the_size_of_the_blocks(steady):
    def spectra(size):
        return tables(fed(monitor(), blocks(steady[0], size)), 'spectrum')

    for size in (100, 5000):
        for one, other in zip(spectra(size), tables(steady[1], 'spectrum'), strict=False):
            assert one.span == other.span
            for name in CHANNELS:
                np.testing.assert_allclose(one.rows[name], other.rows[name], rtol=1e-6, atol=1e-9)


def test_sidebands_belong_to_the_wheel_that_makes_them(steady):
    # A (1 + m cos) at the mesh: index A m / 2 on the wheel whose turn modulates, 0 on the other.
    for channel, wheel, other, index in (
        ('pinion_ay', 'pinion', 'gear', 3 * 0.4 / 2),
        ('gear_ay', 'gear', 'pinion', 2 * 0.5 / 2),
    ):
        span, row = rows(steady[1], channel, f'{wheel}_sideband_index')[0]
        assert row.values[f'{wheel}_sideband_index'] == pytest.approx(index, rel=1e-4)
        # a hunting-tooth period: 59 pinion or 34 gear revolutions, 2006 mesh cycles
        assert span.duration == pytest.approx(2006 / MESH, rel=1e-3)
        _, row = rows(steady[1], channel, f'{other}_sideband_index')[0]
        assert row.values[f'{other}_sideband_index'] == pytest.approx(0, abs=1e-3)


def test_a_healthy_pair_has_no_ratios_of_its_difference_signal(steady):
    _, row = rows(steady[1], 'mesh_force', 'pinion_fm4')[0]
    for name in ('fm4', 'm6a', 'm8a', 'energy_ratio', 'na4'):
        assert np.isnan(row.values[f'pinion_{name}'])
    assert row.level is Level.OK
    assert 'no residual signal' in row.message


def test_statistics_are_of_the_whole_stretch(steady):
    samples_, results = steady
    span, row = rows(results, 'pinion_ay', 'rms')[0]
    # judged from the end of the settling time on
    begin = round((span.start_ns - START_NS) / 1e9 * RATE)
    assert begin / RATE == pytest.approx(0.5, abs=0.05)
    first = samples_['pinion_ay'][begin : begin + round(span.duration * RATE)]
    assert span.duration == pytest.approx(1.0, abs=0.05)
    assert row.values['rms'] == pytest.approx(np.sqrt(np.mean(first**2)), rel=1e-6)
    centred = first - first.mean()
    assert row.values['peak'] == pytest.approx(np.abs(centred).max(), rel=1e-6)
    kurtosis = np.mean(centred**4) / np.mean(centred**2) ** 2
    assert row.values['kurtosis'] == pytest.approx(kurtosis, rel=1e-6)


def test_orders_stay_put_on_a_ramp():
    angle = rotation(4.0, 104.72, 209.44)
    table = tables(
        fed(monitor(), blocks(samples(angle, gear_ax=5 * np.cos(34 * angle)))), 'order_spectrum'
    )
    assert len(table) >= 2
    for each in table:
        assert each.rows['order'][np.argmax(each.rows['gear_ax'])] == 34
        assert each.rows['gear_ax'].max() == pytest.approx(5, rel=1e-3)


def test_na4_is_over_the_variance_that_was_learned():
    # Once in a pinion revolution a lobe whose depth grows from 1 to 3 and falls back to 2. The
    # fourth moment of its residual is 3/8 A^4 and its variance A^2 / 2; two spans of depth 1 are
    # learned, so that NA4 is 1.5 A^4 from then on.
    angle = rotation(9.0)
    turns = angle / (2 * np.pi)
    depth = np.where(turns < 68, 1.0, np.where(turns < 100, 3.0, 2.0))
    rig = samples(angle, mesh_force=depth * np.cos(5 * angle) + np.cos(34 * angle))
    made = monitor(learn_spans=2, average_longest=0.5)
    results = fed(made, blocks(rig))
    na4 = [row.values['pinion_na4'] for _, row in rows(results, 'mesh_force', 'pinion_na4')]
    assert na4[:3] == pytest.approx([1.5] * 3, rel=1e-3)
    assert max(na4) == pytest.approx(1.5 * 3**4, rel=1e-3)
    assert na4[-1] == pytest.approx(1.5 * 2**4, rel=1e-3)


def test_a_large_change_of_speed_begins_the_angular_work_anew_and_keeps_what_was_learned():
    angle = rotation(3.0)
    angle = np.concatenate([angle, rotation(3.0, start=52.36, turned=angle[-1])])
    angle = np.concatenate([angle, rotation(3.0, turned=angle[-1])])
    depth = np.where(np.arange(len(angle)) < 6 * RATE, 1.0, 3.0)
    rig = samples(angle, mesh_force=depth * np.cos(5 * angle) + np.cos(34 * angle))
    made = monitor(learn_spans=2, average_longest=0.5)
    results = fed(made, blocks(rig))
    assert made.health.restarts['change of speed'] == 1  # the faster one suits the points of both
    assert len(made.health.bins) == 2
    na4 = [row.values['pinion_na4'] for _, row in rows(results, 'mesh_force', 'pinion_na4')]
    assert na4[-1] == pytest.approx(1.5 * 3**4, rel=1e-3)


def test_a_gap_begins_anew_and_no_result_reaches_across(steady):
    made = monitor()
    stream = list(blocks(steady[0]))
    results = fed(made, stream[:150] + stream[170:])
    gap = stream[150][0], stream[170][0]
    assert made.health.gaps == 1
    assert made.health.missing == 20 * 512
    for result in results:
        end = result.span.start_ns + result.span.duration * 1e9
        assert end <= gap[0] + 1e6 or result.span.start_ns >= gap[1] - 1e6
    fresh = fed(monitor(), stream[170:])
    after = [r for r in results if r.span.start_ns >= gap[1]]
    for name in ('spectrum', 'order_spectrum'):
        assert len(tables(fresh, name)) > 0
        for one, other in zip(tables(after, name), tables(fresh, name), strict=True):
            np.testing.assert_array_equal(one.rows, other.rows)


def test_a_change_of_rate_begins_anew(steady):
    made = monitor()
    stream = list(blocks(steady[0]))
    fed(made, stream[:100])
    made.configure(dataclasses.replace(RIG, sample_rate=RATE / 2))
    assert made.health.restarts['change of the rig'] == 1
    assert fed(made, stream[100:110]) == []
    assert made.health.dropped['step'] == 10


def test_scales_change_without_beginning_anew(steady):
    made = monitor()
    stream = list(blocks(steady[0]))
    fed(made, stream[:100])
    made.configure(dataclasses.replace(RIG, half_backlash=1e-4))
    assert len(tables(fed(made, stream[100:110]), 'spectrum')) == 0
    assert not made.health.restarts


def test_blocks_wait_for_the_configuration(steady):
    made = Monitor(AnalyzerSettings(), Thresholds({}))
    stream = list(blocks(steady[0]))
    assert fed(made, stream[:20]) == []
    made.configure(RIG)
    assert tables(fed(made, stream[20:120]), 'spectrum')
    assert made.health.waiting == 20
    assert made.health.gaps == 0


def spoilt(rows, kind):
    rows = rows.copy()
    if kind == 'empty':
        return rows[:0]
    if kind == 'columns':
        return rows[[name for name in rows.dtype.names if name != 'delta']]
    if kind == 'not finite':
        rows['mesh_force'][7] = np.nan
    if kind == 'step':
        rows['t'] *= 1.01
    return rows


@pytest.mark.parametrize(
    ('kind', 'reason'),
    [
        ('empty', 'no rows'),
        ('columns', 'no column delta'),
        ('not finite', 'mesh_force is nan in row 7'),
        ('step', r'step of t is 1\.97'),
        ('back', 'goes back'),
    ],
)
def test_a_bad_block_is_dropped_with_its_reason_and_changes_nothing(steady, kind, reason):
    stream = list(blocks(steady[0]))[:130]
    bad_stamp = stream[60][0] if kind == 'back' else stream[70][0]
    bad = (bad_stamp, spoilt(stream[70][1], kind))
    made = monitor()
    results = fed(made, [*stream[:70], bad, *stream[70:]])
    assert made.health.dropped == {kind: 1}
    assert re.search(reason, made.health.last_fault)
    expected = fed(monitor(), stream)
    assert [r.span for r in results] == [r.span for r in expected]
    np.testing.assert_array_equal(
        tables(results, 'spectrum')[0].rows, tables(expected, 'spectrum')[0].rows
    )


def test_a_standing_shaft_is_not_tracked_and_does_no_harm():
    angle = np.concatenate([np.full(51200, 0.5), rotation(2.0, turned=0.5)])
    results = fed(monitor(), blocks(samples(angle)))
    assert tables(results, 'spectrum')
    orders = tables(results, 'order_spectrum')
    assert all(table.span.start_ns >= START_NS + 1_000_000_000 for table in orders)


def events(cycles, delta, delta_dot, t):
    made = np.zeros(len(cycles), EVENTS)
    made['kind'] = EventKind.SECTION
    made['cycle'], made['delta'], made['delta_dot'], made['t'] = cycles, delta, delta_dot, t
    return made


def test_exact_section_from_events_gives_points_and_regime(steady):
    made = monitor(regime_cycles=64)
    results = []
    for k, (stamp, block) in enumerate(list(blocks(steady[0]))[:60]):
        results += made.add_block(stamp, block)
        cycles = np.arange(5 * k, 5 * k + 5) + 0.5
        alternating = 2e-4 + 1e-5 * (-1.0) ** np.floor(cycles)
        rows_ = events(cycles, alternating, 0 * cycles, np.arange(5) * 0.002)
        results += made.add_events(stamp, rows_)
    points = np.concatenate([table.rows for table in tables(results, 'poincare')])
    np.testing.assert_allclose(points['x'][:4], [2.1 / 1.5, 1.9 / 1.5] * 2, rtol=1e-6)
    np.testing.assert_allclose(np.diff(points['cycle']), 1)
    _, motion = rows(results, 'motion', 'period')[0]
    assert motion.notes['regime'] == 'period-2'
    assert motion.values['mesh_frequency'] == pytest.approx(500)
    assert 'exact' in motion.notes['section']


def section_of_block(k, first_cycle=0):
    cycles = np.arange(5 * k, 5 * k + 5) + 0.5 + first_cycle
    delta = 2e-4 + 1e-5 * np.cos(cycles)
    return events(cycles, delta, 0 * cycles, np.arange(5) * 0.002)


def test_no_batch_of_events_reaches_across_a_gap_or_a_reset(steady):
    made = monitor(regime_cycles=64)
    stream = list(blocks(steady[0]))
    results = []
    for k in (*range(31), *range(40, 91)):
        stamp, block = stream[k]
        results += made.add_block(stamp, block)
        results += made.add_events(stamp, section_of_block(k - 40 if k >= 40 else k))
    results += made.add_events(stream[3][0], section_of_block(3))
    assert made.health.dropped == {'events': 1}
    assert 'goes back' in made.health.last_fault
    found = tables(results, 'poincare')
    assert sum(len(table.rows) for table in found) == 5 * (31 + 50)  # one block is half a batch
    motions = [span for span, _ in rows(results, 'motion', 'mesh_frequency')]
    for table in found:
        np.testing.assert_array_equal(np.diff(table.rows['cycle']), 1)
    assert len(motions) == 2 + 3
    for span in [*motions, *(table.span for table in found)]:
        end = span.start_ns + span.duration * 1e9
        assert end <= stream[31][0] + 1e3 or span.start_ns >= stream[40][0]


def test_regime_is_the_same_whether_events_come_before_or_after_their_samples(steady):
    stream = list(blocks(steady[0]))[:70]
    # The scale of the states changes on the way.
    for k, (_, block) in enumerate(stream):
        block['delta'] *= 1 + k

    def motions(lead):
        made = monitor(regime_cycles=64)
        results = []
        for k in range(-8, 78):
            if 0 <= k < 70:
                results += made.add_block(*stream[k])
            if 0 <= k + lead < 70:
                results += made.add_events(stream[k + lead][0], section_of_block(k + lead))
        return [(span, dict(row.values)) for span, row in rows(results, 'motion', 'period')]

    assert len(motions(0)) == 5
    for lead in (-8, 8):
        for (span, values), (other_span, other) in zip(motions(0), motions(lead), strict=True):
            assert span == other_span
            np.testing.assert_equal(values, other)


def test_without_events_the_section_is_interpolated(steady):
    results = fed(monitor(regime_cycles=512), blocks(steady[0]))
    points = np.concatenate([table.rows for table in tables(results, 'poincare')])
    # delta = 2e-4 + 1e-5 cos at phase 0.5 of the mesh: 1.9e-4
    np.testing.assert_allclose(points['x'], 1.9 / 1.5, rtol=1e-4)
    np.testing.assert_allclose(np.diff(points['cycle']), 1, atol=1e-6)
    _, motion = rows(results, 'motion', 'period')[0]
    assert motion.notes['regime'] == 'period-1'
    assert 'interpolated' in motion.notes['section']


def test_all_indicators_and_no_others_are_known_by_name(steady):
    made = {
        f'{row.subject}/{name}'
        for result in steady[1]
        if isinstance(result, ConditionResult)
        for row in result.rows
        for name in row.values
    }
    # Motion that is periodic has no Lyapunov exponent.
    assert made | {'motion/lyapunov', 'motion/lyapunov_uncertainty'} == set(indicators(RIG.machine))
    check_names(['*/kurtosis', 'mesh_force/rms'], RIG.machine)
    with pytest.raises(ValueError, match=r"rsm' is no .* nearest is 'mesh_force/rms'"):
        check_names(['mesh_force/rsm'], RIG.machine)


def test_levels_follow_the_thresholds(steady):
    made = monitor({'mesh_force/rms': Limit(warn=2000.0, error=5000.0), '*/peak': Limit(warn=2.0)})
    results = fed(made, blocks(steady[0]))
    _, force = rows(results, 'mesh_force', 'rms')[0]
    assert force.level is Level.WARN
    assert 'rms' in force.message
    assert 'beyond the limit' in force.message
    _, other = rows(results, 'delta_dot', 'rms')[0]
    assert other.level is Level.OK


def test_memory_stays_flat(steady):
    made = monitor()
    stream = list(blocks(steady[0]))[:150]
    length = round(len(stream) * 512 / RATE * 1e9)
    fed(made, stream)
    tracemalloc.start()
    fed(made, [(stamp + length, rows) for stamp, rows in stream])
    before, _ = tracemalloc.get_traced_memory()
    fed(made, [(stamp + 2 * length, rows) for stamp, rows in stream])
    after, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # What waits at the end of either differs by less than a batch of blocks, 40 ms.
    assert after - before < 2_000_000
