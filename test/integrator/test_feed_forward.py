"""The drive that makes up the mean friction at once: angles as published follow the mesh phase."""

import dataclasses
import math

import numpy as np
import pytest

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.system import feed_forward
from gear_dynamics.simulation.simulator import Simulator

RATE = 51200.0
PAIR = dataclasses.replace(GearPair(), drive_feed_forward=True)


@pytest.mark.parametrize('mu', [1e-6, 1e-4])
def test_the_moment_is_that_of_the_loss_factor(mu):
    """H. Ohlendorf 1958, as in Niemann and Winter: the tooth loss factor of a spur gear pair is
    pi (1/z1 + 1/z2) (1 - eps + eps1^2 + eps2^2), of first order in mu."""
    pair = dataclasses.replace(PAIR, friction_coefficient=mu)
    d = pair.derived
    parts = [d.approach_length / d.base_pitch, d.recess_length / d.base_pitch]
    factor = math.pi * (1 / 34 + 1 / 59) * (1 - sum(parts) + sum(part**2 for part in parts))
    assert feed_forward(pair) == pytest.approx(mu * factor * 34 / 59, rel=1e-3)


def test_without_the_option_nothing_is_made_up():
    assert feed_forward(GearPair()) == 0


def twist(pair, mu, rpm, change):
    """Greatest difference of the rigid rotation and the mesh phase [cycles], from the angles."""
    pair, speed = dataclasses.replace(pair, friction_coefficient=mu), rpm * np.pi / 30
    simulator = Simulator(pair, speed=speed, load_torque=150.0, anti_alias=False)
    rows = simulator.advance(round(0.2 * RATE))
    simulator.command(**change)
    rows = np.concatenate([rows, simulator.advance(round(0.3 * RATE))])
    ramp = np.clip((np.arange(len(rows)) - round(0.2 * RATE)) / RATE * 200, 0, None)
    commanded = np.minimum(speed + ramp, change.get('speed', speed))
    turned = np.concatenate([[0], np.cumsum((commanded[1:] + commanded[:-1]) / 2 / RATE)])
    d, cycles = pair.derived, []
    for name, teeth in (('pinion_angle', 34), ('gear_angle', 59)):
        angle = np.unwrap(rows[name])
        cycles.append((angle - 2 * np.pi * (angle[0] > np.pi)) * teeth / (2 * np.pi))
    weights = d.pinion_inertia, d.gear_inertia * (34 / 59) ** 2
    rigid = np.average(cycles, axis=0, weights=weights)
    return float(np.max(np.abs(rigid - turned * 34 / (2 * np.pi))))


@pytest.mark.parametrize('change', [{'load_torque': 250.0}, {'speed': 150.0}])
def test_angles_follow_the_mesh_from_the_first_sample_on(change):
    assert twist(PAIR, 0.03, 1000, change) < 0.005
    # What the drive's spring yields without it.
    assert twist(GearPair(), 0.03, 1000, change) > 0.5


def test_at_high_friction_and_speed_the_static_value_leaves_a_little():
    assert twist(PAIR, 0.1, 1000, {'load_torque': 250.0}) < 0.03
    assert twist(PAIR, 0.1, 2500, {'load_torque': 250.0}) < 0.15
