"""Stiffness, friction, tip relief and transmission error of the formulas, seen in the motion."""

import dataclasses
import warnings

import numpy as np
import pytest

import gear_dynamics as gd
from gear_dynamics.model.friction import coefficient
from gear_dynamics.model.mesh.stiffness import pieces

SLOW = 2.0
"""Pinion speed at which the motion follows the load [rad/s]."""

QUIET = gd.GearPair(
    pinion_bore=0.03,
    gear_bore=0.05,
    friction_coefficient=0.0,
    transmission_error_amplitude=0.0,
    mesh_damping_ratio=0.5,
)


def slow_cycle(pair, load_torque=150.0):
    """Return the mesh phase and the samples of the second mesh cycle."""
    rate = 400 * pair.pinion_teeth * SLOW / (2 * np.pi)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        run = gd.simulate(
            pair, 800 / rate, rate, SLOW, load_torque, anti_alias=False, rtol=1e-9, atol=1e-12
        )
    return np.arange(400) / 400, run.samples[400:]


@pytest.mark.parametrize(
    'values',
    [
        {'mesh_stiffness': 'potential_energy'},
        {'mesh_stiffness': 'potential_energy_per_pair'},
        {'mesh_stiffness': 'iso_6336'},
        {'mesh_stiffness': 'harmonic', 'stiffness_harmonics': '0.2 0.5'},
        {'mesh_stiffness': 'rectangular', 'stiffness_ratio': 1.6},
        {'mesh_stiffness': 'constant'},
    ],
)
def test_slow_mesh_yields_by_the_stiffness_of_the_method(values):
    pair = dataclasses.replace(QUIET, **values)
    phase, samples = slow_cycle(pair)
    d, at = pair.derived, pieces(pair).at
    two = phase < d.contact_ratio - 1
    mesh = at(phase * d.base_pitch) + np.where(two, at((1 + phase) * d.base_pitch), 0.0)
    expected = samples['mesh_force'] / mesh
    # Away from the changes of pairs, after which the motion settles.
    calm = (abs(phase - (d.contact_ratio - 1)) > 0.1) & (phase > 0.1)
    yields = samples['delta'] - pair.half_backlash
    assert yields[calm] == pytest.approx(expected[calm], rel=2e-3)


@pytest.mark.parametrize('model', ['benedict_kelley', 'xu_kahraman'])
def test_friction_of_a_single_pair_is_that_of_the_model(model):
    pair = dataclasses.replace(QUIET, friction_model=model, friction_coefficient=0.03)
    phase, samples = slow_cycle(pair)
    d = pair.derived
    alone = phase > d.contact_ratio - 1 + 0.02
    s = phase[alone] * d.base_pitch
    ratio = samples['friction_force'][alone] / samples['mesh_force'][alone]
    side = np.where(s < d.approach_length, 1.0, -1.0)
    expected = side * coefficient(pair, s, SLOW, 150.0)
    assert ratio == pytest.approx(expected, abs=2e-3 * abs(expected).max())


def test_relieved_tip_takes_its_share_only_under_load():
    # Slack of 10 um: at 20 N m a pair yields by 0.7 um, so that the relieved one carries nothing.
    pair = dataclasses.replace(
        QUIET, mesh_stiffness='rectangular', tip_relief_amount=10e-6, tip_relief_length=4e-3
    )
    phase, samples = slow_cycle(pair, load_torque=20.0)
    inside = (phase > 0.05) & (phase < 0.3)
    yields = samples['delta'] - pair.half_backlash
    alone = samples['mesh_force'] / pair.tooth_pair_stiffness
    d = pair.derived
    # Pair B is beyond the relief's begin; its own error moves the mesh on.
    place = (1 + phase) * d.base_pitch
    relief = 10e-6 * np.maximum(place - (d.path_length - 4e-3), 0.0) / 4e-3
    leading = 10e-6 * np.maximum(1 - phase * d.base_pitch / 4e-3, 0.0)
    error = np.minimum(relief, leading)
    carries_alone = abs(relief - leading) > 2e-6
    chosen = inside & carries_alone
    assert yields[chosen] == pytest.approx((alone + error)[chosen], abs=3e-8)


def test_further_harmonics_add_to_the_transmission_error():
    one = gd.GearPair(transmission_error_amplitude=6e-6, transmission_error_phase=0.4)
    other = gd.GearPair(
        transmission_error_amplitude=0.0, transmission_error_harmonics='1 4e-6 0.4, 1 2e-6 0.4'
    )
    runs = [
        gd.simulate(pair, 0.1, anti_alias=False, rtol=1e-11, atol=1e-13) for pair in (one, other)
    ]
    np.testing.assert_allclose(runs[0]['delta'], runs[1]['delta'], rtol=1e-9)
    np.testing.assert_allclose(runs[0]['pinion_ay'], runs[1]['pinion_ay'], rtol=0, atol=1e-4)
