"""The variants of the model against SciPy's DOP853 on equations written anew."""

import dataclasses

import numpy as np
import pytest
from comparison import ACCURACY, RATE, columns, relative_errors, simulator
from reference_equations import COLUMNS, Ramp
from reference_run import Reference

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import HEALTHY, Ports, ToothDeviation

DEFAULT = GearPair()
RPM = np.pi / 30
COUNT = 200


def flank(wheel=None, tooth=None, begin=0.0, end=DEFAULT.derived.path_length, **cubics):
    """Return ports that deviate on a stretch of the path, by cubics in s [m], lowest first."""
    rows = {
        name: [np.polynomial.Polynomial(cubic)(np.polynomial.Polynomial([begin, end - begin])).coef]
        for name, cubic in cubics.items()
    }
    return Ports([ToothDeviation(wheel, tooth, [begin, end], **rows)])


def assert_equal_to_reference(pair, speed, torque, *, ports=HEALTHY, drive=True, leave=()):
    model = simulator(pair, speed, torque, 1e-12, ports=ports, drive=drive)
    got = columns(model.advance(COUNT))
    reference = Reference(pair, speed, torque, ports, drive)
    rows, away = reference.run(np.arange(COUNT) / RATE)
    assert np.count_nonzero(away) > 0.9 * COUNT
    errors = dict(zip(COLUMNS, relative_errors(got[away], rows[away]), strict=True))
    assert {n: e for n, e in errors.items() if not e < ACCURACY and n not in leave} == {}
    return reference


def changed(**values):
    return dataclasses.replace(DEFAULT, **values)


@pytest.mark.parametrize(
    ('pair', 'rpm', 'torque'),
    [
        (changed(mesh_stiffness='constant'), 2000, 150.0),
        (changed(damping_in_gap=True), 3200, 150.0),
        (changed(friction_coefficient=0.0), 3200, 150.0),
        (changed(transmission_error_phase=1.0, friction_coefficient=0.2), 1000, 150.0),
        (changed(pinion_teeth=20, gear_teeth=75, module=0.003), 700, 400.0),
        (changed(pinion_teeth=59, gear_teeth=34), 1000, 150.0),
        (DEFAULT, 1000, -150.0),
        (changed(half_backlash=3e-6), 5000, 100.0),
        (changed(half_backlash=10e-6), 9500, 60.0),
    ],
    ids=[
        'constant', 'gap damping', 'mu 0', 'phase', '20/75', 'step-up', 'back flank',
        'b 3 um', 'b 10 um',
    ],
)  # fmt: skip
def test_variant_equals_reference(pair, rpm, torque):
    assert_equal_to_reference(pair, rpm * RPM, torque)


def test_loss_on_the_back_flank_is_seen():
    reference = assert_equal_to_reference(DEFAULT, 2000 * RPM, -100.0)
    assert {(before, after) for _, before, after, *_ in reference.events} >= {(-1, 0), (0, -1)}


def test_reduced_form_equals_reference():
    assert_equal_to_reference(
        DEFAULT, 3200 * RPM, 150.0, drive=False, leave=('pinion_angle', 'gear_angle', 'speed')
    )


CUBIC = [-0.3, 20.0, 3e3, -4e5]
"""A dip of stiffness, coefficients of 1, s, s2, s3 with s in metres."""


@pytest.mark.parametrize(
    'ports',
    [
        flank(begin=0.002, end=0.008, stiffness=CUBIC, damping=[-0.2]),
        # A hollow of 5 um that is level with the flank at both ends of the stretch.
        flank('pinion', 2, 0.003, 0.007, error=np.polynomial.Polynomial.fromroots(
            [0.003, 0.003, 0.007]).coef * 5e-6 / 2.4e-9),
        flank('gear', 1, 0.0, 0.0063, error=[4e-6, -1e-4, 2e-2, 0.5], friction=[0.05, 3.0]),
        flank('pinion', 1, 0.004, 0.006, error=[-3e-6]),
        flank('pinion', 1, 0.001, 0.006, stiffness=CUBIC) + flank(error=[0, 1e-4])
        + flank(end=0.004, stiffness=CUBIC),
    ],
    ids=['stiffness dip', 'hollow', 'gear tooth', 'step', 'overlap'],
)  # fmt: skip
def test_tooth_deviations_equal_reference(ports):
    assert_equal_to_reference(DEFAULT, 2500 * RPM, 150.0, ports=ports)


def test_flank_step_that_takes_a_pair_out_of_contact_equals_reference():
    # 60 um is more than the deflection: on this tooth the pair behind it carries alone.
    ports = flank('pinion', 3, 0.001, 0.0095, error=[60e-6])
    assert_equal_to_reference(DEFAULT, 1500 * RPM, 150.0, ports=ports)


def ramped(pair, *, ports=HEALTHY, speed=None, torque=None):
    """Run at 1500 rpm and 150 N m, ramp at sample 60 and again at 120, compare all columns."""
    first = simulator(
        pair, 1500 * RPM, 150.0, 1e-12, ports=ports,
        speed_rate_limit=20000.0, torque_rate_limit=80000.0,
    )  # fmt: skip
    got = [first.advance(60)]
    first.command(**({'speed': speed[0]} if speed else {}),
                  **({'load_torque': torque[0]} if torque else {}))  # fmt: skip
    got.append(first.advance(60))
    first.command(**({'speed': speed[1]} if speed else {}),
                  **({'load_torque': torque[1]} if torque else {}))  # fmt: skip
    got.append(first.advance(COUNT - 120))
    reference = Reference(
        pair,
        limited(1500 * RPM, speed, 20000.0) if speed else 1500 * RPM,
        limited(150.0, torque, 80000.0) if torque else 150.0,
        ports,
    )
    rows, away = reference.run(np.arange(COUNT) / RATE)
    errors = relative_errors(columns(np.concatenate(got))[away], rows[away])
    assert errors.max() < ACCURACY


def limited(value, targets, rate):
    """Return the command that is given targets at samples 60 and 120 and follows at a rate."""
    times, values = [0.0], [value]
    ends = (120 / RATE, COUNT / RATE)
    for begin, end, target in zip((60 / RATE, 120 / RATE), ends, targets, strict=True):
        if times[-1] < begin:
            times.append(begin)
            values.append(value)
        needed = abs(target - value) / rate
        sign = np.sign(target - value)
        reached = min(begin + needed, end)
        value += sign * rate * (reached - begin)
        times.append(reached)
        values.append(value)
    return Ramp(times, values)


def test_speed_ramps_equal_reference():
    # Up, not reached before the next command; then down to standstill, reached.
    ramped(DEFAULT, speed=(200.0, 150.0))


def test_ramp_to_standstill_equals_reference():
    ramped(changed(friction_coefficient=0.1), speed=(140.0, 139.0))


def test_torque_ramps_through_zero_equal_reference():
    ramped(DEFAULT, torque=(60.0, -80.0))


def test_speed_and_torque_ramps_with_tooth_deviations_equal_reference():
    ports = flank('gear', 1, 0.0, 0.0063, error=[4e-6, -1e-4, 2e-2, 0.5])
    ports += flank(begin=0.002, end=0.008, stiffness=CUBIC, damping=[-0.2])
    ramped(DEFAULT, speed=(200.0, 150.0), torque=(60.0, 120.0), ports=ports)
