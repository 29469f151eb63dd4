"""Write urdf/gear_pair.urdf, or the URDF of another gear pair to standard output.

Usage: python tools/urdf.py [PARAMETER_FILE]

The pinion turns about +z of `gear_pair`, the gear about -z: both joint angles of
`gear_pair/joint_states` grow while the wheels turn against each other.
"""

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.wire.topics import FRAME

ROOT = Path(__file__).resolve().parents[1]
FILE = ROOT / 'urdf' / 'gear_pair.urdf'

BASE = 'gear_pair'
ADDENDUM, DEDENDUM = 1.0, 1.25
"""Of the teeth, in modules."""
COLOURS = {'pinion': '0.00 0.45 0.70 1', 'gear': '0.90 0.62 0.00 1', 'mark': '0.80 0.15 0.15 1'}

Pose = tuple[float, float, float]
"""x [m], y [m] and the angle about z [rad]."""


def urdf(pair: GearPair) -> str:
    """Return the robot description of a gear pair."""
    robot = ElementTree.Element('robot', name='gear_pair')
    for name, colour in COLOURS.items():
        material = ElementTree.SubElement(robot, 'material', name=name)
        ElementTree.SubElement(material, 'color', rgba=colour)
    ElementTree.SubElement(robot, 'link', name=BASE)
    radius = {'pinion': _pitch_radius(pair, 'pinion'), 'gear': _pitch_radius(pair, 'gear')}
    centres = {'pinion': 0.0, 'gear': radius['pinion'] + radius['gear']}
    for wheel, direction in (('pinion', 1), ('gear', -1)):
        _wheel(robot, pair, wheel)
        joint = _joint(robot, f'{wheel}_joint', 'continuous', wheel, (centres[wheel], 0.0, 0.0))
        ElementTree.SubElement(joint, 'axis', xyz=f'0 0 {direction}')
    ElementTree.SubElement(robot, 'link', name=FRAME)
    pressure_angle = math.radians(pair.pressure_angle_deg)
    pitch_point = (radius['pinion'], 0.0, math.pi - pressure_angle)
    _joint(robot, f'{FRAME}_joint', 'fixed', FRAME, pitch_point)
    ElementTree.indent(robot)
    head = (
        '<?xml version="1.0"?>\n<!-- Written by tools/urdf.py. Lengths in m, angles in rad. -->\n'
    )
    return head + ElementTree.tostring(robot, encoding='unicode') + '\n'


def _wheel(robot: ElementTree.Element, pair: GearPair, wheel: str) -> None:
    """Add the link of a wheel: a disc to the roots, and a box for each tooth; tooth 0 is marked."""
    link = ElementTree.SubElement(robot, 'link', name=wheel)
    root = _pitch_radius(pair, wheel) - DEDENDUM * pair.module
    disc = _visual(link, (0.0, 0.0, 0.0), wheel)
    ElementTree.SubElement(disc, 'cylinder', radius=f'{root:.6f}', length=f'{pair.face_width:.6f}')
    height = (ADDENDUM + DEDENDUM) * pair.module
    thickness = (
        0.45 * math.pi * pair.module
    )  # a little less than half the pitch: a box has no flanks
    size = f'{height:.6f} {thickness:.6f} {pair.face_width:.6f}'
    for number, angle in enumerate(_tooth_angles(pair, wheel)):
        middle = root + height / 2
        place = (middle * math.cos(angle), middle * math.sin(angle), angle)
        box = _visual(link, place, wheel if number else 'mark')
        ElementTree.SubElement(box, 'box', size=size)


def _tooth_angles(pair: GearPair, wheel: str) -> Iterator[float]:
    """Iterate over the middles of the teeth at joint angle 0, in the order of engagement.

    There the drive flanks of both teeth 0 begin to touch, the length of approach before the pitch
    point.
    """
    approach = pair.derived.approach_length
    if wheel == 'pinion':
        teeth, turn, at = pair.pinion_teeth, -1, 0.0
    else:
        teeth, turn, at = pair.gear_teeth, 1, math.pi
    base = _pitch_radius(pair, wheel) * math.cos(math.radians(pair.pressure_angle_deg))
    # Half a tooth lies behind the pinion's drive flank, and half a tooth ahead of the gear's.
    flank = at + turn * approach / base
    first = flank - math.pi / (2 * teeth)
    return (first + turn * 2 * math.pi * number / teeth for number in range(teeth))


def _pitch_radius(pair: GearPair, wheel: str) -> float:
    return pair.module * (pair.pinion_teeth if wheel == 'pinion' else pair.gear_teeth) / 2


def _joint(
    robot: ElementTree.Element, name: str, kind: str, child: str, place: Pose
) -> ElementTree.Element:
    joint = ElementTree.SubElement(robot, 'joint', name=name, type=kind)
    ElementTree.SubElement(joint, 'parent', link=BASE)
    ElementTree.SubElement(joint, 'child', link=child)
    _origin(joint, place)
    return joint


def _visual(link: ElementTree.Element, place: Pose, colour: str) -> ElementTree.Element:
    visual = ElementTree.SubElement(link, 'visual')
    _origin(visual, place)
    geometry = ElementTree.SubElement(visual, 'geometry')
    ElementTree.SubElement(visual, 'material', name=colour)
    return geometry


def _origin(parent: ElementTree.Element, place: Pose) -> None:
    x, y, angle = place
    ElementTree.SubElement(parent, 'origin', xyz=f'{x:.6f} {y:.6f} 0', rpy=f'0 0 {angle:.6f}')


if __name__ == '__main__':
    if len(sys.argv) > 1:
        print(urdf(GearPair.from_yaml(sys.argv[1])), end='')
    else:
        FILE.write_text(urdf(GearPair()), encoding='utf-8')
