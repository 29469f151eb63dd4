"""The ports against SciPy's DOP853 on equations written anew, with events of its own."""

import dataclasses
import itertools

import numpy as np
import pytest
from comparison import ACCURACY, RATE, columns, relative_errors, simulator
from reference_equations import Ramp
from reference_run import Reference

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import (
    Harmonic,
    Offset,
    Ports,
    Table,
    ToothDeviation,
    periodic_cubics,
    smooth_pulse,
)

DEFAULT = GearPair()
RPM = np.pi / 30
COUNT = 160
PULSES = [smooth_pulse(4e-6), [0.0] * 7, smooth_pulse(2e-6), [0.0] * 7]
NOISE = periodic_cubics(np.random.default_rng(1).standard_normal(7))

TERMS = {
    'eccentricity': [
        Harmonic('transmission_error', 'pinion', 1.0, 30e-6, 0.4),
        Harmonic('half_backlash', 'pinion', 1.0, 10e-6, 1.0),
        Harmonic('transmission_error', 'gear', 1.0, 20e-6, 2.0),
    ],
    'unbalance': [
        Harmonic('pinion_force_x', 'pinion', 1.0, -0.003, np.pi / 2, derivative=2),
        Harmonic('pinion_force_y', 'pinion', 1.0, -0.003, 0.0, derivative=2),
        Harmonic('gear_force_x', 'gear', 3.5, 40.0, 0.3, derivative=0),
    ],
    'bearing': [
        Table('pinion_rest_y', 'pinion', [0.0, 0.02, 0.07, 0.09, 0.131], PULSES),
        Table('gear_rest_x', 'gear', [0.003, 0.02, 0.05, 0.06, 0.09], PULSES),
    ],
    'torques': [
        Harmonic('load_torque', 'time', 900.0, 30.0, 0.2),
        Harmonic('drive_torque', 'mesh', 1.0, 4.0),
        Table('load_torque', 'time', 0.0002 * np.arange(8), 20 * NOISE),
    ],
    'parameters': [
        Harmonic('friction', 'mesh', 1.0, 0.02, 1.0),
        Offset('friction', 0.04),
        Harmonic('pinion_support_stiffness', 'pinion', 2.0, 1e8),
        Harmonic('gear_support_damping', 'gear', 2.0, 300.0),
        Offset('gear_support_stiffness', -2e8),
    ],
}
TOOTH = ToothDeviation(
    'pinion', 2, [0.001, 0.004, 0.009], stiffness=[[-0.1, -0.3, 0.1], [-0.3, 0.0, 0.3]],
    damping=[[-0.2], [-0.2]], error=[[0.0, 0.0, 3e-6], [3e-6, 0.0, -3e-6]],
    friction=[[0.01, 0.0], [0.02, 0.05]], loss=0.2,
)  # fmt: skip
BROKEN = ToothDeviation('gear', 2, [0.002, 0.01], loss=0.6)
EVERYTHING = [*itertools.chain(*TERMS.values()), TOOTH, BROKEN]


def assert_equal(terms, rpm, pair=DEFAULT, **commands):
    ports = Ports(terms)
    got = columns(simulator(pair, rpm * RPM, 150.0, 1e-12, ports=ports).advance(COUNT))
    reference = Reference(pair, rpm * RPM, 150.0, ports)
    rows, away = reference.run(np.arange(COUNT) / RATE)
    assert np.count_nonzero(away) > 0.9 * COUNT
    assert relative_errors(got[away], rows[away]).max() < ACCURACY
    return reference


@pytest.mark.parametrize('name', TERMS)
def test_each_port_equals_reference(name):
    assert_equal(TERMS[name], 2500)


def test_all_ports_together_with_loss_of_contact_equal_reference():
    reference = assert_equal(EVERYTHING, 3200)
    assert reference.events


def test_gap_that_moves_where_the_damping_acts_in_it_equals_reference():
    assert_equal(TERMS['eccentricity'], 3200, GearPair(damping_in_gap=True))


def test_ports_that_come_in_and_go_out_equal_reference():
    first, second, third = (Ports(terms) for terms in (EVERYTHING, [TOOTH], []))
    model = simulator(DEFAULT, 2500 * RPM, 150.0, 1e-12, ports=third)
    got = [model.advance(40)]
    model.change(ports=first, ramp=60 / RATE)
    got.append(model.advance(COUNT - 40))
    # The terms are there at half their strength in the middle of the ramp.
    strength = Ramp([0.0, 40 / RATE, 100 / RATE, 1.0], [0.0, 0.0, 1.0, 1.0])
    reference = Reference(DEFAULT, 2500 * RPM, 150.0, first, strength=strength)
    rows, away = reference.run(np.arange(COUNT) / RATE)
    errors = relative_errors(columns(np.concatenate(got))[away], rows[away])
    assert errors.max() < ACCURACY
    # What is common to both stays, and what goes leaves the healthy machine: its drive alone needs
    # a second to come back.
    model.change(ports=second, ramp=20 / RATE)
    model.advance(40)
    model.change(ports=third, ramp=0.0)
    model.advance(20000)
    healthy = simulator(DEFAULT, 2500 * RPM, 150.0, 1e-12)
    healthy.advance(20200)
    assert relative_errors(columns(model.advance(100)), columns(healthy.advance(100))).max() < 1e-3


def test_loss_that_changes_goes_from_the_old_to_the_new_linearly():
    small, great = (Ports([dataclasses.replace(BROKEN, loss=loss)]) for loss in (0.3, 0.6))
    model = simulator(DEFAULT, 2500 * RPM, 150.0, 1e-12, ports=small)
    got = [model.advance(40)]
    model.change(ports=great, ramp=60 / RATE)
    got.append(model.advance(COUNT - 40))
    strength = Ramp([0.0, 40 / RATE, 100 / RATE, 1.0], [0.5, 0.5, 1.0, 1.0])
    reference = Reference(DEFAULT, 2500 * RPM, 150.0, great, strength=strength)
    rows, away = reference.run(np.arange(COUNT) / RATE)
    errors = relative_errors(columns(np.concatenate(got))[away], rows[away])
    assert errors.max() < ACCURACY


def test_ports_follow_a_speed_ramp_as_the_reference_does():
    model = simulator(
        DEFAULT, 1500 * RPM, 150.0, 1e-12, ports=Ports(EVERYTHING), speed_rate_limit=20000.0
    )
    got = [model.advance(40)]
    model.command(speed=200.0)
    got.append(model.advance(COUNT - 40))
    end = 40 / RATE + (200.0 - 1500 * RPM) / 20000.0
    speed = Ramp([0.0, 40 / RATE, end, 1.0], [1500 * RPM, 1500 * RPM, 200.0, 200.0])
    rows, away = Reference(DEFAULT, speed, 150.0, Ports(EVERYTHING)).run(np.arange(COUNT) / RATE)
    errors = relative_errors(columns(np.concatenate(got))[away], rows[away])
    assert errors.max() < ACCURACY
