"""Faults as data: their magnitudes, and what they put into the ports."""

import dataclasses
import math

import numpy as np
import pytest

from gear_dynamics.model import faults
from gear_dynamics.model.faults.collection import checked_faults, fault_of, machine_ports
from gear_dynamics.model.faults.label import labels
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.model.mesh.stiffness import stiffness
from gear_dynamics.parameters.parameter import ParameterError

QUIET = GearPair(
    pinion_bore=0.03,
    gear_bore=0.05,
    mesh_stiffness='potential_energy',
    transmission_error_amplitude=5e-6,
)
CRACKED = GearPair(
    pinion_teeth=25,
    gear_teeth=30,
    face_width=0.02,
    pinion_bore=0.02,
    gear_bore=0.025,
    mesh_stiffness='potential_energy',
)


def value(term, name, s):
    """Return a quantity of a tooth deviation at s."""
    piece = int(np.clip(np.searchsorted(term.edges, s) - 1, 0, len(term.edges) - 2))
    x = (s - term.edges[piece]) / (term.edges[piece + 1] - term.edges[piece])
    return float(np.polynomial.polynomial.polyval(x, getattr(term, name)[piece]))


def loss_at_pitch_point(pair, depth):
    crack = faults.RootCrack('pinion', tooth=3, severity=1.0, deepest=depth, angle_deg=70.0)
    (term,) = crack.ports(pair)
    return -value(term, 'stiffness', pair.derived.approach_length)


@pytest.mark.parametrize('kind', faults.KINDS)
def test_severity_0_is_the_healthy_machine(kind):
    assert len(faults.KINDS[kind](severity=0.0).ports(QUIET)) == 0
    assert len(faults.KINDS[kind](severity=0.3).ports(QUIET)) > 0


@pytest.mark.parametrize('kind', faults.KINDS)
def test_severity_out_of_range_is_refused_with_fault_value_and_range(kind):
    with pytest.raises(ParameterError, match=f'{kind} severity is 1.5: .* from 0 to 1'):
        faults.KINDS[kind](severity=1.5)


def test_names_are_the_fourteen_promised():
    assert {each.__name__ for each in faults.KINDS.values()} == {
        'RootCrack',
        'ChippedTooth',
        'MissingTooth',
        'Spall',
        'Wear',
        'PitchErrors',
        'Eccentricity',
        'Misalignment',
        'Unbalance',
        'BentShaft',
        'LoadFluctuation',
        'LubricationLoss',
        'SupportWear',
        'BearingDefect',
    }


@pytest.mark.parametrize(
    ('depth', 'loss'), [(0.5e-3, 0.001), (1e-3, 0.01), (1.5e-3, 0.045), (2e-3, 0.10)]
)
def test_crack_takes_the_usual_share_of_the_single_stiffness(depth, loss):
    # Order of size from the usual formulas, within a factor of three.
    found = loss_at_pitch_point(CRACKED, depth)
    assert loss / 3 < found < loss * 3


def test_loss_by_a_crack_grows_with_depth():
    losses = [loss_at_pitch_point(CRACKED, depth) for depth in np.linspace(1e-6, 2.6e-3, 30)]
    assert (np.diff(losses) >= 0).all()
    assert losses[0] < 1e-6


@pytest.mark.parametrize('method', ['rectangular', 'potential_energy', 'potential_energy_per_pair'])
def test_polynomials_of_a_crack_follow_the_added_compliance(method):
    pair = dataclasses.replace(QUIET, mesh_stiffness=method)
    (term,) = faults.RootCrack('gear', tooth=3, severity=0.9).ports(pair)
    path, law = PathOfContact.of(pair), stiffness(pair)
    s = np.linspace(1e-6, pair.derived.path_length - 1e-6, 301)
    material = pair.face_width, pair.youngs_modulus, pair.poissons_ratio
    half = float(path.gear.fillet(np.array([math.pi / 2]))[0][0])
    left = half - 1.8e-3 * math.sin(math.radians(70))
    roll = path.gear_roll(s)
    added = path.gear.compliance(roll, *material, left) - path.gear.compliance(roll, *material)
    assert [value(term, 'stiffness', each) for each in s] == pytest.approx(
        (law.at(s, added) - law.at(s)) / law.single, abs=3e-5
    )


