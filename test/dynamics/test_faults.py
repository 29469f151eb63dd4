"""Tangent vectors of machines with faults: exponents and multipliers are made of them."""

import dataclasses

import numpy as np
import pytest

import gear_dynamics as gd
from gear_dynamics.dynamics.cycles import VARIED, run_cycles
from gear_dynamics.model.faults.collection import fault_ports

PAIR = gd.GearPair(
    pinion_bore=0.03,
    gear_bore=0.05,
    mesh_stiffness='potential_energy',
    friction_coefficient=0.05,
)
SPEED, TORQUE, CYCLES = 400.0, 60.0, 6
FIVE = [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]
"""Positions and velocities of the reduced form among the states."""

TIGHT = {'rtol': 1e-13, 'atol': 1e-15}
GIVEN = {
    'bearing_defect': {'length': 2e-3},
    'misalignment': {'widest': 5e-6},
    'missing_tooth': {'tooth': 2, 'severity': 1.0},
    'chipped_tooth': {'tooth': 2},
    'root_crack': {'tooth': 2},
    'spall': {'tooth': 2, 'deepest': 4e-6},
}


@pytest.mark.parametrize('kind', gd.faults.KINDS)
def test_tangent_vectors_are_the_derivatives_of_the_motion(kind):
    fault = gd.faults.KINDS[kind](**{'severity': 0.5, **GIVEN.get(kind, {})})
    ports = fault_ports(PAIR, [fault], gd.faults.SpeedAndLoad(SPEED, TORQUE))
    begin = run_cycles([PAIR], SPEED, TORQUE, 32, **TIGHT).states[0]
    step, wn = 1e-11, PAIR.derived.wn
    scale = np.array([1.0] * 5 + [wn] * 5)
    states = np.repeat(begin[np.newaxis], 2 * VARIED, axis=0)
    for i, j in enumerate(FIVE):
        states[2 * i, j] += step * scale[i]
        states[2 * i + 1, j] -= step * scale[i]
    near = [PAIR] * 2 * VARIED
    given = [ports] * 2 * VARIED
    ends = run_cycles(near, SPEED, TORQUE, CYCLES, states=states, ports=given, **TIGHT).states
    difference = (ends[::2] - ends[1::2])[:, FIVE] / (2 * step * scale)
    varied = run_cycles(
        [PAIR],
        SPEED,
        TORQUE,
        CYCLES,
        states=begin[None],
        ports=[ports],
        vectors=np.eye(VARIED)[np.newaxis],
        orthogonal=False,
        **TIGHT,
    )
    apart = np.abs(varied.vectors[0] - difference).max(axis=0)
    assert np.all(apart <= 1e-6 * np.abs(difference).max(axis=0))


@pytest.mark.parametrize('kind', gd.faults.KINDS)
def test_exponents_sum_to_the_divergence(kind):
    pair = dataclasses.replace(PAIR, friction_coefficient=0.02)
    fault = gd.faults.KINDS[kind](**{'severity': 0.5, **GIVEN.get(kind, {})})
    ports = fault_ports(pair, [fault], gd.faults.SpeedAndLoad(SPEED, TORQUE))
    run = run_cycles([pair], SPEED, TORQUE, 100, vectors=np.eye(VARIED)[np.newaxis], ports=[ports])
    assert run.growth.sum() == pytest.approx(run.divergence.sum(), rel=1e-6)
