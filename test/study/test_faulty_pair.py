"""Faults in what takes a gear pair: maps, exponents, studies."""

import dataclasses
import pickle

import numpy as np
import pytest

import gear_dynamics as gd
from gear_dynamics import dynamics
from gear_dynamics.study.command import main

CRACK = gd.faults.RootCrack('pinion', tooth=2, severity=0.6)


def test_faulty_pair_runs_as_the_pair_with_faults():
    pair = gd.faults.faulty(gd.GearPair(), [CRACK])
    one = gd.simulate(pair, 0.05, anti_alias=False)
    other = gd.simulate(gd.GearPair(), 0.05, faults=[CRACK], anti_alias=False)
    assert one.samples.tobytes() == other.samples.tobytes()


def test_replaced_and_pickled_pairs_keep_their_faults():
    pair = gd.faults.faulty(gd.GearPair(), [CRACK])
    other = dataclasses.replace(pair, friction_coefficient=0.1)
    assert other.faults == (CRACK,)
    assert pickle.loads(pickle.dumps(other)) == other != pair
    assert 'faults' not in pair.to_mapping()


def test_fault_that_does_not_fit_is_refused():
    with pytest.raises(gd.ParameterError, match='root_crack tooth is 33'):
        gd.faults.faulty(gd.GearPair(pinion_teeth=30), [gd.faults.RootCrack('pinion', tooth=33)])


def test_map_of_a_faulty_pair_differs_where_its_tooth_is_in_contact():
    pair = gd.GearPair(friction_coefficient=0.0)
    runs = [
        dynamics.run_cycles([each], 104.72, 150.0, 6).sections[0, :, 0]
        for each in (pair, gd.faults.faulty(pair, [CRACK]))
    ]
    same = runs[0] == runs[1]
    assert same[:2].all()
    assert not same[2:4].any()


PINION, GEAR = 34, 59
"""Mesh cycles in a revolution of the default pair's wheels."""


@pytest.mark.parametrize(
    ('given', 'cycles'),
    [
        ([gd.faults.Wear('gear', severity=0.2)], 1),
        ([gd.faults.SupportWear('gear', severity=0.2)], 1),
        ([gd.faults.RootCrack('pinion', tooth=5, severity=0.3)], PINION),
        ([gd.faults.Eccentricity('gear', severity=0.2)], GEAR),
        ([gd.faults.LoadFluctuation(severity=0.2, order=2.0)], GEAR),
        (
            [
                gd.faults.Unbalance('pinion', severity=0),
                gd.faults.Spall('gear', tooth=1, severity=0.1),
            ],
            GEAR,
        ),
        (
            [gd.faults.Unbalance('pinion', severity=0.1), gd.faults.Spall('gear', severity=0.1)],
            PINION * GEAR,
        ),
    ],
    ids=lambda given: str(given) if isinstance(given, int) else '',
)
def test_map_of_a_faulty_pair_goes_over_the_cycles_in_which_its_faults_repeat(given, cycles):
    assert dynamics.GearMap(gd.faults.faulty(gd.GearPair(), given), 104.72, 150.0).cycles == cycles


def test_map_refuses_a_fault_that_does_not_repeat():
    fault = gd.faults.LoadFluctuation(severity=0.2, shape='random')
    with pytest.raises(gd.ParameterError, match=r'load_fluctuation severity is 0.2: it must be 0'):
        dynamics.GearMap(gd.faults.faulty(gd.GearPair(), [fault]), 104.72, 150.0)


def test_periodic_orbit_of_a_cracked_pair_is_where_a_long_run_ends_up():
    """The orbit against a run in one go, its multipliers against finite differences."""
    crack = gd.faults.RootCrack('pinion', tooth=5, severity=0.5)
    healthy = gd.GearPair(mesh_damping_ratio=0.1, support_damping_ratio=0.1)
    pair = gd.faults.faulty(healthy, [crack])
    system = dynamics.GearMap(pair, 300.0, 150.0)
    start = system.scaled(dynamics.static_state(pair, 300.0, 150.0))
    orbit = dynamics.periodic_orbit(system, 1, start)

    run = dynamics.run_cycles([pair], 300.0, 150.0, 20 * PINION, section_phase=0.0)
    section = system.section(orbit.points)[0]
    b, wn = pair.half_backlash, pair.derived.wn
    ended = run.sections[0, -PINION, :2] / [b, b * wn]
    np.testing.assert_allclose(section, ended, rtol=0, atol=1e-8)

    point, jacobian = orbit.points[0], system.tangent(orbit.points)[1][0]
    unit = np.eye(system.dimension)
    ends = system.iterate(np.concatenate([point + 1e-5 * unit, point - 1e-5 * unit]))
    differences = (ends[: system.dimension] - ends[system.dimension :]).T / 2e-5
    np.testing.assert_allclose(jacobian, differences, rtol=0, atol=1e-8)
    assert 0 < abs(orbit.multipliers).max() < 1


def test_study_takes_faults_from_a_file_and_names_them(tmp_path, capsys):
    file = tmp_path / 'faults.yaml'
    file.write_text('- {fault: wear, wheel: gear, severity: 0.2}\n')
    options = ['--count', '3', '--output', str(tmp_path / 'out'), '--quiet']
    assert main(['response', *options, '--faults', str(file)]) == 0
    assert "with Wear(wheel='gear', severity=0.2" in (tmp_path / 'out' / 'response.txt').read_text()
    assert main(['response', *options, '--faults', '/nowhere.yaml']) == 2
    assert 'nowhere.yaml: cannot be read' in capsys.readouterr().err
    assert np.load(tmp_path / 'out' / 'response.npz')
