"""Of a parameter that is given more than once, the last value holds, whatever its type."""

import pytest

rclpy = pytest.importorskip('rclpy')

from gear_dynamics.model.gear_pair import GearPair  # noqa: E402
from gear_dynamics.nodes.overrides import repeated_parameters  # noqa: E402
from gear_dynamics.nodes.parameters import NodeParameters  # noqa: E402
from gear_dynamics.parameters.settings import SimSettings  # noqa: E402


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
        # A text that the parameter list reads as a number.
        (['-p', 'half_backlash:=2e-4'], {'half_backlash': '2e-4'}),
        (['-r', 'speed:=x'], {}),
    ],
)
def test_last_value_of_what_is_given_twice(file, arguments, expected):
    words = ['--ros-args', '--params-file', file, *arguments]
    assert repeated_parameters(words, '/a/gear_sim', 'gear_sim') == expected


def test_a_number_with_a_point_replaces_an_integer_of_a_file(domain, file):
    arguments = ['--ros-args', '--params-file', file, '-p', 'speed:=130.5']
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    node = rclpy.create_node(
        'gear_sim',
        context=context,
        cli_args=arguments,
        automatically_declare_parameters_from_overrides=True,
    )
    try:
        repeated = repeated_parameters(arguments, '/gear_sim', 'gear_sim')
        parameters = NodeParameters(node, (GearPair, SimSettings), repeated)
        settings = parameters.get(SimSettings)
        assert (settings.speed, settings.load_torque) == (130.5, 10.0)
        assert node.get_parameter('speed').value == 130.5
    finally:
        node.destroy_node()
        context.try_shutdown()
