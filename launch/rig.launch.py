"""Start a rig: the simulated gear pair and the analyzer that listens to it and logs."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'gear_dynamics'


def generate_launch_description() -> LaunchDescription:
    """Return sim and analyzer in one namespace, both with one parameter file."""
    default = PathJoinSubstitution([FindPackageShare(PACKAGE), 'config', 'default.yaml'])
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                'namespace', default_value='', description='namespace of the rig; each its own'
            ),
            DeclareLaunchArgument(
                'params_file', default_value=default, description='ROS parameter file of the rig'
            ),
            *(_node(executable) for executable in ('sim', 'analyzer')),
        ]
    )


def _node(executable: str) -> Node:
    return Node(
        package=PACKAGE,
        executable=executable,
        namespace=LaunchConfiguration('namespace'),
        parameters=[LaunchConfiguration('params_file')],
        output='screen',
    )
