import dataclasses
import json
import re
import subprocess
import sys

import pytest
import yaml
from ros_support import ROOT

import gear_dynamics as gd
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.files import check_parameter_file, read_parameters
from gear_dynamics.parameters.settings import SimSettings

DEFAULT = ROOT / 'config' / 'default.yaml'


def write(tmp_path, text):
    path = tmp_path / 'rig.yaml'
    path.write_text(text)
    return path


def section(tmp_path, parameters, name='/**'):
    return write(tmp_path, f'{name}: {{ros__parameters: {{{parameters}}}}}')


def test_default_file_is_the_default_pair_and_rig():
    values = read_parameters(DEFAULT)
    assert gd.GearPair.from_yaml(DEFAULT) == gd.GearPair()
    assert SimSettings.from_mapping(values) == SimSettings()
    assert {*gd.GearPair().to_mapping(), *SimSettings().to_mapping()} == set(values)


@pytest.mark.parametrize('name', ['friction_chaos', 'friction_chaos_near', 'quiet'])
def test_rig_that_is_shipped_is_accepted(name):
    path = ROOT / 'config' / f'{name}.yaml'
    check_parameter_file(path)
    assert gd.GearPair.from_yaml(path) != gd.GearPair()


def test_default_file_gives_each_value_its_source():
    lines = DEFAULT.read_text().splitlines()
    values = [line for line in lines if re.match(r'    \w', line)]
    assert len(values) == len(read_parameters(DEFAULT))
    assert all('[source]' in line or '[chosen]' in line for line in values)


def unusual_pair():
    return dataclasses.replace(
        gd.GearPair(),
        pinion_teeth=41,
        pinion_inertia=1 / 3e4,
        tooth_pair_stiffness=1e12,
        mesh_stiffness='constant',
        damping_in_gap=True,
        half_backlash=1e-9,
        transmission_error_phase=-1.0,
    )


def test_what_was_written_is_read_back(tmp_path):
    path = tmp_path / 'pair.yaml'
    unusual_pair().to_yaml(path)
    assert gd.GearPair.from_yaml(path) == unusual_pair()
    assert gd.GearPair.from_yaml(path) == GearPair.from_mapping(unusual_pair().to_mapping())
    values = yaml.safe_load(path.read_text())['/**']['ros__parameters']
    assert values == unusual_pair().to_mapping()
    assert {name: type(value) for name, value in values.items()} == {
        about.name: type(about.default) for about in GearPair.parameters()
    }


SHOW = """
import json, sys, rclpy
rclpy.init(args=sys.argv)
node = rclpy.create_node(
    'gear_sim', namespace='/rig1/front', automatically_declare_parameters_from_overrides=True
)
given = node.get_parameters_by_prefix('')
print(json.dumps({name: each.value for name, each in given.items() if name != 'use_sim_time'}))
rclpy.shutdown()
"""


