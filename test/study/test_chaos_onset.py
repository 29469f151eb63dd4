import math

import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.dynamics.nearby import nearby_growth
from gear_dynamics.study import chaos_onset
from gear_dynamics.study.chaos_onset import chaotic_ranges, onset, onset_words
from gear_dynamics.study.initial import scattered_states

KINDS = np.array(['period-1', 'chaotic', 'period-2', 'chaotic', 'chaotic', 'chaotic'])


def test_ranges_of_chaos():
    assert chaotic_ranges(np.arange(6.0), KINDS) == [(3.0, 5.0)]
    assert chaotic_ranges(np.arange(3.0), KINDS[:3]) == []


def test_onset_is_the_least_value_of_the_first_range():
    assert onset(np.arange(6.0), KINDS) == 3.0
    assert math.isnan(onset(np.arange(3.0), KINDS[:3]))
    # Chaos from the first value on: where it begins is not in the range.
    assert math.isnan(onset(np.arange(3.0), KINDS[3:]))


def test_words_tell_an_onset_from_none():
    fine = np.linspace(1.0, 1.5, 6)
    assert onset_words(fine, KINDS, 'begins at') == 'chaos begins at 1.3'
    assert onset_words(fine[:3], KINDS[:3], 'begins at') == 'no lasting chaos between 1 and 1.2'
    assert onset_words(fine[:3], KINDS[3:], 'lasts to') == 'chaos lasts to less than 1'
    none = onset_words(np.full(6, np.nan), np.zeros(6, 'U16'), 'begins at')
    assert none == 'the range has no onset of chaos'


def test_onset_parts_growth_from_decay(monkeypatch):
    """Below it two nearby motions come together, above it they part."""
    monkeypatch.setattr(chaos_onset, 'TRANSIENT', 300)
    monkeypatch.setattr(chaos_onset, 'FINER', 4)
    transients, follow = [], chaos_onset.follow

    def noted(chains, states, cycles, runner):
        transients.append(cycles)
        return follow(chains, states, cycles, runner)

    monkeypatch.setattr(chaos_onset, 'follow', noted)
    chaos = study.friction_chaos()
    outcome = study.bifurcation(chaos, [0.0], begin=1.14, end=1.19, count=11, transient=200)
    fine, kinds = outcome.arrays['fine_values'][0], outcome.arrays['fine_kind'][0]
    assert fine.shape == (2, 25)
    assert transients == [300]
    table = outcome.further['_onset']
    assert np.array_equal(table['w [1]'], fine.ravel())
    assert np.array_equal(table['kind [-]'], kinds.ravel())
    assert np.abs(table['sum_error [1]']).max() < 1e-6
    assert np.diff(fine, axis=1) == pytest.approx(0.005 / 4)
    for along, kind in zip(fine, kinds, strict=True):
        place = onset(along, kind)
        rates = []
        for w in (along[0], place + 0.005):
            at = chaos.with_value('friction_coefficient', 0.0).with_value('w', w)
            states = np.repeat(scattered_states(at, 1), 4, axis=0)
            growth = nearby_growth([at.pair] * 4, at.speed, at.load_torque, 1500, states)
            rates.append(growth[:, 1000:].mean())
        assert rates[0] < 0 < rates[1]
        assert f'{place:.6g}' in outcome.text
