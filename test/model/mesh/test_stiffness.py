"""Stiffness of a tooth pair against published numbers, and its polynomials against the formulas."""

import dataclasses

import numpy as np
import pytest

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh import iso_6336
from gear_dynamics.model.mesh.potential_energy import PotentialEnergy
from gear_dynamics.model.mesh.stiffness import pieces, stiffness
from gear_dynamics.parameters.parameter import ParameterError

BORED = GearPair(pinion_bore=0.03, gear_bore=0.05)
EQUAL = GearPair(
    pinion_teeth=62,
    gear_teeth=62,
    module=0.002,
    face_width=0.02,
    pinion_bore=0.035,
    gear_bore=0.035,
    youngs_modulus=206e9,
    poissons_ratio=0.3,
    mesh_stiffness='potential_energy_per_pair',
)
"""The example pair of the rotor dynamics package ROSS."""

METHODS = [
    {'mesh_stiffness': 'potential_energy'},
    {'mesh_stiffness': 'potential_energy_per_pair'},
    {'mesh_stiffness': 'iso_6336'},
    {'mesh_stiffness': 'harmonic', 'stiffness_harmonics': '0.3 0, 0.1 1.57'},
    {'mesh_stiffness': 'rectangular', 'stiffness_ratio': 1.6},
]


def over_cycle(first, second, contact_ratio, base_pitch):
    """Return the stiffness of the mesh over one cycle: `first` of a place s, `second` of s + pb."""
    phase = (np.arange(4000) + 0.5) / 4000
    two = phase < contact_ratio - 1
    return first(phase * base_pitch) + np.where(two, second((1 + phase) * base_pitch), 0.0)


def test_equal_pair_has_the_published_stiffness():
    # From the formulas of Ma et al. (2014) and Sainsot et al. (2004), at true places on the path.
    derived, energy = EQUAL.derived, PotentialEnergy.of(EQUAL, body_once=False)
    assert derived.contact_ratio == pytest.approx(1.78977987, abs=1e-8)
    assert energy.contact_stiffness == pytest.approx(3.5559e9, rel=1e-4)
    at = stiffness(EQUAL).at
    mesh = over_cycle(at, at, derived.contact_ratio, derived.base_pitch)
    assert mesh[0] == pytest.approx(3.861e8, rel=1e-3)
    assert mesh.max() == pytest.approx(4.058e8, rel=1e-3)
    assert mesh.min() == pytest.approx(2.2005e8, rel=1e-3)
    assert mesh.mean() == pytest.approx(3.615e8, rel=1e-3)


@pytest.mark.parametrize(
    ('pinion', 'gear', 'figure'),
    [(17, 43, 16.03), (25, 30, 16.12), (36, 90, 18.38), (50, 50, 18.02)],
)
def test_theoretical_stiffness_of_iso_6336(pinion, gear, figure):
    # N/(mm um) is 1e9 N/m2.
    found = iso_6336.theoretical_stiffness(pinion, gear) / 1e9
    assert found == pytest.approx(figure, rel=1e-3)


def test_single_stiffness_of_iso_6336():
    # c' = 13.885 N/(mm um) of 34/59 teeth, times 38.4 mm.
    assert BORED.derived.iso_6336_stiffness == pytest.approx(13.885e9 * 0.0384, rel=1e-4)
    pair = dataclasses.replace(BORED, mesh_stiffness='iso_6336')
    s = np.linspace(0, pair.derived.path_length, 500)
    single = s[(s > pair.derived.path_length - pair.derived.base_pitch) & (s < 5.9e-3)]
    greatest = stiffness(pair).at(single).max()
    assert greatest == pytest.approx(BORED.derived.iso_6336_stiffness, rel=1e-3)


@pytest.mark.parametrize('values', METHODS)
def test_polynomials_are_good_to_a_millionth(values):
    pair = dataclasses.replace(BORED, **values)
    found, law = pieces(pair), stiffness(pair)
    s = np.linspace(1e-9, pair.derived.path_length - 1e-9, 5003)
    assert found.at(s) == pytest.approx(law.at(s), rel=1.5e-6)


