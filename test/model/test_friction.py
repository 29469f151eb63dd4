"""Friction over the path of contact, against numbers worked out from the published formulas."""

import dataclasses
import warnings

import numpy as np
import pytest

from gear_dynamics.model.friction import (
    FADE,
    LOWEST,
    benedict_kelley,
    coefficient,
    contact,
    friction_ports,
    xu_kahraman,
)
from gear_dynamics.model.gear_pair import GearPair

SLIDE_TO_ROLL = np.array([0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0])
XU_KAHRAMAN = [0.00588, 0.01040, 0.01616, 0.01907, 0.02068, 0.02004, 0.01816]


def test_regression_of_xu_and_kahraman():
    # At 1 GPa, 10 m/s, 10 mm, 10 mPa s, 0.4 um.
    found = xu_kahraman(1e9, SLIDE_TO_ROLL, 10.0, 0.01, 0.01, 0.4e-6)
    assert found == pytest.approx(XU_KAHRAMAN, abs=6e-6)


@pytest.mark.parametrize(('roughness', 'figure'), [(0.0, 0.03645), (0.4e-6, 0.05642)])
def test_formula_of_benedict_and_kelley(roughness, figure):
    # At 200 N/mm, sliding 2 m/s, rolling 20 m/s, 10 mPa s.
    assert benedict_kelley(200e3, 2.0, 20.0, 0.01, roughness) == pytest.approx(figure, abs=5e-6)


def test_flank_speeds_at_ends_of_the_path():
    # Sliding is the distance to the pitch point times the sum of the speeds (Buckingham).
    pair = GearPair()
    d = pair.derived
    s = np.array([0.0, d.approach_length, d.path_length])
    turning = 100.0 * (1 + pair.pinion_teeth / pair.gear_teeth)
    at = contact(pair, s, 100.0, 150.0)
    assert at.sliding == pytest.approx(turning * (s - d.approach_length), abs=1e-12)


@pytest.mark.parametrize('model', ['benedict_kelley', 'xu_kahraman'])
@pytest.mark.parametrize('operation', [(104.72, 150.0), (1000.0, 400.0), (3000.0, 20.0)])
def test_polynomials_follow_the_model(model, operation):
    pair = GearPair(friction_model=model)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        (term,) = friction_ports(pair, *operation)
    s = np.linspace(1e-6, pair.derived.path_length - 1e-6, 1001)
    piece = np.searchsorted(term.edges, s, side='right') - 1
    x = (s - term.edges[piece]) / np.diff(term.edges)[piece]
    mu = pair.friction_coefficient + (term.friction[piece] * x[:, None] ** np.arange(7)).sum(axis=1)
    expected = coefficient(pair, s, *operation)
    assert mu == pytest.approx(expected, abs=1e-3 * expected.max())


def test_benedict_kelley_fades_at_the_pitch_point_and_has_a_floor():
    pair = GearPair(friction_model='benedict_kelley')
    pitch_point, reach = pair.derived.approach_length, FADE * pair.derived.path_length
    s = pitch_point + reach * np.array([-1.5, 0.0, 0.5, 1.5])
    mu = coefficient(pair, s, 104.72, 150.0)
    assert mu[1] == 0 < mu[2] < mu[3]
    light = coefficient(pair, s[[0, 3]], 5000.0, 0.01)
    assert light == pytest.approx([LOWEST, LOWEST])


@pytest.mark.parametrize(
    ('values', 'operation', 'named'),
    [
        ({'friction_model': 'benedict_kelley', 'roughness': 1e-6}, (104.72, 500.0), 'roughness'),
        ({'friction_model': 'benedict_kelley'}, (104.72, 5.0), r'load \[N/mm\] from 50 to 2000'),
        ({'friction_model': 'xu_kahraman', 'viscosity': 1.0}, (104.72, 300.0), 'viscosity'),
        ({'friction_model': 'xu_kahraman'}, (1.0, 300.0), 'entraining velocity'),
    ],
)
def test_operating_point_outside_the_range_warns_and_names_it(values, operation, named):
    with pytest.warns(UserWarning, match=named):
        friction_ports(GearPair(**values), *operation)


def test_coulomb_needs_no_ports():
    pair = dataclasses.replace(GearPair(), friction_model='coulomb')
    assert len(friction_ports(pair, 104.72, 150.0)) == 0
