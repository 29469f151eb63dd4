"""The command `gear-dynamics NAME`: runs the executable of that name.

Only the executable asked for is imported, so that help is quick and what needs no ROS runs
without it.
"""

from __future__ import annotations

import argparse
import difflib
import importlib
import re
import sys

from gear_dynamics.compiling import exit_at_signal
from gear_dynamics.versions import __version__

EXECUTABLES = {
    'sim': ('gear_dynamics.nodes.sim', 'stream a simulated gear pair in real time (ROS 2)'),
    'analyzer': ('gear_dynamics.nodes.analyzer', 'analyse the stream and log it to MCAP (ROS 2)'),
    'replay': ('gear_dynamics.nodes.replay', 'play a log back on its own topics (ROS 2)'),
    'rig': ('gear_dynamics.nodes.rig', 'run sim, analyzer and page with one command (ROS 2)'),
    'log': ('gear_dynamics.bag.command', 'inspect, recover, export and plot logs'),
    'analyse': ('gear_dynamics.recordings.command', 'analyse recordings of a real machine'),
    'dashboard': ('gear_dynamics.web.command', 'show a gear pair live in the browser'),
    'foxglove': ('gear_dynamics.nodes.foxglove', 'show the topics in the Foxglove app (ROS 2)'),
    'study': ('gear_dynamics.study.command', 'run experiments off line, with data and figures'),
}
"""Name of each executable, the module with its `main(argv) -> int`, and what it does."""

ROS_MODULE = re.compile(r'rclpy|std_srvs|\w+_msgs|\w+_interfaces')
"""The modules of ROS 2 that the nodes import."""

LIVE_MODULE = re.compile(r'aiohttp|foxglove')
"""The modules that the live views need beside ROS."""

MISSING_LIVE = 'gear-dynamics {name} needs {module}: pip install "gear_dynamics[live]"'

MISSING_ROS = (
    'gear-dynamics {name} needs ROS 2 (rclpy): install it with pip install "gear_dynamics[ros]", '
    'or source a ROS 2 Jazzy installation'
)


def main(argv: list[str] | None = None) -> int:
    """Run `gear-dynamics` and return its exit code: that of the executable, or 2 if refused."""
    arguments = sys.argv[1:] if argv is None else argv
    name = _parser().parse_args(arguments[:1]).name
    if name not in EXECUTABLES:
        print(_unknown(name), file=sys.stderr)
        return 2
    module = EXECUTABLES[name][0]
    if module.startswith(('gear_dynamics.nodes.', 'gear_dynamics.web.')):
        exit_at_signal()  # until the node takes signals itself
    try:
        executable = importlib.import_module(module)
        return executable.main(arguments[1:])
    except ModuleNotFoundError as error:
        print(_missing(name, error), file=sys.stderr)
        return 2


def _missing(name: str, error: ModuleNotFoundError) -> str:
    """Return the line that says what to install; raise the error if it is a fault of ours."""
    module = str(error.name).partition('.')[0]
    if LIVE_MODULE.fullmatch(module):
        return MISSING_LIVE.format(name=name, module=module)
    if ROS_MODULE.fullmatch(module):
        return MISSING_ROS.format(name=name)
    raise error


def _parser() -> argparse.ArgumentParser:
    lines = [f'  {name:<10}{about}' for name, (_, about) in EXECUTABLES.items()]
    parser = argparse.ArgumentParser(
        prog='gear-dynamics',
        usage='gear-dynamics NAME [arguments]',
        description='Real-time vibration of a simulated spur gear pair.',
        epilog='\n'.join(['names:', *lines, '', 'gear-dynamics NAME --help describes each.']),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument('--version', action='version', version=__version__)
    parser.add_argument('name', metavar='NAME', help='what to run; one of the names below')
    return parser


def _unknown(name: str) -> str:
    near = difflib.get_close_matches(name, EXECUTABLES, n=1)
    hint = f'did you mean {near[0]!r}?' if near else f'known are {", ".join(EXECUTABLES)}'
    return f'gear-dynamics: there is no {name!r}; {hint}'


if __name__ == '__main__':
    sys.exit(main())
