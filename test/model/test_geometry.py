"""Geometry and scales of the default pair, and pairs that cannot run."""

import dataclasses
import math

import pytest

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.parameter import ParameterError

DERIVED = GearPair().derived

# Standard addendum, 34/59 teeth, module 2 mm, 20 deg, steel discs 38.4 mm wide: published to the
# digits that stand here.
FIGURES = [
    ('approach_length', 1e3, '5.261'),
    ('recess_length', 1e3, '4.961'),
    ('path_length', 1e3, '10.222'),
    ('base_pitch', 1e3, '5.9043'),
    ('contact_ratio', 1, '1.7313'),
    ('pinion_base_radius', 1e3, '31.950'),
    ('gear_base_radius', 1e3, '55.442'),
    ('pinion_mass', 1, '1.0947'),
    ('pinion_inertia', 1e4, '6.3276'),
    ('equivalent_mass', 1, '0.46534'),
    ('wn', 1, '33844'),
]


@pytest.mark.parametrize(('name', 'scale', 'figure'), FIGURES)
def test_default_pair_has_the_known_figures(name, scale, figure):
    decimals = len(figure.partition('.')[2])
    assert f'{getattr(DERIVED, name) * scale:.{decimals}f}' == figure


def test_natural_frequency_in_hertz():
    assert f'{DERIVED.wn / (2 * math.pi):.0f}' == '5386'


@pytest.mark.parametrize(('rpm', 'ratio'), [(1000, '0.105'), (11616, '1.222')])
def test_frequency_ratio_of_speed(rpm, ratio):
    assert f'{34 * rpm * 2 * math.pi / 60 / DERIVED.wn:.3f}' == ratio


def test_damping_follows_its_definition():
    pair = GearPair(mesh_damping_ratio=0.1, support_damping_ratio=0.2, gear_mass=4.0)
    d = pair.derived
    assert d.tooth_pair_damping == pytest.approx(2 * 0.1 * math.sqrt(5.33e8 * d.equivalent_mass))
    assert d.pinion_support_damping == pytest.approx(2 * 0.2 * math.sqrt(5e8 * d.pinion_mass))
    assert d.gear_support_damping == pytest.approx(2 * 0.2 * math.sqrt(5e8 * 4.0))


def test_given_masses_replace_the_disc_and_inertia_follows_mass():
    d = GearPair(pinion_mass=2.0, gear_inertia=0.01).derived
    assert d.pinion_mass == 2.0
    assert d.pinion_inertia == pytest.approx(2.0 * 0.034**2 / 2)
    assert d.gear_inertia == 0.01
    # A solid steel disc of radius 59 mm and width 38.4 mm.
    assert d.gear_mass == pytest.approx(7850 * math.pi * 0.059**2 * 0.0384)


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        # Many teeth at a low pressure angle reach a contact ratio of 2.
        ({'pinion_teeth': 200, 'gear_teeth': 200, 'pressure_angle_deg': 14.5}, 'contact ratio'),
        ({'pinion_teeth': 12, 'gear_teeth': 60}, "gear's tip would interfere"),
        ({'pinion_teeth': 60, 'gear_teeth': 12}, "pinion's tip would interfere"),
    ],
)  # fmt: skip
def test_impossible_contact_is_refused_with_the_reason(changes, reason):
    with pytest.raises(ParameterError, match=reason) as caught:
        dataclasses.replace(GearPair(), **changes)
    message = str(caught.value)
    assert '\n' not in message
    assert f'{changes["pinion_teeth"]}/{changes["gear_teeth"]} teeth' in message


def test_least_teeth_without_interference_with_a_gear_of_their_size():
    # Textbook: 13 equal teeth of standard addendum at 20 deg are the fewest that mesh.
    GearPair(pinion_teeth=13, gear_teeth=13)
    with pytest.raises(ParameterError, match='interfere'):
        GearPair(pinion_teeth=12, gear_teeth=12)


@pytest.mark.parametrize(('pinion', 'largest_gear'), [(13, 16), (14, 26), (15, 45), (16, 101)])
def test_largest_gear_that_a_pinion_meshes_with(pinion, largest_gear):
    # Shigley, Mechanical Engineering Design, eq. (13-12), full depth, 20 deg.
    GearPair(pinion_teeth=pinion, gear_teeth=largest_gear)
    with pytest.raises(ParameterError, match="gear's tip would interfere"):
        GearPair(pinion_teeth=pinion, gear_teeth=largest_gear + 1)
