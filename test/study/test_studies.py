import csv
import re

import numpy as np
import pytest
from ros_support import ROOT
from study.convergence import assert_table_ends_at_the_exponents

from gear_dynamics import study
from gear_dynamics.dynamics.attractors import same_orbit
from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.dynamics.exponents import lyapunov_spectrum
from gear_dynamics.dynamics.regimes import Regime
from gear_dynamics.study.command import main
from gear_dynamics.study.declaration import study_module
from gear_dynamics.study.drawing import save_figure
from gear_dynamics.study.experiments.bifurcation import in_kind, in_place
from gear_dynamics.study.findings import (
    MotionResult,
    differing_words,
    pooled,
    support_exponents,
    unsettled_words,
)
from gear_dynamics.study.initial import states_at
from gear_dynamics.study.operating_point import read_operating_point
from gear_dynamics.study.outcome import write_outcome
from gear_dynamics.study.published import SOURCE, is_published

CHAOS = study.friction_chaos()
NEAR = read_operating_point(ROOT / 'config' / 'friction_chaos_near.yaml')


def test_preset_is_at_the_frequency_ratio_of_the_source():
    # wn = 63652.494 rad/s and w = 1.222: where the preset's numbers were searched.
    assert CHAOS.pair.derived.wn == pytest.approx(63652.494, abs=1e-3)
    assert CHAOS.frequency_ratio == pytest.approx(1.222, rel=1e-8)


def test_initial_states_have_the_delta_asked_for():
    delta, slope = np.array([-1.2, 0.3]), np.array([0.1, -0.4])
    states = states_at(CHAOS, delta, slope)
    pair = CHAOS.pair
    rate = pair.pinion_teeth * CHAOS.speed * pair.transmission_error_amplitude
    found = states[:, 3] - states[:, 1] + states[:, 4]
    found_slope = states[:, 9] - states[:, 7] + states[:, 10] - rate
    assert found / pair.half_backlash == pytest.approx(delta, rel=1e-12)
    scale = pair.half_backlash * pair.derived.wn
    assert found_slope / scale == pytest.approx(slope, rel=1e-9)


def test_lyapunov_shows_the_sequence_and_the_exact_exponents():
    """Chaos, chaos, period-4, as the preset was searched for; four exponents in closed form."""
    outcome = study.lyapunov(CHAOS, initial_states=2, transient=1000, cycles=1500)
    words = outcome.table['kind [-]']
    assert list(words) == ['chaotic'] * 4 + ['period-4'] * 2
    first, second = support_exponents(CHAOS)
    for values, errors in zip(
        outcome.arrays['exponents'], outcome.arrays['standard_errors'], strict=True
    ):
        for exact in (first, second):
            nearest = np.argsort(np.abs(values - exact))[:2]
            assert values[nearest] == pytest.approx(exact, abs=5e-4 + 4 * errors[nearest].max())
    divergence = outcome.table['mean_divergence [1/tau]']
    assert outcome.arrays['exponents'].sum(axis=1) == pytest.approx(divergence, rel=1e-6)


def test_nearest_completion_shows_the_sequence_and_is_nearer_to_the_published_exponents():
    published = list(SOURCE.values())
    apart = []
    for operation in (CHAOS, NEAR):
        outcome = study.lyapunov(operation, initial_states=2, transient=1000, cycles=1500)
        assert list(outcome.table['kind [-]']) == ['chaotic'] * 4 + ['period-4'] * 2
        largest = outcome.arrays['exponents'][:, 0].reshape(3, 2).mean(axis=1)
        apart.append(np.sqrt(np.mean((largest - published) ** 2)))
        # The tolerance is that of speed, which is given to nine digits.
        assert operation.frequency_ratio == pytest.approx(1.222, rel=1e-8)
    assert apart[1] < 0.5 * apart[0]


def test_bifurcation_goes_on_from_one_value_to_the_next():
    """At w = 1 a period-3 motion lives beside the period-1 motion without loss of contact."""
    outcome = study.bifurcation(
        CHAOS, [0.0], begin=0.95, end=1.19, count=25, transient=100, cycles=100
    )
    kinds = outcome.arrays['kind'][0]
    at = np.abs(outcome.arrays['values'] - 1.0).argmin()
    assert kinds[0, at] == 'period-1'
    assert kinds[1, at] != 'period-1'
    assert np.abs(outcome.arrays['sum_error']).max() < 1e-6


