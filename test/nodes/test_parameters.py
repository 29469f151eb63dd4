"""ROS parameters follow from the parameter lists."""

import dataclasses

import pytest

rclpy = pytest.importorskip('rclpy')
rclpy_parameter = pytest.importorskip('rclpy.parameter')

from gear_dynamics.nodes.parameters import NodeParameters, help_text  # noqa: E402
from gear_dynamics.parameters.parameter import ParameterError, ParameterSet, parameter  # noqa: E402


@dataclasses.dataclass(frozen=True)
class Drive(ParameterSet):
    power: float = parameter(2.0, 'power', unit='kW', minimum=0.0, maximum=10.0, live=True)
    poles: int = parameter(4, 'poles', minimum=2, maximum=12)
    brake: bool = parameter(False, 'brake', live=True)


@dataclasses.dataclass(frozen=True)
class Label(ParameterSet):
    maker: str = parameter('none', 'maker', live=True)
    phase: float = parameter(0.0, 'phase', unit='rad', minimum=-1.0, maximum=1.0, live=True)

    def __post_init__(self):
        super().__post_init__()
        if self.maker == 'refused':
            raise ParameterError('maker is refused')


@pytest.fixture
def make(domain):
    """Return a function that makes a node with the parameters given on the command line."""
    context = rclpy.Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    nodes = []

    def _make(*given):
        arguments = ['--ros-args', *(part for each in given for part in ('-p', each))]
        node = rclpy.create_node(
            'drive',
            context=context,
            cli_args=arguments,
            automatically_declare_parameters_from_overrides=True,
        )
        nodes.append(node)
        return node, NodeParameters(node, (Drive, Label))

    yield _make
    for node in nodes:
        node.destroy_node()
    context.try_shutdown()


def test_values_given_at_the_start_come_in_the_type_of_the_list(make):
    node, parameters = make('power:=3', 'poles:=6', 'phase:="5e-1"')
    assert parameters.get(Drive) == Drive(power=3.0, poles=6)
    assert parameters.get(Label) == Label(phase=0.5)
    assert isinstance(node.get_parameter('power').value, float)
    assert isinstance(node.get_parameter('phase').value, float)


def test_descriptors_tell_range_and_whether_a_parameter_changes(make):
    node, _ = make()
    power, poles = node.describe_parameters(['power', 'poles'])
    assert (power.description, power.read_only) == ('power [kW]', False)
    assert (power.floating_point_range[0].from_value, power.floating_point_range[0].to_value) == (
        0.0,
        10.0,
    )
    assert (poles.read_only, poles.integer_range[0].to_value) == (True, 12)


def test_parameter_of_another_node_is_left_out(make):
    node, _ = make('load_torque:=3.0')
    assert not node.has_parameter('load_torque')


@pytest.mark.parametrize(
    ('given', 'words'),
    [
        ('power:=11.0', ['power', '11', '0 to 10 kW']),
        ('power:=.nan', ['power', 'nan']),
        ('power:=much', ['power', 'much']),
        ('poles:=4.5', ['poles', '4.5', 'integer']),
        ('brake:=1', ['brake', '1', 'true or false']),
        ('loadtorque:=1.0', ['loadtorque', 'nearest name is load_torque']),
        ('use_sim_time:=3', ['use_sim_time', '3', 'true or false']),
    ],
)
def test_wrong_value_at_the_start_is_refused_in_one_line(make, given, words):
    with pytest.raises(ParameterError) as caught:
        make(given)
    message = str(caught.value)
    assert '\n' not in message
    assert all(word in message for word in words), message


def test_live_change_is_checked_as_a_whole_and_told(make):
    node, parameters = make()
    told = []
    parameters.on_change(told.append)
    changes = [
        rclpy_parameter.Parameter('power', value=5),
        rclpy_parameter.Parameter('brake', value=True),
    ]
    assert node.set_parameters_atomically(changes).successful
    assert told == [{'power', 'brake'}]
    assert parameters.get(Drive) == Drive(power=5.0, brake=True)
    assert node.get_parameter('power').value == 5.0


@pytest.mark.parametrize(
    ('name', 'value'),
    [
        ('power', -1.0),
        ('power', float('nan')),
        ('power', 'much'),
        ('power', None),
        ('poles', 6),
        ('brake', 1),
        ('maker', 'refused'),
    ],
)
def test_wrong_live_change_is_refused_with_a_reason(make, name, value):
    node, parameters = make()
    before = parameters.get(Drive), parameters.get(Label)
    (result,) = node.set_parameters([rclpy_parameter.Parameter(name, value=value)])
    assert not result.successful
    assert name in result.reason
    assert (parameters.get(Drive), parameters.get(Label)) == before
    assert node.has_parameter(name)


def test_mirrored_value_is_set_without_telling_anyone(make):
    node, parameters = make()
    told = []
    parameters.on_change(told.append)
    parameters.mirror({'power': 7.0})
    assert node.get_parameter('power').value == parameters.get(Drive).power == 7.0
    assert not told
    node.set_parameters([rclpy_parameter.Parameter('power', value=8.0)])
    assert told == [{'power'}]


def test_help_names_every_parameter_with_default_and_range():
    text = help_text((Drive, Label))
    assert 'power (default 2.0)' in text
    assert 'power: a finite number from 0 to 10 kW; changes while running' in text
    assert 'brake (default false)' in text
