"""The map of regimes over two parameters."""

import numpy as np
import pytest
from dynamics.oscillators import kahraman_singh_point
from dynamics.systems import henon

from gear_dynamics import ParameterError, dynamics, study
from gear_dynamics.study.regime_cells import RegimeGrid, set_name
from gear_dynamics.study.tasks import Runner


@pytest.fixture(scope='module')
def outcome():
    """Kahraman and Singh's form beside the lower fold of its branch with impacts, w = 0.70803."""
    return study.regimes(
        kahraman_singh_point(0.75),
        begin=0.65, end=0.75, count=2,
        across='mesh_damping_ratio', across_begin=0.05, across_end=0.055, across_count=2,
        starts=8, fine=1, transient=300,
    )  # fmt: skip


def test_motions_at_each_place_are_those_that_the_folds_allow(outcome):
    """Below the fold the linear response is alone; above it the impacting motion lives beside it.
    Both are of period 1. Linear theory gives the RMS: error w^2 / |1 - w^2 + 2 i zeta w| / sqrt 2
    of a delta that oscillates about 1.1 b and never leaves the flank."""
    arrays = outcome.arrays
    below = (arrays['column'] == 0) & (arrays['row'] == 0)
    above = (arrays['column'] == 2) & (arrays['row'] == 0)
    assert list(arrays['kind'][below]) == ['period-1']
    assert list(arrays['kind'][above]) == ['period-1'] * 2
    for w, at in ((0.65, below), (0.75, above)):
        amplitude = 0.05 * w**2 / abs(1 - w**2 + 2j * 0.05 * w)
        linear = np.flatnonzero(at)[arrays['rms'][at].argmin()]
        assert arrays['rms'][linear] == pytest.approx(amplitude / np.sqrt(2), rel=1e-3)
        assert arrays['greatest'][linear] == pytest.approx(1.1 + amplitude, abs=1e-3)
        assert arrays['least'][linear] == pytest.approx(1.1 - amplitude, abs=1e-3)
        assert arrays['out_of_contact'][linear] == 0
        # Damping acts at all times: both exponents are -zeta.
        assert arrays['exponent'][linear] == pytest.approx(-0.05, abs=2e-3)
    impacting = np.flatnonzero(above)[arrays['rms'][above].argmax()]
    assert 0.2 < arrays['out_of_contact'][impacting] < 0.8
    assert arrays['share'][above].sum() == pytest.approx(1)


def test_grid_is_finer_only_where_neighbours_differ(outcome):
    """The set changes along w and not along the damping."""
    assert outcome.arrays['set'].shape == (3, 3)
    computed = np.array([[True, True, True], [False, True, False], [True, True, True]])
    assert np.array_equal(outcome.arrays['computed'], computed)
    names = outcome.further['_map']['set [-]'].reshape(3, 3)
    assert np.all(names[1, [0, 2]] == names[0, [0, 2]])


def test_map_goes_on_from_finished_tasks_to_the_same_bits(tmp_path, outcome):
    arguments = {
        'begin': 0.65, 'end': 0.75, 'count': 2, 'across': 'mesh_damping_ratio',
        'across_begin': 0.05, 'across_end': 0.055, 'across_count': 2, 'starts': 8, 'transient': 300,
    }  # fmt: skip
    for taken in (0, 2):
        runner = Runner(tmp_path)
        again = study.regimes(kahraman_singh_point(0.75), runner=runner, **arguments)
        assert runner.taken == taken
        assert np.array_equal(again.arrays['rms'], outcome.arrays['rms'])
        runner.close()


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'parameter': 'speed', 'begin': 1.0, 'end': 2.0, 'across': 'w'}, 'name two different'),
        ({'across': 'w'}, 'name two different'),
        ({'across': 'load_torque'}, 'give --across-begin and --across-end'),
        ({'begin': 2.0}, 'begin 2 is not below end 1.5'),
        ({'across': 'teeth'}, 'teeth cannot be varied'),
        ({'across_end': 3.0}, 'friction_coefficient is 3'),
    ],
)
def test_impossible_maps_are_refused(arguments, words):
    with pytest.raises(ParameterError, match=words):
        study.regimes(kahraman_singh_point(0.75), **arguments)


def test_places_between_have_the_corners_as_neighbours():
    grid = RegimeGrid.over((0.0, 1.0), 2, (0.0, 2.0), 2, 1)
    assert list(grid.values) == [0.0, 0.5, 1.0]
    assert grid.first() == [(0, 0), (0, 2), (2, 0), (2, 2)]
    between = dict(grid.between(2))
    assert between[0, 1] == [(0, 0), (0, 2)]
    assert between[1, 1] == [(0, 0), (0, 2), (2, 0), (2, 2)]
    assert len(between) == 5


def test_name_of_a_set_has_periods_in_their_order():
    kinds = ['chaotic', 'period-12', 'period-2', 'period-2']
    assert set_name(kinds) == 'period-2 + period-2 + period-12 + chaotic'


def test_two_records_of_one_chaotic_motion_are_one_attractor():
    """Two stretches of the Hénon map, and one that is shifted by half its width."""
    series = henon(601)
    points = np.stack([series[1:], 0.3 * series[:-1]], axis=1)
    first, second = points[:300], points[300:]
    assert dynamics.same_cloud(first, second)
    assert not dynamics.same_cloud(first, second + np.array([0.0, 0.3]))
