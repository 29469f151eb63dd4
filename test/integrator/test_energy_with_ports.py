"""The energy balance with every port and every fault: change of kinetic energy is work of forces.

Forces are those of the equations written anew, on the integrator's own series; their work is
integrated within every step by a Gauss rule.
"""

import numpy as np
import pytest
from reference_equations import Equations
from test_energy import ACCURACY, NODES, WEIGHTS, begin, end
from test_faults_reference import EVERY_FAULT, POTENTIAL_ENERGY, RECTANGULAR, plain
from test_ports_reference import EVERYTHING

from gear_dynamics.model.faults.collection import machine_ports
from gear_dynamics.model.faults.fault import SpeedAndLoad
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Ports
from gear_dynamics.model.system import system
from gear_dynamics.simulation.simulator import Simulator

CYCLES = 6


def coordinates(pair, series, t):
    """Return the state (13,) in x1, y1, x2, y2, th1, th2 at t into the step."""
    value = np.polynomial.polynomial.polyval(t, series)
    slope = np.polynomial.polynomial.polyval(t, np.polynomial.polynomial.polyder(series))
    y = np.concatenate([value[:6], slope[:6], value[7:]])
    angles = system(pair).angles
    y[4:6], y[10:12] = angles @ y[4:6], angles @ y[10:12]
    return y


def balance(simulator, equations, cycles):
    """Return change of kinetic energy, work of all forces, and loss in the pinion's support."""
    pair, speed = equations.pair, equations.speed(0.0)
    motion = simulator.state().motion
    record, series = motion.records[0], motion.records[0]['series']
    equations._follow_commands(0.0)
    masses = np.array([equations.m1] * 2 + [equations.m2] * 2 + [equations.i1, equations.i2])
    rigid = np.array([0, 0, 0, 0, speed, speed * pair.pinion_teeth / pair.gear_teeth])
    work = change = lost = 0.0
    while record['phase']['cycle'] < cycles:
        begin(*motion)
        length, since = record['step']['length'], record['step']['begin']
        if length > 0:
            equations.near = since + length / 2
            pairs = equations.pairs_at(equations.phase(equations.near))
            for tooth_pair, contact in zip(pairs, record['contact']['state'][0], strict=False):
                tooth_pair.contact = int(contact)
            for node, weight in zip(NODES, WEIGHTS, strict=True):
                t = length * (node + 1) / 2
                y = coordinates(pair, series, t)
                rates = equations.slope(since + t, y, pairs)[6:12]
                work += length / 2 * weight * np.dot(masses * rates, y[6:12] + rigid)
                lost += length / 2 * weight * equations.c1 * np.dot(y[6:8], y[6:8])
            before, after = (coordinates(pair, series, t)[6:12] + rigid for t in (0.0, length))
            change += np.dot(masses, after**2 - before**2) / 2
        end(*motion)
    return change, work, lost, record['counts']


TIGHT = {'anti_alias': False, 'rtol': 1e-11, 'atol': 1e-14}


@pytest.mark.parametrize('rpm', [1500, 3200])
def test_kinetic_energy_changes_by_the_work_of_all_forces(rpm):
    pair, speed = GearPair(), rpm * np.pi / 30
    ports = Ports(EVERYTHING)
    simulator = Simulator(pair, speed=speed, ports=ports, **TIGHT)
    equations = Equations(pair, speed, 150.0, ports)
    change, work, lost, counts = balance(simulator, equations, cycles=6)
    assert lost > 0
    assert abs(change - work) < ACCURACY * lost
    assert counts['rejected_steps'] > 0 or rpm == 1500


@pytest.mark.filterwarnings('ignore:friction_model')
@pytest.mark.parametrize('pair', [RECTANGULAR, POTENTIAL_ENERGY], ids=['rectangle', 'energy'])
def test_energy_closes_with_every_fault_on(pair):
    speed = 2500 * np.pi / 30
    simulator = Simulator(pair, speed=speed, faults=EVERY_FAULT, **TIGHT)
    ports = machine_ports(pair, EVERY_FAULT, SpeedAndLoad(speed, 150.0))
    equations = Equations(plain(pair), speed, 150.0, ports)
    change, work, lost, counts = balance(simulator, equations, cycles=4)
    assert lost > 0
    assert abs(change - work) < ACCURACY * lost
    assert counts['contact_losses'] > 0