def as_rcl_reads(path):
    """Return what a node `/rig1/front/gear_sim` is given by ROS itself."""
    done = subprocess.run(
        [sys.executable, '-c', SHOW, '--ros-args', '--params-file', str(path)],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    values = json.loads(done.stdout.splitlines()[-1])
    values.pop('start_type_description_service', None)
    return values


def test_rcl_reads_what_was_written(tmp_path, domain):
    path = tmp_path / 'pair.yaml'
    unusual_pair().to_yaml(path)
    values = as_rcl_reads(path)
    assert values == unusual_pair().to_mapping()
    assert {name: type(value) for name, value in values.items()} == {
        about.name: type(about.default) for about in GearPair.parameters()
    }


SECTIONS = """
/**: {ros__parameters: {module: 0.001, density: 1000.0, face_width: 0.001}}
/rig1:
  front:
    gear_sim: {ros__parameters: {module: 0.002, pinion_teeth: 40}}
  '**': {gear_sim: {ros__parameters: {gear_teeth: 61}}}
  gear_sim: {ros__parameters: {gear_teeth: 62}}
/*/gear_sim: {ros__parameters: {gear_teeth: 63}}
/*/*/gear_sim: {ros__parameters: {face_width: 0.01}}
gear_sim: {ros__parameters: {gear_teeth: 64}}
/rig2/**: {ros__parameters: {gear_teeth: 65}}
/rig1/**: {ros__parameters: {density: 2000.0}}
/**/gear_analyzer: {ros__parameters: {gear_teeth: 66}}
"""


def test_sections_apply_to_a_node_as_rcl_applies_them(tmp_path, domain):
    path = write(tmp_path, SECTIONS)
    assert read_parameters(path, '/rig1/front/gear_sim') == as_rcl_reads(path)


def test_later_section_holds_and_namespaces_tell_rigs_apart(tmp_path):
    path = write(tmp_path, SECTIONS)
    assert gd.GearPair.from_yaml(path).gear_teeth == 64
    assert gd.GearPair.from_yaml(path, node='/rig2/gear_sim').gear_teeth == 65
    pair = gd.GearPair.from_yaml(path, node='/rig1/front/gear_sim')
    assert (pair.pinion_teeth, pair.gear_teeth, pair.module) == (40, 61, 0.002)
    assert (pair.face_width, pair.density) == (0.01, 2000.0)


def test_numbers_are_taken_in_every_form(tmp_path):
    path = section(
        tmp_path, 'tooth_pair_stiffness: 5e8, half_backlash: 15e-5, pressure_angle_deg: 20'
    )
    pair = gd.GearPair.from_yaml(path)
    assert (pair.tooth_pair_stiffness, pair.half_backlash) == (5e8, 150e-6)
    assert pair.pressure_angle_deg == 20.0
    assert isinstance(pair.pressure_angle_deg, float)


@pytest.mark.parametrize(
    ('text', 'what'),
    [
        ('', 'is not a ROS parameter file'),
        ('- 1', 'is not a ROS parameter file'),
        ('[1', "expected ',' or ']'"),
        ('a: &x [*x', 'the alias *x stands in itself'),
        ('a: 2001-99-99', 'is not a YAML text file'),
        ('[' * 5000, 'line 1: '),
        ('speed: 100', '/speed is 100: parameters must stand under ros__parameters'),
        ('/a: {/b: {ros__parameters: {speed: 1}}}', '/a//b is no name of a node'),
        ('/**: {ros__parameters: }', 'ros__parameters is None: it must be names with values'),
        ('/**: {ros__parameters: [1]}', 'ros__parameters is [1]: it must be names with values'),
        ('/**: {ros__parameters: {speed: }}', 'speed has no value'),
        ('/**: {ros__parameters: {sped: 1}}', 'the nearest name is speed'),
        ('gear_sim: {ros__parameters: {modul: 1}}', 'the nearest name is module'),
        ('/a/**: {ros__parameters: {module: {a: 2}}}', 'module.a is not a parameter'),
    ],
)
def test_malformed_file_is_refused_in_one_line_that_names_it(tmp_path, text, what):
    path = write(tmp_path, text)
    with pytest.raises(gd.ParameterError) as refusal:
        check_parameter_file(path)
    with pytest.raises(gd.ParameterError) as same:
        gd.GearPair.from_yaml(path)
    assert str(refusal.value) == str(same.value)
    assert str(refusal.value).startswith(f'{path}: ')
    assert what in str(refusal.value)
    assert '\n' not in str(refusal.value)


@pytest.mark.parametrize(
    ('parameters', 'what'),
    [
        ('pinion_teeth: 3', 'pinion_teeth is 3: it must be an integer from 4 to 1000'),
        ('pinion_teeth: 34.5', 'pinion_teeth is 34.5'),
        ('module: [1, 2]', 'module is [1, 2]'),
        ('module: .nan', 'module is nan'),
        ('mesh_stiffness: 1', "mesh_stiffness is 1: it must be 'rectangular' or 'constant'"),
        ('damping_in_gap: 1', 'damping_in_gap is 1: it must be true or false'),
        ('pinion_teeth: 5', 'interfere'),
    ],
)
def test_wrong_value_is_refused_with_file_and_name(tmp_path, parameters, what):
    path = section(tmp_path, parameters)
    with pytest.raises(gd.ParameterError) as refusal:
        gd.GearPair.from_yaml(path)
    assert str(refusal.value).startswith(f'{path}: ')
    assert what in str(refusal.value)


def test_file_that_cannot_be_read_is_refused(tmp_path):
    for path, what in [(tmp_path, 'Is a directory'), (tmp_path / 'none.yaml', 'No such file')]:
        with pytest.raises(gd.ParameterError, match=what):
            check_parameter_file(path)
    binary = tmp_path / 'binary.yaml'
    binary.write_bytes(bytes(range(256)))
    with pytest.raises(gd.ParameterError, match='is not a YAML text file'):
        check_parameter_file(binary)


def test_file_without_a_section_for_the_node_is_refused(tmp_path):
    path = section(tmp_path, 'speed: 100', name='/rig2/gear_sim')
    with pytest.raises(gd.ParameterError, match='no section is for /gear_sim'):
        gd.GearPair.from_yaml(path)


def test_sections_of_other_packages_and_ros_names_are_left_alone(tmp_path):
    path = write(
        tmp_path,
        '/camera: {ros__parameters: {gain: 2.0}}\n'
        '/**: {ros__parameters: {use_sim_time: true, start_type_description_service: false,'
        ' qos_overrides: {/samples: {publisher: {depth: 7}}}}}\n',
    )
    check_parameter_file(path)
    assert read_parameters(path) == {
        'use_sim_time': True,
        'start_type_description_service': False,
        'qos_overrides./samples.publisher.depth': 7,
    }