def test_two_pairs_share_each_gear_body():
    pair = dataclasses.replace(BORED, mesh_stiffness='potential_energy')
    energy, at = PotentialEnergy.of(pair, body_once=True), stiffness(pair).at
    s = np.array([1e-3])
    ahead = s + pair.derived.base_pitch
    body = (energy.bodies(s) + energy.bodies(ahead)) / 2
    teeth = 1 / energy.teeth(s) + 1 / energy.teeth(ahead)
    assert at(s) + at(ahead) == pytest.approx(1 / (body + 1 / teeth), rel=1e-12)


def test_added_compliance_of_one_pair_is_that_of_the_mesh():
    pair = dataclasses.replace(BORED, mesh_stiffness='potential_energy')
    energy, at = PotentialEnergy.of(pair, body_once=True), stiffness(pair).at
    s, soft = np.array([1e-3]), 2e-10
    ahead = s + pair.derived.base_pitch
    body = (energy.bodies(s) + energy.bodies(ahead)) / 2
    teeth = 1 / (energy.teeth(s) + soft) + 1 / energy.teeth(ahead)
    assert at(s, soft) + at(ahead) == pytest.approx(1 / (body + 1 / teeth), rel=1e-12)


@pytest.mark.parametrize('bores', [(0.002, 0.05), (0.03, 0.1), (0.0, 0.05)])
def test_bore_outside_the_range_of_the_gear_body_formula_is_refused(bores):
    with pytest.raises(ParameterError, match=r'_bore is .*bores from [\d.]+ to [\d.]+ m'):
        GearPair(pinion_bore=bores[0], gear_bore=bores[1], mesh_stiffness='potential_energy')


def test_bores_change_masses_and_inertias():
    radius, bore, derived = BORED.derived.pinion_pitch_radius, 0.015, BORED.derived
    mass = 7850 * np.pi * (radius**2 - bore**2) * 0.0384
    assert derived.pinion_mass == pytest.approx(mass)
    assert derived.pinion_inertia == pytest.approx(mass * (radius**2 + bore**2) / 2)
    with pytest.raises(ParameterError, match='pinion_bore is 0\\.07 m'):
        GearPair(pinion_bore=0.07)


def test_table_is_linear_between_its_rows(tmp_path):
    file = tmp_path / 'stiffness.csv'
    file.write_text('# s [m], k [N/m]\n0, 4e8\n0.005, 6e8\n0.011, 3e8\n')
    pair = GearPair(mesh_stiffness='table', stiffness_table=str(file))
    assert pieces(pair).at(np.array([0.0025, 0.008])) == pytest.approx([5e8, 4.5e8])


@pytest.mark.parametrize(
    'text', ['0 4e8', '0 4e8\n0 5e8', '0 4e8\n1 -5', 'a b\nc d', '1 2 3\n4 5 6']
)
def test_malformed_table_is_refused_in_one_line(tmp_path, text):
    file = tmp_path / 'stiffness.txt'
    file.write_text(text)
    with pytest.raises(ParameterError, match=r'stiffness\.txt: ') as caught:
        GearPair(mesh_stiffness='table', stiffness_table=str(file))
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('text', ['0.3', '0.3 x', '1.2 0', '0.9 0, 0.9 0'])
def test_malformed_harmonics_are_refused(text):
    with pytest.raises(ParameterError, match='stiffness_harmonics'):
        GearPair(mesh_stiffness='harmonic', stiffness_harmonics=text)


def test_tip_relief_is_greatest_where_contact_begins_and_ends():
    pair = GearPair(tip_relief_amount=10e-6, tip_relief_length=2e-3)
    begin, end = pair.healthy_ports
    assert [begin.edges[0], end.edges[1]] == pytest.approx([0.0, pair.derived.path_length])
    assert begin.error[0, :2] == pytest.approx([10e-6, -10e-6])
    assert end.error[0, :2] == pytest.approx([0.0, 10e-6])
    with pytest.raises(ParameterError, match='tip_relief_length is 0 m'):
        GearPair(tip_relief_amount=10e-6)
