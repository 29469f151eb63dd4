import math

import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.dynamics.nearby import nearby_growth
from gear_dynamics.study import chaos_edges
from gear_dynamics.study.chaos_edges import (
    BEGIN,
    END,
    chaotic_stretches,
    edge_in,
    edge_indices,
    edges_text,
    ranges_text,
)
from gear_dynamics.study.initial import scattered_states

KINDS = np.array(['period-1', 'chaotic', 'period-2', 'chaotic', 'chaotic', 'chaotic', 'period-1'])


def test_every_range_of_chaos_is_named_and_lasting_ones_have_edges():
    assert chaotic_stretches(KINDS) == [(1, 1), (3, 5)]
    assert ranges_text(np.arange(7.0), KINDS) == 'chaos at 1, 3 to 5'
    assert ranges_text(np.arange(1.0), KINDS[:1]) == 'no chaotic value'
    assert edge_indices(KINDS) == {BEGIN: 3, END: 5}
    # Chaos at the end of the range has no edge there; a single value has none at all.
    assert edge_indices(KINDS[:6]) == {BEGIN: 3}
    assert edge_indices(KINDS[3:]) == {END: 2}
    assert edge_indices(KINDS[:3]) == {}


def test_edge_in_a_finer_sweep():
    assert edge_in(np.arange(7.0), KINDS, BEGIN) == 3.0
    assert edge_in(np.arange(7.0), KINDS, END) == 5.0
    assert math.isnan(edge_in(np.arange(4.0), KINDS[3:], BEGIN))
    assert math.isnan(edge_in(np.arange(3.0), KINDS[:3], BEGIN))


def test_text_of_edges():
    """Chaos from the first value on that ends inside; none that lasts; edges out of the finer
    sweeps; chaos that was a transient."""
    grid = np.array([0.0, 0.4, 0.8, 1.2, 1.6, 2.4, 2.8])
    fine = np.array([np.linspace(1.0, 1.6, 7), np.linspace(2.0, 2.6, 7)])
    none = np.full((2, 7), np.nan)
    inside = np.array([KINDS, KINDS])
    assert (
        edges_text(grid, KINDS, fine, inside)
        == 'chaos first begins at 1.3; chaos first ends at 2.5'
    )
    assert (
        edges_text(grid[:3], KINDS[:3], none, inside) == 'no chaos at 3 or more neighbouring values'
    )
    only_end = np.array([none[0], fine[1]])
    assert edges_text(grid[3:], KINDS[3:], only_end, inside) == (
        'chaos from the first value on; chaos first ends at 2.5'
    )
    chaos, regular = np.full(7, 'chaotic'), np.full(7, 'period-1')
    assert edges_text(grid, KINDS, fine, np.array([chaos, chaos])) == (
        'chaos first begins below 1; chaos first ends above 2.6'
    )
    assert edges_text(grid, KINDS, fine, np.array([regular, KINDS])) == (
        'no lasting chaos from 1 to 1.6 after longer transients; chaos first ends at 2.5'
    )


def test_an_edge_that_longer_transients_move_is_given_on_the_grid_too():
    fine = np.array([np.full(7, np.nan), np.linspace(2.0, 2.6, 7)])
    grid = np.linspace(0.0, 6.0, 7)
    kinds = np.array([*['chaotic'] * 6, 'period-1'])
    assert edges_text(grid, kinds, fine, np.array([KINDS, KINDS])) == (
        'chaos from the first value on; '
        'chaos first ends at 2.5 after longer transients, at 5 on the grid'
    )


def test_finer_sweep_moves_on_to_the_edge(monkeypatch):
    """The grid shows chaos from 20 on; after longer transients it begins at 8.05, and ends at 34.5
    instead of 30: each is outside of the first finer sweep."""
    values = np.arange(41.0)
    grid = np.where((values >= 20) & (values <= 30), 'chaotic', 'period-1')

    def measured(chains, states, cycles, runner):
        kinds = [['chaotic' if 8.05 <= x <= 34.5 else 'period-1' for x in c] for c in chains]
        return {
            'kind': np.array(kinds),
            **{name: np.zeros((len(chains), 61)) for name in chaos_edges.EXPONENT_UNITS},
        }

    monkeypatch.setattr(chaos_edges, 'chain_along', lambda operation, parameter, values: values)
    monkeypatch.setattr(chaos_edges, 'follow', lambda chains, states, cycles, runner: states)
    monkeypatch.setattr(chaos_edges, 'measure', measured)
    found = chaos_edges.refine(
        [None, None], 'w', values, np.array([grid, grid]), np.zeros((2, 41, 13)), None
    )
    for values, kinds in zip(found['values'], found['kind'], strict=True):
        assert edge_in(values[BEGIN], kinds[BEGIN], BEGIN) == pytest.approx(8.1)
        assert edge_in(values[END], kinds[END], END) == pytest.approx(34.5)


def test_end_of_chaos_along_friction_is_refined():
    """The preset is chaotic at mu = 0 and has period-4 at 0.05 (seen by independent codes)."""
    chaos = study.friction_chaos()
    outcome = study.bifurcation(
        chaos, parameter='friction_coefficient', begin=0.0, end=0.1, count=21, transient=400
    )
    assert outcome.text.count('chaos from the first value on; chaos first ends at 0.0') == 2
    table = outcome.further['_edges']
    assert set(table['edge [-]']) == {'end'}
    ends = table['friction_coefficient [1]'][table['kind [-]'] == 'chaotic']
    assert 0.02 < ends.max() < 0.05


def test_edge_parts_growth_from_decay(monkeypatch):
    """Below the begin of chaos two nearby motions come together, above it they part."""
    monkeypatch.setattr(chaos_edges, 'EDGE_TRANSIENT', 300)
    monkeypatch.setattr(chaos_edges, 'FINER', 4)
    chaos = study.friction_chaos()
    outcome = study.bifurcation(chaos, [0.0], begin=1.14, end=1.19, count=11, transient=200)
    fine, kinds = outcome.arrays['fine_values'][0, :, BEGIN], outcome.arrays['fine_kind'][0]
    assert fine.shape == (2, 25)
    table = outcome.further['_edges']
    assert np.array_equal(table['w [1]'], fine.ravel())
    assert np.array_equal(table['kind [-]'], kinds[:, BEGIN].ravel())
    assert np.abs(table['sum_error [1]']).max() < 1e-6
    assert np.diff(fine, axis=1) == pytest.approx(0.005 / 4)
    for along, kind in zip(fine, kinds[:, BEGIN], strict=True):
        place = edge_in(along, kind, BEGIN)
        rates = []
        for w in (along[0], place + 0.005):
            at = chaos.with_value('friction_coefficient', 0.0).with_value('w', w)
            states = np.repeat(scattered_states(at, 1), 4, axis=0)
            growth = nearby_growth([at.pair] * 4, at.speed, at.load_torque, 1500, states)
            rates.append(growth[:, 1000:].mean())
        assert rates[0] < 0 < rates[1]
        assert f'{place:.6g}' in outcome.text
