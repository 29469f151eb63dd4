import csv
import math

import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.study.basin_map import attractors
from gear_dynamics.study.command import main
from gear_dynamics.study.frequency_response import jumps
from gear_dynamics.study.friction_spectrum import RECORD, quantity_rows
from gear_dynamics.study.initial import states_at
from gear_dynamics.study.lyapunov_table import support_exponents
from gear_dynamics.study.orbit_diagram import chaotic_ranges

CHAOS = study.friction_chaos()


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
    words = outcome.table['kind']
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


def test_ranges_of_chaos():
    kinds = np.array(['period-1', 'chaotic', 'period-2', 'chaotic', 'chaotic', 'chaotic'])
    assert chaotic_ranges(np.arange(6.0), kinds) == [(3.0, 5.0)]
    assert chaotic_ranges(np.arange(3.0), kinds[:3]) == []


def test_rows_of_a_known_signal():
    """Amplitude 3 in the second mesh harmonic on a mean of 5: displacement 3 / omega^2."""
    cycle_time = 1e-3
    turn = 2 * np.pi * np.arange(64 * RECORD) / 64
    from gear_dynamics.model.columns import SAMPLES

    samples = np.zeros(64 * RECORD, SAMPLES)
    samples['gear_ay'] = 5 + 3 * np.sin(2 * turn)
    rows = quantity_rows(samples, cycle_time)
    assert rows['gear_ay'] == pytest.approx([3 / np.sqrt(2), 0, 3, 0, 0, 0], abs=1e-12)
    expected = 3 / (2 * np.pi * 2000) ** 2
    assert rows['gear_y'] == pytest.approx([expected / np.sqrt(2), 0, expected, 0, 0, 0], abs=1e-15)


def test_friction_moves_the_first_harmonic_as_an_independent_code_saw():
    """At 1000 rpm the first harmonic of the mesh force falls by a tenth at phi0 = 0 and rises by
    8 % at 180 deg; the y accelerations fall by 2 to 3 %: an independent event-exact code."""
    for phase, change in ((0.0, -0.10), (math.pi, 0.08)):
        operation = study.default_operation().with_value('transmission_error_phase', phase)
        arrays = study.spectrum(operation, phases=0).arrays
        force, ay = arrays['mesh_force'], arrays['pinion_ay']
        assert force[1, 1] / force[0, 1] - 1 == pytest.approx(change, abs=0.01)
        assert 0.97 < ay[1, 0] / ay[0, 0] < 0.98
        # x moves by friction alone, and most near its support mode at 3401 Hz, 6 x 566.7 Hz.
        assert np.all(arrays['ax_lines'][0] == 0)
        assert arrays['order'][1, arrays['ax_lines'][1].argmax()] == 6


def test_response_jumps_where_attractors_end():
    values, rms = np.arange(6.0), np.array([0.1, 0.11, 0.3, 0.31, 0.6, 0.8])
    assert jumps(values, rms, np.array([1, 1, 1, 2, 0, 0])) == [(1.5, 0.11, 0.3), (3.5, 0.31, 0.6)]


def test_response_of_the_linear_motion_is_the_same_up_and_down():
    outcome = study.response(study.default_operation(), begin=0.1, end=0.13, count=4, transient=200)
    up, down = outcome.arrays['rms']
    assert up == pytest.approx(down, rel=1e-4)
    assert np.all(outcome.arrays['period'] == 1)


def test_basins_shares_sum_to_one():
    outcome = study.basins(CHAOS.with_value('w', 1.0), size=6, transient=300)
    names = list(outcome.arrays['names'])
    assert outcome.arrays['share'].sum() == pytest.approx(1)
    assert any(name.startswith('period-1 ') for name in names)
    assert any(name.startswith('period-3 ') for name in names)


def test_attractors_are_told_apart_by_period_and_place():
    periods = np.array([1, 1, 0, 3, 1, 0])
    means = np.array([[1, 0], [1.001, 0], [0, 0], [1, 0], [0.5, 0], [0.7, 0.2]])
    labels, names = attractors(periods, means)
    assert list(labels) == [0, 0, 1, 2, 3, 1]
    assert names == ['period-1 about 1.000 b', 'no period', 'period-3 about 1.000 b',
                     'period-1 about 0.500 b']  # fmt: skip


def test_attractor_has_the_sections_of_its_kind():
    outcome = study.attractor(CHAOS, [0.05], transient=1500, cycles=400)
    assert list(outcome.arrays['kind']) == ['period-4']
    points = np.unique(outcome.arrays['sections'][0].round(2), axis=0)
    assert len(points) == 4


def test_command_writes_data_with_units_figure_and_text(tmp_path, capsys):
    arguments = ['basins', '--size', '4', '--transient', '50', '--set', 'w=1.0', '--quiet']
    assert main([*arguments, '--output', str(tmp_path)]) == 0
    assert 'period-' in capsys.readouterr().out
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ['basins.csv', 'basins.npz', 'basins.png', 'basins.txt']
    assert (tmp_path / 'basins.png').read_bytes().startswith(b'\x89PNG')
    with (tmp_path / 'basins.csv').open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ['delta [b]', 'delta_dot [b wn]', 'attractor']
    assert len(rows) == 16
    with np.load(tmp_path / 'basins.npz') as stored:
        assert stored['label'].shape == (4, 4)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (['--set', 'teeth=3'], 'teeth cannot be varied; known are w, speed'),
        (['--params', 'missing.yaml'], 'missing.yaml'),
        (['--set', 'half_backlash=-1'], 'half_backlash'),
    ],
)
def test_command_refuses_in_one_line(tmp_path, capsys, arguments, words):
    assert main(['basins', *arguments, '--output', str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count('\n') == 1
    assert 'Traceback' not in error