def test_crack_through_part_of_the_face_is_softer_by_less():
    whole = faults.RootCrack(severity=1.0).ports(QUIET).terms[0].stiffness.min()
    part = faults.RootCrack(severity=1.0, face_share=0.5).ports(QUIET).terms[0].stiffness.min()
    assert whole < part < 0


def test_eccentric_wheel_shifts_either_flank_by_its_offset():
    # e(Theta) + b(Theta) is where the drive flank touches, e - b where the back flank does.
    offset = faults.Eccentricity('pinion', severity=0.5, largest=100e-6).offset
    error, backlash = faults.Eccentricity('pinion', severity=0.5, largest=100e-6).ports(QUIET)
    angle = np.linspace(0, 2 * np.pi, 721)
    e = error.amplitude * np.sin(angle + error.phase)
    b = backlash.amplitude * np.sin(angle + backlash.phase)
    assert abs(e + b).max() == pytest.approx(offset, rel=1e-4)
    assert abs(e - b).max() == pytest.approx(offset, rel=1e-4)


def test_worn_drive_flank_recedes_by_the_depth():
    wear = faults.Wear('pinion', severity=1.0, deepest=40e-6)
    deviation, wider = wear.ports(QUIET)
    d = QUIET.derived
    found = [value(deviation, 'error', s) + wider.value for s in (0.0, d.approach_length)]
    assert found == pytest.approx([40e-6, 0.0], abs=1e-12)


def test_pitch_errors_stay_in_the_grade_and_close():
    # ISO 1328-1:1995: 0.3 (2 + 0.4 sqrt(68)) + 4 = 5.59 um of grade 5, times 2 of grade 7.
    fault = faults.PitchErrors('pinion', severity=1.0, grade=7, seed=4)
    limit = fault.deviation(0.002, 0.068)
    assert limit == pytest.approx(2 * 5.59e-6, rel=1e-3)
    errors = fault.errors(QUIET)
    assert errors.sum() == pytest.approx(0, abs=1e-18)
    assert abs(np.diff(errors, append=errors[0])).max() < 2 * limit
    assert (
        errors == faults.PitchErrors('pinion', severity=1.0, grade=7, seed=4).errors(QUIET)
    ).all()


@pytest.mark.parametrize('gap', [5e-6, 20e-6, 200e-6])
def test_misaligned_face_carries_the_mean_load_with_the_right_stiffness(gap):
    pair = GearPair()
    fault = faults.Misalignment(severity=1.0, widest=gap)
    terms = fault.ports(pair).terms
    left = math.prod(1 - term.loss for term in terms)
    intercept = sum(term.error[0, 0] for term in terms)
    d = pair.derived
    force = 150.0 / d.gear_base_radius / d.contact_ratio
    k = d.single_stiffness * left
    approach = force / k + intercept
    # Slices of the face, each of which touches where the gap is closed.
    slices = (np.arange(20000) + 0.5) / 20000 * gap
    closed = np.maximum(approach - slices, 0.0)
    assert d.single_stiffness * closed.mean() == pytest.approx(force, rel=1e-4)
    assert d.single_stiffness * (closed > 0).mean() == pytest.approx(k, rel=1e-3)


@pytest.mark.parametrize(
    ('place', 'order'), [('outer', 3.5848), ('inner', 5.4152), ('element', 4.7135)]
)
def test_orders_of_a_bearing_are_those_of_its_maker(place, order):
    # SKF 6205: 9 balls of 7.94 mm on a circle of 39.04 mm.
    bearing = faults.BearingDefect('pinion', place=place, slip=0.0)
    assert bearing.defect_order == pytest.approx(order, rel=2e-4)
    angle, load = bearing.passages()
    assert len(angle) / 64 == pytest.approx(order, rel=3e-3)
    assert load.min() == (1.0 if place == 'outer' else 0.0)


def test_bearing_passages_are_apart_and_dip_by_the_depth():
    bearing = faults.BearingDefect('gear', severity=0.5, place='outer', slip=0.1, deepest=4e-6)
    (table,) = bearing.ports(QUIET)
    middle = table.coefficients[::2] @ 0.5 ** np.arange(7)
    assert middle == pytest.approx(-2e-6)
    assert not table.coefficients[1::2].any()


