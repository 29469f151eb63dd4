"""What is judged and what is not, from streams that change their operating state."""

import dataclasses

import numpy as np
import pytest
from streams import RATE, RIG, START_NS, blocks, rotation, samples

from gear_dynamics.machine.channel import Channel
from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import Mesh, Wheel
from gear_dynamics.machine.shaft import Angle, DrivenBy, Shaft
from gear_dynamics.machine.source import Source
from gear_dynamics.monitoring.layout import Layout
from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult, TableResult
from gear_dynamics.monitoring.thresholds import Limit, Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings

FAST = {
    **{'average_longest': 0.4, 'average_duration': 0.2, 'statistics_duration': 0.2},
    'envelope_high': 20000.0,
}


def monitor(limits=None, **settings):
    made = Monitor(
        AnalyzerSettings(**{'learn_spans': 2, **FAST, **settings}), Thresholds(limits or {})
    )
    made.configure(RIG)
    return made


def fed(made, stream):
    return [result for stamp, rows in stream for result in made.add_block(stamp, rows)]


def rows(results, subject, key):
    return [
        (result.span, row)
        for result in results
        if isinstance(result, ConditionResult)
        for row in result.rows
        if row.subject == subject and key in row.values
    ]


def joined(*parts):
    """Rotations end to end: each (seconds, speed)."""
    angle = np.zeros(0)
    for seconds, speed in parts:
        turned = angle[-1] if len(angle) else 0.0
        angle = np.concatenate([angle, rotation(seconds, start=speed, turned=turned)])
    return angle


def test_results_over_a_change_of_speed_are_published_but_not_judged():
    angle = joined((2.0, 104.72), (2.0, 105.5))
    force = 1000 * np.cos(34 * angle)
    force[102000:110000] *= 100
    made = monitor({'mesh_force/rms': Limit(warn=2000.0)})
    results = fed(made, blocks(samples(angle, mesh_force=force)))
    found = rows(results, 'mesh_force', 'rms')
    loud = [row for _, row in found if row.values['rms'] > 2000]
    assert loud
    for row in loud:
        assert row.level is Level.OK
        assert row.message == 'not judged: the speed is changing'
        assert row.notes['not judged'] == 'the speed is changing'
    assert made.health.not_judged['the speed is changing'] >= len(loud)
    assert found[-1][1].message == 'within its limits'
    # half a second at the start and half a second after the change
    assert made.health.steady_share == pytest.approx(3.0 / 4.0, abs=0.03)
    spans = [span for span, _ in found]
    assert spans[-1].start_ns > START_NS + 2_500_000_000


def test_a_level_is_held_where_nothing_is_judged():
    angle = joined((2.0, 104.72), (0.4, 110.0), (2.0, 104.72))
    force = 5000 * np.cos(34 * angle)
    made = monitor({'mesh_force/rms': Limit(warn=2000.0)})
    results = fed(made, blocks(samples(angle, mesh_force=force)))
    found = [row for _, row in rows(results, 'mesh_force', 'rms')]
    levels = [row.level for row in found if 'settling' not in row.message]
    assert set(levels) == {Level.WARN}
    assert any(row.message.endswith('; held: rms') for row in found)


def test_a_relative_limit_knows_the_operating_bin():
    # The level at each speed is normal there, and twice as much is not.
    speeds = (104.72, 150.0, 104.72, 150.0, 104.72)
    angle = joined(*((2.0, speed) for speed in speeds))
    part = np.arange(len(angle)) // round(2 * RATE)
    amplitude = np.array([100.0, 1000.0, 100.0, 1000.0, 250.0])[part]
    made = monitor({'mesh_force/rms': Limit(warn=2.0, relative=True)})
    results = fed(made, blocks(samples(angle, mesh_force=amplitude * np.cos(34 * angle))))
    found = rows(results, 'mesh_force', 'rms')
    learning = [row for _, row in found if 'baseline' in row.notes]
    assert len(learning) == 2  # the second of two spans completes it, in each of two bins
    raised = [span.start_ns for span, row in found if row.level]
    assert raised
    assert min(raised) >= START_NS + 8_000_000_000
    assert list(made.health.bins.values()) == [True, True]


def test_learn_takes_the_present_state_as_normal():
    angle = rotation(4.0)
    amplitude = np.where(np.arange(len(angle)) < 2 * RATE, 100.0, 500.0)
    rig = samples(angle, mesh_force=amplitude * np.cos(34 * angle))
    stream = list(blocks(rig))
    made = monitor({'mesh_force/rms': Limit(warn=2.0, relative=True)})
    fed(made, stream[:250])
    assert [row.level for _, row in rows(fed(made, stream[250:300]), 'mesh_force', 'rms')][-1]
    made.learn()
    made.acknowledge()
    levels = [row.level for _, row in rows(fed(made, stream[300:]), 'mesh_force', 'rms')]
    assert set(levels) == {Level.OK}


def test_what_was_learned_outlives_gaps_and_restarts(tmp_path):
    angle = rotation(3.0)
    rig = samples(angle, mesh_force=100 * np.cos(34 * angle))
    stream = list(blocks(rig))
    limits = {'mesh_force/rms': Limit(warn=2.0, relative=True)}
    path = str(tmp_path / 'baseline.json')
    made = monitor(limits, baseline=path)
    fed(made, stream[:150])
    fed(made, stream[160:])  # a gap
    assert list(made.health.bins.values()) == [True]
    made.save()

    again = monitor(limits, baseline=path)
    loud = samples(angle, mesh_force=500 * np.cos(34 * angle))
    found = [row for _, row in rows(fed(again, blocks(loud)), 'mesh_force', 'rms')]
    assert found[-1].level is Level.WARN
    assert all('baseline' not in row.notes for row in found)


