"""Random combinations of faults, severities and operating points: finite, or refused in one line.

GEAR_COMBINATIONS=3000 runs as many.
"""

import os

import numpy as np
import pytest

import gear_dynamics as gd

COUNT = int(os.environ.get('GEAR_COMBINATIONS', '200'))
METHODS = ['rectangular', 'constant', 'potential_energy', 'potential_energy_per_pair', 'iso_6336']
FRICTION = ['coulomb', 'benedict_kelley', 'xu_kahraman']


def drawn(rng, about):
    """Return a random allowed value of a fault's field."""
    if about.choices:
        return str(rng.choice(about.choices))
    if about.name == 'tooth':
        return int(rng.integers(-1, 34))
    if about.name == 'severity':
        return float(rng.choice([0.0, rng.uniform(), 1.0]))
    if isinstance(about.default, int):
        return int(rng.integers(about.minimum, min(about.maximum, 40), endpoint=True))
    low, high = max(about.minimum, 0.2 * about.default), min(about.maximum, 2 * about.default)
    return float(rng.uniform(low, max(high, low)))


def machine(rng):
    """Return a random gear pair with its faults and operating point."""
    pair = gd.GearPair(
        pinion_bore=0.03,
        gear_bore=0.05,
        mesh_stiffness=str(rng.choice(METHODS)),
        friction_model=str(rng.choice(FRICTION)),
        tip_relief_amount=float(rng.choice([0.0, 8e-6])),
        tip_relief_length=1.5e-3,
    )
    kinds = rng.choice(list(gd.faults.KINDS), rng.integers(1, 6), replace=False)
    faults = []
    for kind in kinds:
        each = gd.faults.KINDS[kind]
        chosen = rng.random(len(each.parameters())) < 0.7
        given = zip(each.parameters(), chosen, strict=True)
        faults.append(each(**{about.name: drawn(rng, about) for about, use in given if use}))
    return pair, faults, float(rng.uniform(0, 1500)), float(rng.uniform(-400, 600))


@pytest.mark.filterwarnings('ignore:friction_model')
@pytest.mark.parametrize('part', range(4))
def test_any_combination_runs_finite_or_is_refused_in_one_line(part):
    refused = []
    for seed in range(part, COUNT, 4):
        pair, faults, speed, torque = machine(np.random.default_rng(seed))
        try:
            run = gd.simulate(
                pair,
                0.02,
                speed=speed,
                load_torque=torque,
                faults=faults,
                anti_alias=False,
            )
        except gd.ParameterError as error:
            refused.append((str(error), faults))
            continue
        values = run.samples.view(np.float64)
        assert np.isfinite(values).all(), (seed, faults)
    assert len(refused) < COUNT / 8
    for message, faults in refused:
        assert '\n' not in message
        assert any(each.kind() in message for each in faults), message
