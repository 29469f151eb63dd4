"""Place the wheels of a rig in space: robot_state_publisher turns them by its joint states.

RViz then shows the wheels, and everything in the frame `line_of_action` has its place. With
aggregator:=true the diagnostics are grouped as well, for rqt_robot_monitor.
"""

from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'gear_dynamics'

SWITCH = ['true', 'false']

ARGUMENTS = [
    DeclareLaunchArgument('namespace', default_value='', description='namespace of the rig'),
    DeclareLaunchArgument(
        'urdf', default_value='', description='robot description; default: the default pair'
    ),
    DeclareLaunchArgument('aggregator', default_value='false', choices=SWITCH),
    DeclareLaunchArgument('use_sim_time', default_value='false', choices=SWITCH),
]


def generate_launch_description() -> LaunchDescription:
    """Return the publisher of the wheels' transforms, in the namespace of the rig."""
    return LaunchDescription([*ARGUMENTS, OpaqueFunction(function=start)])


def start(context: LaunchContext) -> list[Node]:
    """Return the nodes that the arguments ask for; raise where a file is missing."""
    given = context.launch_configurations
    share = Path(FindPackageShare(PACKAGE).perform(context))
    urdf = Path(given['urdf'] or share / 'urdf' / 'gear_pair.urdf')
    if not urdf.is_file():
        raise RuntimeError(f'urdf is {str(urdf)!r}: there is no such file')
    use_sim_time = given['use_sim_time'] == 'true'
    description = ParameterValue(urdf.read_text(encoding='utf-8'), value_type=str)
    nodes = [
        Node(
            package='robot_state_publisher',
            executable='robot_state_publisher',
            namespace=given['namespace'],
            parameters=[
                {
                    'robot_description': description,
                    'publish_frequency': 50.0,
                    'use_sim_time': use_sim_time,
                }
            ],
            remappings=[('joint_states', 'gear_pair/joint_states')],
            output='screen',
        )
    ]
    if given['aggregator'] == 'true':
        nodes.append(
            Node(
                package='diagnostic_aggregator',
                executable='aggregator_node',
                parameters=[str(share / 'config' / 'diagnostic_aggregator.yaml')],
                output='screen',
            )
        )
    return nodes
