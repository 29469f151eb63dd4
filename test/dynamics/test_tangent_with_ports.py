"""Tangent vectors of machines with ports against differences of neighbouring motions."""

import numpy as np
import pytest

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.integrator.variation import VARIED
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Offset, Ports, Table, ToothDeviation, smooth_pulse

PORTS = Ports(
    [
        ToothDeviation(
            None, None, [0.0, 0.004, 0.0103], stiffness=[[-0.1, -0.2], [-0.3, 0.2, 0.1]],
            damping=[[-0.1], [0.2, -0.3]], friction=[[0.02, 0.05], [0.01, 0.0]],
            error=[[0.0, 4e-6], [4e-6, -4e-6]],
        ),
        Harmonic('transmission_error', 'pinion', 1.0, 20e-6, 0.4),
        Harmonic('half_backlash', 'gear', 1.0, 10e-6, 1.0),
        Harmonic('friction', 'mesh', 1.0, 0.02, 1.0),
        Harmonic('pinion_support_stiffness', 'pinion', 3.0, 1e8),
        Harmonic('gear_support_damping', 'pinion', 2.0, 400.0),
        Harmonic('gear_force_x', 'gear', 1.0, 50.0),
        Table('pinion_rest_y', 'pinion', [0.0, 0.02, 0.1], [smooth_pulse(2e-6), [0.0] * 7]),
        Offset('gear_support_stiffness', -1e8),
    ]
)  # fmt: skip
CYCLES = 3
STEP = 1e-10
PAIR = GearPair(half_backlash=60e-6)


@pytest.mark.parametrize('rpm', [1000, 4000])
def test_tangent_vectors_are_differences_of_motions(rpm):
    speed, wn = rpm * np.pi / 30, PAIR.derived.wn
    accuracy = {'rtol': 1e-13, 'atol': 1e-15}
    start = run_cycles([PAIR], speed, 150.0, 0, ports=[PORTS]).states[0]
    found = run_cycles(
        [PAIR], speed, 150.0, CYCLES, states=start[np.newaxis], ports=[PORTS],
        vectors=np.eye(VARIED)[np.newaxis], orthogonal=False, **accuracy,
    )  # fmt: skip
    columns = [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]
    scales = np.repeat([1.0, wn], 5)
    states = np.repeat(start[np.newaxis], 2 * VARIED, axis=0)
    for i, (column, scale) in enumerate(zip(columns, scales, strict=True)):
        states[2 * i, column] += STEP * scale
        states[2 * i + 1, column] -= STEP * scale
    n = len(states)
    ends = (
        run_cycles(
            [PAIR] * n, speed, 150.0, CYCLES, states=states, ports=[PORTS] * n, **accuracy
        ).states[:, columns]
        / scales
    )
    expected = (ends[::2] - ends[1::2]) / (2 * STEP)
    got = found.vectors[0]
    assert np.abs(got - expected).max() < 1e-4 * np.abs(expected).max()
    # The product of the growths is that of the volume.
    assert np.linalg.slogdet(got)[1] == pytest.approx(found.divergence.sum(), abs=1e-8)
