import dataclasses
from fractions import Fraction

import pytest

from gear_dynamics.machine.channel import Channel
from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import Bearing, Mesh, Wheel, bearing_orders
from gear_dynamics.machine.rig import rig_machine
from gear_dynamics.machine.shaft import DrivenBy, FixedSpeed, Shaft, TrackedSpeed
from gear_dynamics.machine.source import Source

ORDERS = {'outer': 3.585, 'inner': 5.415, 'element': 4.714, 'cage': 0.398}

GEARBOX = Machine(
    name='two stages',
    channels=(Channel('housing', Source('y'), 'm/s2'),),
    shafts=(
        Shaft('input', FixedSpeed(100.0)),
        Shaft('middle', DrivenBy('first')),
        Shaft('output', DrivenBy('second')),
    ),
    wheels=(
        Wheel('a', 'input', 20),
        Wheel('b', 'middle', 60),
        Wheel('c', 'middle', 25),
        Wheel('d', 'output', 70),
    ),
    meshes=(Mesh('first', 'a', 'b'), Mesh('second', 'c', 'd')),
    bearings=(Bearing('A', 'middle', ORDERS, ('housing',)),),
)


def changed(**parts):
    return dataclasses.replace(GEARBOX, **parts)


def test_speeds_follow_the_meshes_to_the_shaft_that_knows_its_own():
    assert GEARBOX.root('output') == (GEARBOX.shaft('input'), Fraction(20 * 25, 60 * 70))
    assert GEARBOX.root('input') == (GEARBOX.shaft('input'), 1)


def test_a_driving_shaft_can_follow_from_the_driven_one():
    shafts = (Shaft('input', DrivenBy('first')), Shaft('middle'), Shaft('output'))
    assert changed(shafts=shafts).root('input') == (shafts[1], Fraction(60, 20))


def test_a_wheel_knows_its_meshes():
    assert [(m.name, w.name) for m, w in GEARBOX.meshes_of('d')] == [('second', 'c')]


@pytest.mark.parametrize(
    ('parts', 'words'),
    [
        ({'wheels': (Wheel('a', 'inputs', 20), *GEARBOX.wheels[1:])}, "wheel a names 'inputs'"),
        ({'wheels': (Wheel('a', 'input', 0), *GEARBOX.wheels[1:])}, 'wheel a has 0 teeth'),
        ({'wheels': (*GEARBOX.wheels, Wheel('a', 'input', 9))}, "'a' stands twice"),
        ({'meshes': (Mesh('first', 'a', 'x'),)}, "mesh first names 'x'"),
        ({'meshes': (Mesh('first', 'b', 'c'),)}, 'both on shaft middle'),
        ({'meshes': (GEARBOX.meshes[0],)}, "driven_by of shaft output names 'second'"),
        (
            {'shafts': (Shaft('input', DrivenBy('first')), *GEARBOX.shafts[1:])},
            'in a circle: input, middle',
        ),
        ({'shafts': (Shaft('input', DrivenBy('second')), *GEARBOX.shafts[1:])}, 'no wheel on it'),
        ({'shafts': (Shaft('input', TrackedSpeed(1.0, 2.0, 'x')), *GEARBOX.shafts[1:])}, "'x'"),
        ({'channels': (Channel('2nd'),)}, 'is no name'),
        ({'bearings': (Bearing('A', 'middle', {'outer': 0.0}),)}, 'order outer'),
        (
            {'bearings': (Bearing('A', 'middle', ORDERS, ('x',)),)},
            "bearing A names 'x'",
        ),
    ],
)
def test_parts_that_do_not_fit_are_refused_in_one_line(parts, words):
    with pytest.raises(ValueError, match=words) as caught:
        changed(**parts)
    assert '\n' not in str(caught.value)


def test_bearing_orders_of_the_6205():
    # Case Western Reserve University Bearing Data Center: 6205-2RS JEM, multiples of the speed.
    orders = bearing_orders(9, 0.3126, 1.537)
    expected = {'outer': 3.5848, 'inner': 5.4152, 'element': 4.7135, 'cage': 0.39828}
    assert orders == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize('geometry', [(2, 1.0, 5.0), (8, 5.0, 5.0), (8, 0.0, 5.0), (8, 1, 5, 90)])
def test_impossible_bearings_are_refused(geometry):
    with pytest.raises(ValueError, match=r'element|contact_angle'):
        bearing_orders(*geometry)


@pytest.mark.parametrize(
    ('channel', 'scale', 'unit'),
    [
        (Channel('a'), 1.0, 'unknown'),
        (Channel('a', recorded_unit='g'), 9.80665, 'm/s2'),
        (Channel('a', recorded_unit='m/s²'), 1.0, 'm/s2'),
        (Channel('a', recorded_unit='mV', quantity='g', sensitivity=100.0), 0.0980665, 'm/s2'),
        (Channel('a', recorded_unit='m/s2', full_scale=100.0), 100.0, 'm/s2'),
        (Channel('a', recorded_unit='mm/s'), 1e-3, 'm/s'),
    ],
)
def test_values_become_si(channel, scale, unit):
    assert channel.scale == pytest.approx(scale)
    assert channel.unit == unit


def test_the_rig_has_every_vibrating_column():
    machine = rig_machine(34, 59, 1e-3, 1e-2, 1e-4, 3e4)
    assert tuple(each.name for each in machine.channels) == CHANNELS
    assert machine.channel('mesh_force').unit == 'N'
    assert machine.meshes_of('pinion')[0][1].teeth == 59
