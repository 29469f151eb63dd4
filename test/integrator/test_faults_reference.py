"""Machines with every fault on against SciPy's DOP853 on equations written anew."""

import dataclasses

import numpy as np
import pytest
from comparison import ACCURACY, RATE, columns, relative_errors, simulator
from reference_run import Reference

from gear_dynamics.model import faults
from gear_dynamics.model.faults.collection import machine_ports
from gear_dynamics.model.gear_pair import GearPair

LOAD = 150.0
COUNT = 110
"""Samples: three mesh cycles or more, in which the faulty teeth below pass."""

RECTANGULAR = GearPair()
POTENTIAL_ENERGY = GearPair(
    pinion_bore=0.03,
    gear_bore=0.05,
    mesh_stiffness='potential_energy',
    friction_model='benedict_kelley',
    tip_relief_amount=8e-6,
    tip_relief_length=1.5e-3,
    transmission_error_amplitude=5e-6,
)
EVERY_FAULT = (
    faults.RootCrack('pinion', tooth=0, severity=0.6),
    faults.Spall('gear', tooth=0, severity=0.4),
    faults.ChippedTooth('pinion', tooth=1, severity=0.3),
    faults.MissingTooth('gear', tooth=2, severity=0.5),
    faults.Wear('gear', severity=0.3),
    faults.PitchErrors('pinion', severity=0.5),
    faults.Eccentricity('pinion', severity=0.3),
    faults.Misalignment(severity=0.2),
    faults.Unbalance('pinion', severity=0.5),
    faults.BentShaft('gear', severity=0.4),
    faults.LoadFluctuation(severity=0.4, shape='random', order=20.0),
    faults.LubricationLoss(severity=0.3),
    faults.SupportWear('gear', severity=0.5),
    faults.BearingDefect('pinion', severity=0.5, length=2e-3),
)


def plain(pair):
    """Return the pair as the reference takes it, which knows one stiffness and no bores.

    All else of the pair is in `machine_ports`.
    """
    d = pair.derived
    return dataclasses.replace(
        pair,
        mesh_stiffness='rectangular',
        tooth_pair_stiffness=d.single_stiffness,
        pinion_mass=d.pinion_mass,
        gear_mass=d.gear_mass,
        pinion_inertia=d.pinion_inertia,
        gear_inertia=d.gear_inertia,
    )


def test_every_kind_of_fault_is_on():
    assert {each.kind() for each in EVERY_FAULT} == set(faults.KINDS)


@pytest.mark.filterwarnings('ignore:friction_model')
@pytest.mark.parametrize(
    ('pair', 'rpm'), [(RECTANGULAR, 2500), (POTENTIAL_ENERGY, 3200)], ids=['rectangle', 'energy']
)
def test_every_fault_together_equals_reference(pair, rpm):
    speed = rpm * np.pi / 30
    machine = simulator(pair, speed, LOAD, 1e-12, faults=EVERY_FAULT)
    # Pairs that pitch errors part make the static deflection a search, so the reference takes it.
    start = machine.state().coordinates()
    got = columns(machine.advance(COUNT))
    ports = machine_ports(pair, EVERY_FAULT, faults.SpeedAndLoad(speed, LOAD))
    reference = Reference(plain(pair), speed, LOAD, ports)
    rows, away = reference.run(np.arange(COUNT) / RATE, start)
    assert reference.events
    assert np.count_nonzero(away) > 0.9 * COUNT
    assert relative_errors(got[away], rows[away]).max() < ACCURACY