def test_every_motion_of_a_sweep_has_all_exponents_and_a_verdict():
    outcome = study.bifurcation(CHAOS, [0.03], begin=0.5, end=0.6, count=3, cycles=150)
    arrays = outcome.arrays
    assert_table_ends_at_the_exponents(outcome)
    # No chaos, so no onset of it.
    assert '_onset' not in outcome.further
    section = outcome.further['_section']
    second = (np.abs(section['w [1]'] - 0.55) < 1e-9) & (section['swept [-]'] == 'down')
    points = np.stack([section['delta [b]'], section['delta_dot [b wn]']], axis=-1)
    assert np.array_equal(points[second], arrays['sections'][0, 1, 1])
    assert arrays['exponents'].shape == (1, 2, 3, 10)
    assert arrays['standard_errors'].shape == arrays['settled'].shape == (1, 2, 3, 10)
    assert arrays['convergence'].shape == (1, 2, 3, 10, 10)
    assert arrays['settled'].all()
    # x1 and x2 feed nothing back.
    for exact in support_exponents(CHAOS):
        apart = np.abs(arrays['exponents'] - exact)
        errors = 4 * arrays['standard_errors'].max()
        assert np.sort(apart, axis=-1)[..., :2].max() < 5e-4 + errors


def test_basins_judge_each_attractor_once():
    """Period-3 and period-1 motions live side by side at w = 1. Every state is labelled as its own
    long motion says."""
    operation = CHAOS.with_value('w', 1.0)
    outcome = study.basins(operation, size=6, transient=300)
    arrays, table = outcome.arrays, outcome.further['_attractors']
    assert {'period-1', 'period-3'} <= set(arrays['kind'])
    assert arrays['share'].sum() == pytest.approx(1)
    assert np.all(np.diff(arrays['share']) <= 0)
    count = len(arrays['names'])
    assert arrays['exponents'].shape == arrays['settled'].shape == (count, 10)
    assert np.abs(arrays['sum_error']).max() < 1e-6
    assert arrays['settled'].all()
    assert list(table['period [cycles]']) == [int(kind.split('-')[1]) for kind in arrays['kind']]
    assert list(outcome.table) == ['delta [b]', 'delta_dot [b wn]', 'attractor [1]']
    assert_table_ends_at_the_exponents(outcome, table)
    states = states_at(operation, *(outcome.table[n] for n in list(outcome.table)[:2]))
    run = run_cycles([operation.pair] * 36, operation.speed, operation.load_torque, 600,
                     states=states, section_phase=0.0)  # fmt: skip
    sections = operation.scaled(run.sections)
    for label, section in zip(arrays['label'].ravel(), sections, strict=True):
        orbit = arrays['points'][arrays['points_of'] == label]
        assert same_orbit(section[-len(orbit):], orbit)  # fmt: skip


def test_basins_name_chaos():
    """At w = 1.222 without friction every state that was tried ends in chaos."""
    outcome = study.basins(CHAOS.with_value('friction_coefficient', 0.0), size=3, transient=300)
    assert list(outcome.arrays['names']) == ['chaotic']


def test_attractor_has_the_sections_of_its_kind():
    outcome = study.attractor(CHAOS, [0.05], transient=1500, cycles=400)
    arrays = outcome.arrays
    assert list(arrays['kind']) == ['period-4']
    points = np.unique(arrays['sections'][0].round(2), axis=0)
    assert len(points) == 4
    # By two nearby motions, which know nothing of variations.
    assert arrays['nearby'][0] == pytest.approx(arrays['exponents'][0, 0], abs=2e-3)
    assert arrays['nearby'][0] != arrays['exponents'][0, 0]
    # Each panel of the figure has its table.
    history, spectrum = outcome.further['_history'], outcome.further['_spectrum']
    assert np.array_equal(history['delta_dot [b wn]'], arrays['delta_dot'][0])
    cycle = CHAOS.cycle
    assert history['tau [1]'][-1] == pytest.approx(512 * cycle - cycle / 64)
    high = spectrum['amplitude [b]'] > 1e-3 * spectrum['amplitude [b]'].max()
    # Lines at quarters of the mesh order, each as wide as that of the window: its neighbours too.
    quarters = 4 * spectrum['order [1]'][high]
    assert np.abs(quarters - quarters.round()).max() <= 4 / 256
    exponents_table = outcome.further['_exponents']
    assert exponents_table['exponent_1 [1/tau]'][0] == arrays['exponents'][0, 0]
    assert exponents_table['exponent_1_error [1/tau]'][0] == arrays['standard_errors'][0, 0]
    assert exponents_table['sum_error [1]'] == arrays['sum_error'] < 1e-6
    assert arrays['convergence'].shape == (1, 50, 10)
    last = [outcome.further['_convergence'][f'exponent_{i} [1/tau]'][-1] for i in range(1, 11)]
    assert last == pytest.approx(arrays['exponents'][0])


