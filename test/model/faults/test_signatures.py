"""What faults of teeth, shafts and bearings look like in the vibration, by order and by angle."""

import dataclasses

import numpy as np
import pytest
import scipy.signal
from model.faults.signatures import (
    GEAR_TEETH,
    MESH,
    PER_CYCLE,
    PINION_TEETH,
    QUIET,
    RATE,
    SHAFT,
    average,
    lines,
    period,
)

import gear_dynamics as gd

TOOTH = 5
TURNS = {'pinion': GEAR_TEETH, 'gear': PINION_TEETH}
"""Bin of each shaft's order: revolutions in a hunting-tooth period."""

TEETH = {'pinion': PINION_TEETH, 'gear': GEAR_TEETH}


@pytest.mark.parametrize(('wheel', 'other'), [('pinion', 'gear'), ('gear', 'pinion')])
def test_crack_gives_sidebands_of_its_own_shaft_and_shows_in_its_own_average(wheel, other):
    crack = gd.faults.RootCrack(wheel, tooth=TOOTH, severity=0.8)
    signal = period(QUIET, [crack])['pinion_ay']
    spectrum = abs(lines(signal))
    sides = np.array([k for k in range(-6, 7) if k])
    own = spectrum[MESH + sides * TURNS[wheel]]
    others = spectrum[MESH + sides * TURNS[other]]
    assert own.min() > 1e-3 * spectrum[MESH]
    assert others.max() < 1e-3 * own.min()

    shown, hidden = average(signal, TEETH[wheel]), average(signal, TEETH[other])
    assert abs(hidden).max() < 1e-2 * abs(shown).max()
    # The tooth is in contact from its own angle on, for less than two cycles.
    place = abs(shown).argmax() / PER_CYCLE
    assert TOOTH <= place <= TOOTH + 2


def test_eccentricity_gives_the_sidebands_of_its_inertia_force():
    # To first order the eccentric wheel adds me e Omega^2 sin to the mean mesh force, and the mesh
    # line follows the force: its sidebands are half the line's change with force, times that.
    pair = gd.GearPair(friction_coefficient=0.0)
    fault = gd.faults.Eccentricity('pinion', severity=1.0, largest=40e-6)
    found = abs(lines(period(pair, [fault])['pinion_ay']))
    low, high = (lines(period(pair, load_torque=t)['pinion_ay']) for t in (148.0, 152.0))
    per_force = (high - low) * pair.derived.gear_base_radius / 4.0
    force = pair.derived.equivalent_mass * fault.offset * (2 * np.pi * SHAFT) ** 2
    for mesh in (MESH, 2 * MESH):
        expected = abs(per_force[mesh]) * force / 2
        sides = found[[mesh - TURNS['pinion'], mesh + TURNS['pinion']]]
        assert sides.mean() == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize('wheel', ['pinion', 'gear'])
def test_unbalance_gives_the_closed_form_response(wheel):
    # Without friction nothing else acts across the line of action.
    pair = gd.GearPair(friction_coefficient=0.0)
    fault = gd.faults.Unbalance(wheel, severity=1.0, largest=2e-3)
    signal = period(pair, [fault], settle=20)[f'{wheel}_ax']
    w = 2 * np.pi * SHAFT * TURNS[wheel] / TURNS['pinion']
    d = pair.derived
    mass, damping = getattr(d, f'{wheel}_mass'), getattr(d, f'{wheel}_support_damping')
    stiff = getattr(pair, f'{wheel}_support_stiffness')
    expected = fault.unbalance * w**2 * w**2 / abs(stiff - mass * w**2 + 1j * w * damping)
    assert abs(lines(signal)[TURNS[wheel]]) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize('place', ['outer', 'inner', 'element'])
def test_bearing_defect_gives_an_envelope_line_at_its_order_within_slip(place):
    fault = gd.faults.BearingDefect('pinion', severity=1.0, place=place, slip=0.01)
    spectrum = np.fft.rfft(period(QUIET, [fault], rtol=1e-8)['pinion_ay'])
    # What is periodic with the gears is left out, as a separation of discrete lines would.
    spectrum[:: TURNS['pinion']] = 0
    spectrum[:: TURNS['gear']] = 0
    envelope = abs(scipy.signal.hilbert(np.fft.irfft(spectrum)))
    line = abs(np.fft.rfft(envelope - envelope.mean()))
    order = np.arange(line.size) / TURNS['pinion']
    near = (order > 1.5) & (order < 7)
    found = order[near][line[near].argmax()]
    assert found == pytest.approx(fault.defect_order, rel=0.01)
    assert fault.orders(QUIET)[0] == pytest.approx(found, rel=0.01)


def test_load_fluctuation_shows_in_the_mesh_force_at_its_order():
    pair = gd.GearPair(friction_coefficient=0.0)
    fault = gd.faults.LoadFluctuation(severity=1.0, largest=20.0, per='gear', order=2.0)
    force = lines(period(pair, [fault])['mesh_force'])[2 * TURNS['gear']]
    # Slow beside every mode: the drive holds the rigid rotation q as a mass on a spring,
    # q'' = -rho T / It H, and the pinion's share of that acceleration comes through the mesh.
    d = pair.derived
    rho = PINION_TEETH / GEAR_TEETH
    inertia = d.pinion_inertia + rho**2 * d.gear_inertia
    s = 1j * 2 * np.pi * SHAFT * 2.0 * rho
    w = 2 * np.pi * pair.drive_frequency
    control = 2 * pair.drive_damping_ratio * w / s + (w / s) ** 2 + (w / s) ** 3 / 5
    share = (d.pinion_inertia / inertia + control) / (1 + control)
    assert abs(force) == pytest.approx(abs(share) * 20.0 / d.gear_base_radius, rel=0.02)


def test_missing_tooth_is_found_at_its_angle():
    fault = gd.faults.MissingTooth('gear', tooth=40, severity=1.0)
    shown = average(period(QUIET, [fault], rtol=1e-8)['pinion_ay'], GEAR_TEETH)
    assert 40 <= abs(shown).argmax() / PER_CYCLE <= 43


def test_worn_teeth_give_no_sidebands_but_change_the_mesh_harmonics():
    worn = abs(lines(period(QUIET, [gd.faults.Wear('gear', severity=0.4)])['pinion_ay']))
    new = abs(lines(period(QUIET)['pinion_ay']))
    assert worn[MESH + np.array([-59, -34, 34, 59])].max() < 1e-6 * worn[MESH]
    assert abs(worn[MESH * np.arange(1, 6)] - new[MESH * np.arange(1, 6)]).max() > 0.05 * new[MESH]


def test_severity_0_is_healthy_to_the_last_bit():
    pair = dataclasses.replace(QUIET, friction_coefficient=0.05)
    healthy = [each(severity=0.0) for each in gd.faults.KINDS.values()]
    runs = [gd.simulate(pair, 0.05, faults=faults) for faults in ([], healthy)]
    assert runs[0].samples.tobytes() == runs[1].samples.tobytes()
    assert runs[1].labels == ()


def test_rate_is_a_whole_number_of_samples_a_cycle():
    assert RATE / (SHAFT * PINION_TEETH) == PER_CYCLE