def test_the_baseline_of_another_machine_is_refused_and_not_overwritten(tmp_path):
    path = tmp_path / 'baseline.json'
    path.write_text('{"form": 1, "machine": "another", "spans": 2, "bins": []}')
    before = path.read_text()
    made = monitor({'*/rms': Limit(warn=2.0, relative=True)}, baseline=str(path))
    assert "'another'" in made.health.baseline
    fed(made, blocks(samples(rotation(2.0))))
    made.save()
    assert path.read_text() == before


def test_a_gap_does_not_ask_for_settling_again():
    stream = list(blocks(samples(rotation(3.0))))
    made = monitor()
    fed(made, stream[:150])
    steady = made.health.steady_seconds
    fed(made, stream[160:260])
    assert made.health.steady_seconds - steady == pytest.approx(1.0, abs=0.03)


def test_a_task_whose_span_never_completes_is_said_to_starve():
    # A block is lost every 0.3 s, and the averages need 2 s.
    stream = [each for k, each in enumerate(blocks(samples(rotation(12.0)))) if k % 30]
    made = monitor(average_longest=2.0, average_duration=2.0)
    results = fed(made, stream)
    assert not rows(results, 'mesh_force', 'pinion_fm4')
    assert made.health.starving['averages'] == 'gap'
    fed(made, blocks(samples(rotation(5.0)), start_ns=START_NS + 20 * 10**9))
    assert 'averages' not in made.health.starving


def test_an_average_takes_as_many_periods_as_its_duration_holds():
    # 20 / 40 teeth meet alike after two pinion revolutions: 0.12 s at this speed.
    made = Monitor(AnalyzerSettings(average_duration=1.0), Thresholds({}))
    teeth = {'pinion_teeth': 20, 'gear_teeth': 40}
    made.configure(dataclasses.replace(RIG, **teeth))
    angle = rotation(3.0)
    rig = samples(angle)
    rig['gear_angle'] = np.mod(angle * 20 / 40, 2 * np.pi)
    found = rows(fed(made, blocks(rig)), 'mesh_force', 'pinion_fm0')
    span, row = found[0]
    assert row.notes['revolutions'] == '16 of the pinion'
    assert span.duration == pytest.approx(16 * 2 * np.pi / 104.72, rel=1e-3)
    assert 'other_wheel' not in row.notes


def test_the_section_is_not_judged_on_a_slow_ramp():
    # 2 % over a record of 512 cycles: beyond the half percent that is allowed.
    angle = rotation(2.2, 104.72, 110.0)
    made = Monitor(AnalyzerSettings(steady_speed=1.0, regime_cycles=512), Thresholds({}))
    made.configure(RIG)
    _, motion = rows(fed(made, blocks(samples(angle))), 'motion', 'mesh_frequency')[0]
    assert motion.notes['regime'] == 'not judged: the speed is changing'


def test_half_backlash_changes_reach_contact_at_once():
    # delta swings from 1.9e-4 to 2.1e-4: always beyond b = 1.5e-4, never beyond 2.5e-4.
    stream = list(blocks(samples(rotation(4.0))))
    made = monitor()
    fed(made, stream[:200])
    made.configure(dataclasses.replace(RIG, half_backlash=2.5e-4))
    found = [row for _, row in rows(fed(made, stream[200:]), 'contact', 'out_of_contact')]
    assert found[-1].values['out_of_contact'] == pytest.approx(1.0)


def two_stage():
    """A machine of two meshes, three shafts and one accelerometer in g."""
    return Machine(
        name='two stages',
        channels=(Channel('housing', Source('acc'), recorded_unit='g'),),
        shafts=(
            Shaft('input', Angle(Source('encoder'), 4096.0)),
            Shaft('middle', DrivenBy('first')),
            Shaft('output', DrivenBy('second')),
        ),
        wheels=(
            Wheel('a', 'input', 20),
            Wheel('b', 'middle', 31),
            Wheel('c', 'middle', 17),
            Wheel('d', 'output', 40),
        ),
        meshes=(Mesh('first', 'a', 'b'), Mesh('second', 'c', 'd')),
    )


def test_a_machine_of_two_stages_and_one_channel_is_analysed():
    machine = two_stage()
    made = Monitor(AnalyzerSettings(), Thresholds({}))
    made.configure(Layout(machine, RATE, 512))
    angle = rotation(9.0, start=200.0)
    of_c = angle * 20 / 31
    acc = np.cos(20 * angle) + (1 + 0.5 * np.cos(of_c)) * np.cos(17 * of_c)
    sent = np.zeros(len(angle), [('t', float), ('acc', float), ('encoder', float)])
    sent['t'] = np.arange(len(angle)) / RATE
    sent['acc'] = acc
    sent['encoder'] = angle / (2 * np.pi) * 4096
    results = fed(made, blocks(sent))
    assert made.health.failed == {}
    orders = [r for r in results if isinstance(r, TableResult) and r.name == 'order_spectrum']
    assert orders[0].rows.dtype.names == ('order', 'housing')
    found = {wheel: rows(results, 'housing', f'{wheel}_sideband_index')[0][1] for wheel in 'abcd'}
    assert found['c'].values['c_sideband_index'] == pytest.approx(9.80665 * 0.25, rel=1e-3)
    assert found['a'].values['a_sideband_index'] == pytest.approx(0, abs=1e-2)
