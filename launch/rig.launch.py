"""Start a rig: the simulated gear pair, the analyzer that listens to it and logs, and the page.

The end of the sim or of the analyzer ends the launch.
"""

import os
from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    OpaqueFunction,
    SetEnvironmentVariable,
    Shutdown,
)
from launch.events.process import ProcessExited
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'gear_dynamics'

SWITCH = ['true', 'false']

ARGUMENTS = [
    DeclareLaunchArgument('namespace', default_value='', description='namespace of the rig'),
    DeclareLaunchArgument(
        'params', default_value='', description='ROS parameter file; default: config/default.yaml'
    ),
    DeclareLaunchArgument('params_file', default_value='', description='the same as params'),
    DeclareLaunchArgument('speed', default_value='', description='pinion speed [rad/s]'),
    DeclareLaunchArgument('faults', default_value='', description='file of faults'),
    DeclareLaunchArgument('analyzer', default_value='true', choices=SWITCH),
    DeclareLaunchArgument('dashboard', default_value='false', choices=SWITCH),
    DeclareLaunchArgument('log', default_value='true', choices=SWITCH, description='to MCAP'),
    DeclareLaunchArgument(
        'log_directory', default_value='', description='existing folder in which to log'
    ),
    DeclareLaunchArgument('use_sim_time', default_value='false', choices=SWITCH),
    DeclareLaunchArgument('log_level', default_value='info', description='of all nodes'),
]


def generate_launch_description() -> LaunchDescription:
    """Return the nodes of a rig, all in one namespace and with one parameter file."""
    return LaunchDescription([*ARGUMENTS, OpaqueFunction(function=start)])


def start(context: LaunchContext) -> list:
    """Return the actions that the arguments ask for; raise where a file is missing."""
    given = context.launch_configurations
    share = Path(FindPackageShare(PACKAGE).perform(context))
    params = given['params'] or given['params_file'] or share / 'config' / 'default.yaml'
    files = {'params': params, 'faults': given['faults']}
    for name, path in files.items():
        if path and not Path(path).is_file():
            raise RuntimeError(f'{name} is {str(path)!r}: there is no such file')

    def node(executable: str, required: bool, **parameters: str) -> Node:
        values = {name: _value(name, text) for name, text in parameters.items() if text}
        return Node(
            package=PACKAGE,
            executable=executable,
            namespace=given['namespace'],
            parameters=[str(params), {'use_sim_time': given['use_sim_time'] == 'true', **values}],
            arguments=['--ros-args', '--log-level', given['log_level']],
            output='screen',
            on_exit=_ended if required else None,
        )

    actions = [_middleware(share)]
    if given['analyzer'] == 'true':
        log = {'log': given['log'], 'log_directory': given['log_directory']}
        actions.append(node('analyzer', required=True, **log))
    if given['dashboard'] == 'true':
        actions.append(node('dashboard', required=False))
    actions.append(node('sim', required=True, speed=given['speed'], faults=given['faults']))
    return actions


def _ended(event: ProcessExited, context: LaunchContext) -> list[Shutdown]:
    """End the launch; with an error if the process did."""
    if event.returncode and not context.is_shutdown:
        raise RuntimeError(f'{event.process_name} ended with exit code {event.returncode}')
    return [Shutdown(reason=f'{event.process_name} ended')]


def _middleware(share: Path) -> SetEnvironmentVariable:
    """Keep one dead listener from starving the others, in nodes of other packages too."""
    name = 'FASTRTPS_DEFAULT_PROFILES_FILE'
    return SetEnvironmentVariable(name, os.environ.get(name, str(share / 'config' / 'fastdds.xml')))


def _value(name: str, text: str) -> str | bool | float:
    """Return an argument in the type of its parameter: ROS drops a text that replaces a number."""
    if name == 'speed':
        try:
            return float(text)
        except ValueError:
            raise RuntimeError(f'speed is {text!r}: it must be a number') from None
    return text == 'true' if name == 'log' else text
