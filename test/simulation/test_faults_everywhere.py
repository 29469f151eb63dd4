"""Faults in simulate, Simulator and simulate_batch."""

import numpy as np
import pytest

import gear_dynamics as gd

CRACK = gd.faults.RootCrack('pinion', tooth=5, severity=0.5)
SPALL = gd.faults.Spall('gear', tooth=3, severity=0.4)


def test_batch_is_what_simulate_gives_row_by_row():
    pairs = [gd.GearPair(), gd.GearPair(friction_coefficient=0.1)]
    given = [[CRACK], [SPALL, gd.faults.Misalignment(severity=0.3)]]
    rows = gd.simulate_batch(pairs, 200.0, 100.0, 0.05, faults=given, anti_alias=False)
    for row, pair, faults in zip(rows, pairs, given, strict=True):
        run = gd.simulate(
            pair, 0.05, speed=200.0, load_torque=100.0, faults=faults, anti_alias=False
        )
        assert row.tobytes() == run.samples.tobytes()


def test_batch_takes_one_list_for_all():
    rows = gd.simulate_batch([gd.GearPair()] * 2, duration=0.02, faults=[SPALL])
    assert rows[0].tobytes() == rows[1].tobytes()
    with pytest.raises(gd.ParameterError, match='faults has 1 lists: give one, or 2'):
        gd.simulate_batch([gd.GearPair()] * 2, duration=0.02, faults=[[SPALL]])


def test_run_holds_its_faults_and_labels():
    run = gd.simulate(gd.GearPair(), 0.01, faults=[CRACK])
    assert run.faults == (CRACK,)
    (label,) = run.labels
    assert (label.fault, label.wheel, label.tooth, label.orders) == (
        'root_crack',
        'pinion',
        5,
        (1.0,),
    )


def test_fault_that_fades_in_ends_up_as_if_it_had_always_been_there():
    # Without a fault of its own state, the motion forgets how it began.
    pair = gd.GearPair(mesh_damping_ratio=0.1, friction_coefficient=0.0)
    wear = gd.faults.Wear('gear', severity=0.2)
    switched, always = (gd.Simulator(pair, anti_alias=False, rtol=1e-10) for _ in range(2))
    always = gd.Simulator(pair, faults=[wear], anti_alias=False, rtol=1e-10)
    switched.advance(1000)
    always.advance(1000)
    switched.change(faults=[wear])
    a, b = switched.advance(60000)[-2000:], always.advance(60000)[-2000:]
    np.testing.assert_allclose(a['mesh_force'], b['mesh_force'], rtol=1e-6)
    assert switched.labels == always.labels != ()


def test_switching_a_fault_off_brings_the_healthy_machine_back():
    pair = gd.GearPair(friction_coefficient=0.0)
    machine, healthy = (gd.Simulator(pair, anti_alias=False, rtol=1e-10) for _ in range(2))
    machine.change(faults=[gd.faults.Eccentricity(severity=0.3)])
    machine.advance(20000)
    machine.change(faults=[])
    healthy.advance(20000)
    a, b = machine.advance(60000)[-2000:], healthy.advance(60000)[-2000:]
    np.testing.assert_allclose(a['mesh_force'], b['mesh_force'], rtol=1e-6)
    assert machine.labels == ()


def test_fault_that_does_not_fit_is_refused_and_the_machine_runs_on():
    simulator = gd.Simulator(gd.GearPair(), faults=[CRACK])
    with pytest.raises(gd.ParameterError, match='root_crack tooth is 40'):
        simulator.change(faults=[gd.faults.RootCrack('pinion', tooth=40)])
    assert simulator.faults == (CRACK,)
    assert np.isfinite(simulator.advance(100)['mesh_force']).all()


def test_reset_may_go_on_with_another_pair():
    simulator = gd.Simulator(gd.GearPair(), faults=[CRACK], anti_alias=False)
    simulator.advance(100)
    other = gd.GearPair(pinion_teeth=40, gear_teeth=60)
    simulator.reset(other)
    expected = gd.simulate(other, 0.01, faults=[CRACK], anti_alias=False)
    assert simulator.advance(512).tobytes() == expected.samples.tobytes()
    simulator.change(faults=[gd.faults.RootCrack('pinion', tooth=39)])
    with pytest.raises(gd.ParameterError, match='root_crack tooth is 39'):
        simulator.reset(gd.GearPair())
    assert simulator.pair == other
