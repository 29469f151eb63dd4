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


@pytest.mark.parametrize('kind', gd.faults.KINDS)
def test_map_over_one_mesh_cycle_has_only_faults_that_repeat_in_it(kind):
    pair = gd.faults.faulty(gd.GearPair(), [gd.faults.KINDS[kind](severity=0.2)])
    if kind in ('wear', 'misalignment', 'lubrication_loss', 'support_wear'):
        assert dynamics.GearMap(pair, 104.72, 150.0).pair is pair
        return
    with pytest.raises(gd.ParameterError, match=f'{kind} severity is 0.2: .* must be 0'):
        dynamics.GearMap(pair, 104.72, 150.0)


def test_study_takes_faults_from_a_file_and_names_them(tmp_path, capsys):
    file = tmp_path / 'faults.yaml'
    file.write_text('- {fault: wear, wheel: gear, severity: 0.2}\n')
    options = ['--count', '3', '--output', str(tmp_path / 'out'), '--quiet']
    assert main(['response', *options, '--faults', str(file)]) == 0
    assert "with Wear(wheel='gear', severity=0.2" in (tmp_path / 'out' / 'response.txt').read_text()
    assert main(['response', *options, '--faults', '/nowhere.yaml']) == 2
    assert 'nowhere.yaml: cannot be read' in capsys.readouterr().err
    assert np.load(tmp_path / 'out' / 'response.npz')
