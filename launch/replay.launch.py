"""Play a log, with an analyzer and the page if they are wanted.

The end of the log, or of any other of the processes, ends the launch.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.events.process import ProcessExited
from launch_ros.actions import Node

PACKAGE = 'gear_dynamics'

SWITCH = ['true', 'false']

RIG = ['gear_pair/samples', 'gear_pair/events', 'gear_pair/configuration']
"""What an analyzer needs; its own topics are left out, since it publishes them anew."""

ARGUMENTS = [
    DeclareLaunchArgument('log', description='bag folder or MCAP file'),
    DeclareLaunchArgument('rate', default_value='1.0', description='0: as fast as possible'),
    DeclareLaunchArgument('loop', default_value='false', choices=SWITCH),
    DeclareLaunchArgument('start', default_value='0.0', description='where to begin [s]'),
    DeclareLaunchArgument('duration', default_value='0.0', description='0: to the end [s]'),
    DeclareLaunchArgument(
        'namespace', default_value='', description='takes the place of the recorded one'
    ),
    DeclareLaunchArgument('analyzer', default_value='false', choices=SWITCH),
    DeclareLaunchArgument('dashboard', default_value='false', choices=SWITCH),
    DeclareLaunchArgument(
        'publish_clock', default_value='false', choices=SWITCH, description='for use_sim_time'
    ),
    DeclareLaunchArgument('log_level', default_value='info', description='of all nodes'),
]


def generate_launch_description() -> LaunchDescription:
    """Return the player and what listens to it, all in one namespace."""
    return LaunchDescription([*ARGUMENTS, OpaqueFunction(function=start)])


def start(context: LaunchContext) -> list[Node]:
    """Return the nodes that the arguments ask for."""
    given = context.launch_configurations

    def node(executable: str, parameters: dict) -> Node:
        return Node(
            package=PACKAGE,
            executable=executable,
            namespace=given['namespace'],
            parameters=[parameters],
            arguments=['--ros-args', '--log-level', given['log_level']],
            output='screen',
            on_exit=_ended,
        )

    replay = {
        'log': given['log'],
        **{name: float(given[name]) for name in ('rate', 'start', 'duration')},
        **{name: given[name] == 'true' for name in ('loop', 'publish_clock')},
        # A first start of the analyzer compiles; it need not be waited for where there is none.
        'listener_wait': 120.0 if given['analyzer'] == 'true' else 5.0,
    }
    nodes = []
    if given['analyzer'] == 'true':
        replay['topics'] = RIG
        nodes.append(node('analyzer', {'log': False}))
    if given['dashboard'] == 'true':
        nodes.append(node('dashboard', {}))
    return [*nodes, node('replay', replay)]


def _ended(event: ProcessExited, context: LaunchContext) -> list[Shutdown]:
    """End the launch; with an error if the process did."""
    if event.returncode and not context.is_shutdown:
        raise RuntimeError(f'{event.process_name} ended with exit code {event.returncode}')
    return [Shutdown(reason=f'{event.process_name} ended')]
