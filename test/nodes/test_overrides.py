"""Of a parameter that is given more than once, the last value holds, whatever its type."""

import pytest

pytest.importorskip('rclpy')

import ros_support

from gear_dynamics.nodes.overrides import repeated_parameters


@pytest.fixture
def file(tmp_path):
    path = tmp_path / 'rig.yaml'
    path.write_text(
        '/**: {ros__parameters: {speed: 120, load_torque: 10.0}}\n'
        '/a/gear_sim: {ros__parameters: {half_backlash: 1e-4}}\n'
    )
    return str(path)


@pytest.mark.parametrize(
    ('arguments', 'expected'),
    [
        (['-p', 'speed:=130.5'], {'speed': 130.5}),
        (['-p', 'gear_sim:speed:=130.5', '-p', 'other:load_torque:=1.0'], {'speed': 130.5}),
        (['-p', 'friction_coefficient:=0.1'], {}),
        (
            ['-p', 'half_backlash:=2e-4'],
            {'half_backlash': '2e-4'},
        ),  # a text that the parameter list reads
        (['-r', 'speed:=x'], {}),
    ],
)
def test_last_value_of_what_is_given_twice(file, arguments, expected):
    words = ['--ros-args', '--params-file', file, *arguments]
    assert repeated_parameters(words, '/a/gear_sim', 'gear_sim') == expected


def test_a_number_with_a_point_replaces_an_integer_of_a_file(domain, client, file):
    from rcl_interfaces.srv import GetParameters

    arguments = ['--params-file', file, '-p', 'speed:=130.5']
    with ros_support.Process('gear_dynamics.nodes.sim', domain, arguments=arguments) as sim:
        sim.wait_for('streaming', 120)
        request = GetParameters.Request(names=['speed', 'load_torque'])
        values = client.call(GetParameters, 'gear_sim/get_parameters', request).values
        assert [each.double_value for each in values] == [130.5, 10.0]
        assert sim.stop() == 0