def test_record_that_is_not_settled_is_named():
    drifting = np.random.default_rng(0).normal(size=(400, 10)) - np.arange(10) * 10
    drifting[:, 2] += np.linspace(0, 9, 400)
    found = lyapunov_spectrum(drifting, 1.0)
    one = MotionResult(0.0, found, Regime('chaotic', 0, np.nan, 1.0, None), 0.0, 0.0, -1.0)
    assert unsettled_words([one]) == [
        '  not settled: 1 of 1 records, in exponents 3: run more cycles'
    ]


def test_motions_of_different_kinds_are_not_averaged():
    """At w = 1 period-1 and period-3 live side by side: no motion has their mean exponent."""
    outcome = study.lyapunov(CHAOS.with_value('w', 1.0), [0.0], transient=1000, cycles=400)
    kinds, largest = outcome.arrays['kind'], outcome.arrays['exponents'][:, 0]
    assert set(kinds) == {'period-1', 'period-3'}
    for kind in ('period-1', 'period-3'):
        own = largest[kinds == kind]
        shown = re.search(
            rf'mu = 0: {own.size} of 6 {kind}\n  largest exponent (\S+)', outcome.text
        )
        assert float(shown[1]) == pytest.approx(own.mean(), abs=5e-5)
    assert 'published' not in outcome.text


def test_pooled_error_is_the_larger_of_that_within_and_that_between():
    """Four motions: equal ones have their error over 2, others that of the mean of four."""
    errors = np.full(4, 0.02)
    assert pooled(np.full(4, 0.1), errors) == pytest.approx((0.1, 0.01))
    spread = np.array([-1.0, -1.0, 1.0, 1.0])
    assert pooled(spread, errors) == pytest.approx((0.0, np.sqrt(4 / 3) / 2))


def test_completions_alone_stand_beside_the_published_exponents():
    assert is_published(CHAOS)
    assert is_published(NEAR)
    assert is_published(CHAOS.with_value('load_torque', 2 * CHAOS.load_torque))
    assert is_published(CHAOS.with_value('friction_coefficient', 0.0).with_value('w', 1.222))
    assert not is_published(CHAOS.with_value('w', 1.223))
    assert not is_published(CHAOS.with_value('half_backlash', 140e-6))
    assert not is_published(study.default_operating_point())


def test_exponents_that_differ_between_the_two_ways_are_told():
    """Errors of 0.003 and 0.004 are 0.005 together; three times that is 0.015."""
    assert differing_words(0.054, 0.003, 0.04, 0.004) == []
    (line,) = differing_words(0.024, 0.003, 0.04, 0.004)
    assert line == (
        '  the two differ by 0.016, more than 3 of their standard errors (0.005): run more cycles'
    )


DEFAULT = ('spectrum', 'response', 'continuation')

SMALL = {
    'spectrum': {'phases': 2, 'speeds': 2, 'transient': 100},
    'lyapunov': {'frictions': [0.0], 'initial_states': 2, 'transient': 50, 'cycles': 100},
    'bifurcation': {'frictions': [0.0], 'begin': 0.5, 'end': 0.6, 'count': 2, 'transient': 20},
    'attractor': {'frictions': [0.0], 'transient': 50, 'cycles': 200},
    'basins': {'size': 2, 'transient': 20},
    'orbits': {'longest': 2, 'starts': 1, 'transient': 20},
    'continuation': {'begin': 0.1, 'end': 0.12, 'places': 2, 'doublings': 0, 'step': 0.2},
    'regimes': {'count': 2, 'across_count': 2, 'starts': 1, 'transient': 20, 'fine': 0},
    'response': {'begin': 0.1, 'end': 0.12, 'count': 2, 'transient': 20},
}