@pytest.mark.parametrize(
    ('fault', 'message'),
    [
        (faults.RootCrack('pinion', tooth=34), 'root_crack tooth is 34: it must be from 0 to 33'),
        (faults.RootCrack(severity=1.0, deepest=4e-3), 'root_crack depth is 0.004: .* at most'),
        (faults.ChippedTooth(severity=1.0, widest=0.05), 'chipped_tooth width is 0.05: .*0.0384'),
        (faults.ChippedTooth(height=5e-3), 'chipped_tooth height is 0.005'),
        (faults.Spall(place=0.01), 'spall place is 0.01: it must be from'),
        (faults.Eccentricity(severity=1.0, largest=1e-3), 'eccentricity offset is 0.001'),
        (faults.BearingDefect(element_diameter=0.03), 'bearing_defect element_diameter is 0.03'),
    ],
)
def test_fault_that_does_not_fit_is_refused_in_one_line(fault, message):
    with pytest.raises(ParameterError, match=message) as caught:
        fault.ports(QUIET)
    assert '\n' not in str(caught.value)


def test_faults_that_leave_no_backlash_together_are_refused():
    both = [faults.Eccentricity(wheel, severity=1.0, largest=3e-4) for wheel in ('pinion', 'gear')]
    with pytest.raises(
        ParameterError, match=r'eccentricity severity is 1 \(gear\): together .* than 0.00015'
    ):
        machine_ports(QUIET, both)


@pytest.mark.parametrize(
    ('given', 'message'),
    [
        (
            [faults.MissingTooth(tooth=None, severity=1.0)],
            r'missing_tooth severity is 1 \(pinion\): these leave 0 of the stiffness .* 0.02',
        ),
        (
            [
                faults.RootCrack(wheel, severity=1.0, deepest=2.7e-3)
                for wheel in 4 * ('pinion', 'gear')
            ],
            r'root_crack severity is 1 \(pinion tooth 0\), .* and 4 more: where these teeth meet',
        ),
    ],
)
def test_faults_that_leave_no_tooth_pair_are_refused(given, message):
    with pytest.raises(ParameterError, match=message):
        machine_ports(GearPair(), given)


@pytest.mark.parametrize('severity', [0.6, 1.0])
def test_losses_of_faults_that_meet_are_products(severity):
    tooth = [faults.MissingTooth(wheel, severity=severity) for wheel in ('pinion', 'gear')]
    losses = [term.loss for term in machine_ports(GearPair(), tooth)]
    assert losses == [severity, severity]
    worn = [faults.SupportWear('gear', severity=severity, most=0.8) for _ in range(2)]
    left = 5e8 + sum(term.value for term in machine_ports(GearPair(), worn))
    assert left == pytest.approx(5e8 * (1 - 0.8 * severity) ** 2)


def test_labels_name_fault_place_and_orders():
    crack, unbalance = faults.RootCrack('gear', tooth=7, severity=0.4), faults.Unbalance(severity=0)
    (label,) = labels([crack, unbalance], QUIET)
    assert label.values() == {
        'fault': 'root_crack',
        'wheel': 'gear',
        'tooth': '7',
        'severity': '0.4',
        'orders': '0.576271',
    }


def test_a_mapping_makes_a_fault():
    given = {'fault': 'root_crack', 'wheel': 'gear', 'tooth': 7, 'severity': '4e-1'}
    assert fault_of(given) == faults.RootCrack('gear', tooth=7, severity=0.4)
    assert fault_of({'fault': 'wear', 'severity': 1}) == faults.Wear(severity=1.0)


@pytest.mark.parametrize(
    ('given', 'message'),
    [
        ({'fault': 'root_crak'}, 'the nearest name is root_crack'),
        ({'fault': 'wear', 'tooth': 3}, 'tooth is not a parameter'),
        ({'severity': 0.1}, 'fault is None'),
        ({'fault': 'wear', 'severity': 'x'}, "wear severity is 'x'"),
    ],
)
def test_a_wrong_mapping_is_refused(given, message):
    with pytest.raises(ParameterError, match=message):
        fault_of(given)


def test_no_tooth_stands_for_all():
    assert faults.RootCrack('gear', tooth=None).tooth is None
    assert faults.RootCrack('gear', tooth=-1) == faults.RootCrack('gear', tooth=None)


@pytest.mark.parametrize('given', ['root_crack', 3, [3], [None]])
def test_what_is_no_fault_is_refused(given):
    with pytest.raises(ParameterError, match='faults'):
        checked_faults(given)
