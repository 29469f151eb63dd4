"""Files for other viewers: the robot description, Foxglove's layout, the diagnostics' groups."""

import json
import math
import re
import runpy
from xml.etree import ElementTree

import pytest
import yaml
from ros_support import ROOT

import gear_dynamics as gd
from gear_dynamics.wire.messages import message_class
from gear_dynamics.wire.topics import FRAME, INDICATOR, TOPICS

URDF = ROOT / 'urdf' / 'gear_pair.urdf'
LAYOUT = json.loads((ROOT / 'config' / 'foxglove_layout.json').read_text(encoding='utf-8'))
MODULE, PINION_TEETH, GEAR_TEETH = 0.002, 34, 59
JOINTS = ('pinion_joint', 'gear_joint')


@pytest.fixture(scope='module')
def robot():
    return ElementTree.parse(URDF).getroot()


def joint(robot, name):
    return robot.find(f"joint[@name='{name}']")


def numbers(text):
    return [float(word) for word in text.split()]


def test_description_is_that_of_the_default_pair():
    written = runpy.run_path(str(ROOT / 'tools' / 'urdf.py'))['urdf'](gd.GearPair())
    assert URDF.read_text(encoding='utf-8') == written, 'run python tools/urdf.py'


def test_wheels_turn_against_each_other_by_the_joints_of_the_sim(robot):
    axes = [numbers(joint(robot, name).find('axis').get('xyz')) for name in JOINTS]
    assert axes == [[0, 0, 1], [0, 0, -1]]
    assert [joint(robot, name).get('type') for name in JOINTS] == ['continuous', 'continuous']


def test_every_link_but_the_base_hangs_on_one_joint(robot):
    links = {link.get('name') for link in robot.findall('link')}
    children = [each.find('child').get('link') for each in robot.findall('joint')]
    assert sorted(children) == sorted(links - {'gear_pair'})


def test_centres_are_half_the_sum_of_the_pitch_diameters_apart(robot):
    place = numbers(joint(robot, 'gear_joint').find('origin').get('xyz'))
    assert place == [pytest.approx(MODULE * (PINION_TEETH + GEAR_TEETH) / 2, abs=1e-6), 0, 0]


def test_line_of_action_passes_the_pitch_point_and_touches_both_base_circles(robot):
    origin = joint(robot, f'{FRAME}_joint').find('origin')
    x, y, _ = numbers(origin.get('xyz'))
    yaw = numbers(origin.get('rpy'))[2]
    along = (-math.sin(yaw), math.cos(yaw))  # the y axis of the frame
    centre = MODULE * (PINION_TEETH + GEAR_TEETH) / 2
    for middle, teeth in ((0.0, PINION_TEETH), (centre, GEAR_TEETH)):
        distance = abs((x - middle) * along[1] - y * along[0])
        assert distance == pytest.approx(MODULE * teeth / 2 * math.cos(math.radians(20)), abs=1e-6)
    # The mesh force holds the pinion back: +y on it turns it against its rotation about +z.
    assert x * along[1] - y * along[0] < 0


def tooth_angles(robot, wheel):
    visuals = robot.findall(f"link[@name='{wheel}']/visual")
    boxes = [visual for visual in visuals if visual.find('geometry/box') is not None]
    return [numbers(visual.find('origin').get('rpy'))[2] for visual in boxes]


@pytest.mark.parametrize('turned', [0.0, 0.31, 4.0])
def test_teeth_of_one_wheel_stand_in_the_gaps_of_the_other(robot, turned):
    pinion, gear = (tooth_angles(robot, wheel) for wheel in ('pinion', 'gear'))
    assert (len(pinion), len(gear)) == (PINION_TEETH, GEAR_TEETH)
    # Arcs on the pitch circles from the pitch point on, in the direction of motion.
    first = MODULE * PINION_TEETH / 2 * (pinion[0] + turned)
    second = MODULE * GEAR_TEETH / 2 * (math.pi - gear[0]) + MODULE * PINION_TEETH / 2 * turned
    pitch = math.pi * MODULE
    assert (second - first) % pitch == pytest.approx(pitch / 2, abs=1e-6)


def panels(layout):
    if isinstance(layout, str):
        return [layout]
    return panels(layout['first']) + panels(layout['second'])


def test_foxglove_layout_shows_each_of_its_panels_once():
    assert sorted(panels(LAYOUT['layout'])) == sorted(LAYOUT['configById'])


def strings(value):
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list)):
        for each in value.items() if isinstance(value, dict) else value:
            yield from strings(list(each) if isinstance(each, tuple) else each)


def test_foxglove_layout_names_topics_and_fields_that_the_bridge_serves():
    types = {f'/{each.name.lstrip("/")}': each.type_name for each in TOPICS if each != INDICATOR}
    named = [text for text in strings(LAYOUT) if re.match(r'/\w', text)]
    assert len(named) > 8
    for path in named:
        topic, _, fields = path.partition('.')
        assert topic in types, path
        kind = message_class(types[topic])
        for field in filter(None, fields.split('.')):
            annotation = kind.__dataclass_fields__[field.partition('[')[0]].type
            nested = re.fullmatch(r'(\w+?)__msg__(\w+)', str(annotation).rpartition('.')[2])
            kind = message_class(f'{nested[1]}/msg/{nested[2]}') if nested else None


def test_every_status_of_diagnostics_falls_into_one_group():
    read = yaml.safe_load((ROOT / 'config' / 'diagnostic_aggregator.yaml').read_text())
    groups = [each for each in read['analyzers']['ros__parameters'].values() if each != 'Gear rig']
    documented = (ROOT / 'docs' / 'interfaces.md').read_text(encoding='utf-8')
    names = re.findall(r'^\| `(gear_\w+: \w+)` \|', documented, re.MULTILINE)
    assert len(names) == 7
    for name in names:
        for status in (name, f'rig2/{name}'):
            matching = [each for each in groups if any(word in status for word in each['contains'])]
            assert len(matching) == 1, name