@pytest.mark.parametrize('name', SMALL)
def test_every_column_and_array_has_its_unit_and_the_figure_draws(tmp_path, name):
    operation = study.default_operating_point() if name in DEFAULT else CHAOS
    outcome = getattr(study, name)(operation, **SMALL[name])
    draw = study_module(name).draw
    save_figure(draw, outcome.arrays, tmp_path / f'{name}.png')
    assert (tmp_path / f'{name}.png').read_bytes().startswith(b'\x89PNG')
    paths = write_outcome(outcome, tmp_path)
    for path in paths:
        if path.suffix == '.csv':
            header = path.read_text().splitlines()[0].split(',')
            assert [each for each in header if not re.fullmatch(r'\w+ \[.+\]', each)] == []
    with np.load(tmp_path / f'{name}.npz') as stored:
        units = dict(stored['units'])
        assert set(units) == set(stored) - {'units'}
        assert all(units.values())


def test_sweep_of_the_friction_coefficient_keeps_its_values():
    outcome = study.bifurcation(
        CHAOS, parameter='friction_coefficient', begin=0.04, end=0.06, count=3, transient=20
    )
    assert np.allclose(next(iter(outcome.table.values())), [0.04, 0.05, 0.06] * 2)
    assert np.all(np.isnan(outcome.arrays['friction']))
    assert 'mu =' not in outcome.text


def test_sweeps_differ_in_kind_or_in_place():
    """Five pairs: one orbit from two of its points, two orbits with the same mean, two periods,
    chaos and a period, and nothing that could be said."""
    kinds = np.array(
        [
            ['period-2', 'period-2', 'period-2', 'chaotic', 'chaotic'],
            ['period-2', 'period-2', 'period-1', 'period-3', 'undecided'],
        ]
    )
    sections = np.ones((2, 5, 6, 2))
    sections[:, 0, :, 0] = [[0, 2] * 3, [2, 0] * 3]
    sections[:, 1, :, 0] = [[0, 2] * 3, [0.5, 1.5] * 3]
    kind, place = in_kind(kinds), in_place(kinds, sections)
    assert list(kind) == [False, False, True, True, False]
    assert list(place & ~kind) == [False, True, False, False, False]


def test_swept_column_has_the_unit_of_its_parameter():
    outcome = study.bifurcation(
        CHAOS, [0.0], parameter='load_torque', begin=400.0, end=450.0, count=2, transient=20
    )
    assert 'load_torque [N m]' in outcome.table
    assert outcome.units['values'] == 'N m'


def test_command_writes_data_with_units_figure_and_text(tmp_path, capsys):
    arguments = ['basins', '--size', '4', '--transient', '50', '--set', 'w=1.0', '--quiet']
    assert main([*arguments, '--output', str(tmp_path)]) == 0
    assert 'period-' in capsys.readouterr().out
    names = sorted(path.name for path in tmp_path.iterdir())
    tables = ['basins_attractors.csv', 'basins_convergence.csv', 'basins_points.csv']
    files = ['basins.csv', 'basins.npz', 'basins.png', 'basins.txt', *tables]
    assert names == files
    assert (tmp_path / 'basins.png').read_bytes().startswith(b'\x89PNG')
    with (tmp_path / 'basins.csv').open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[:3] == ['delta [b]', 'delta_dot [b wn]', 'attractor [1]']
    assert len(rows) == 16
    with np.load(tmp_path / 'basins.npz') as stored:
        assert stored['label'].shape == (4, 4)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (['--set', 'teeth=3'], 'teeth cannot be varied; known are w, speed'),
        (['--params', 'missing.yaml'], 'missing.yaml'),
        (['--set', 'half_backlash=-1'], 'half_backlash'),
        (['--set', 'mesh_stiffness=round'], "mesh_stiffness is 'round': it must be 'rectangular'"),
        (['--set', 'pinion_teeth=20.5'], 'pinion_teeth is 20.5: it must be an integer'),
        (['--set', 'w=fast'], "w is 'fast': it must be a number"),
    ],
)
def test_command_refuses_in_one_line(tmp_path, capsys, arguments, words):
    assert main(['basins', *arguments, '--output', str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count('\n') == 1
    assert 'Traceback' not in error
