"""Start, spin and close a node: the same for every node of the package."""

from __future__ import annotations

import itertools
import re
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.logging import LoggingSeverity, set_logger_level
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from gear_dynamics.compiling import Interrupted
from gear_dynamics.nodes.exit_codes import USAGE_ERROR
from gear_dynamics.nodes.middleware import use_profile
from gear_dynamics.nodes.overrides import repeated_parameters
from gear_dynamics.nodes.parameters import NodeParameters, help_text
from gear_dynamics.parameters.files import check_parameter_file, check_section
from gear_dynamics.parameters.parameter import ParameterError, ParameterSet


class NodeError(Exception):
    """A node cannot go on; the message is the one line that the user sees."""


class Part(Protocol):
    """What runs inside a node: made of the node and its parameters, closed at the end."""

    def close(self) -> None:
        """Finish within 5 s: publish what is last, close files."""


@runtime_checkable
class FinitePart(Part, Protocol):
    """A part that comes to an end by itself.

    It is asked, since the events executor logs whatever a callback raises as a fatal error.
    """

    def done(self) -> bool:
        """Tell whether nothing is left to do; may raise `NodeError`."""


def run_node(
    name: str,
    about: str,
    lists: Sequence[type[ParameterSet]],
    make: Callable[[Node, NodeParameters], Part],
    argv: Sequence[str] | None = None,
) -> int:
    """Run a node until SIGINT, SIGTERM, `NodeError` or the end of a `FinitePart`.

    Parameters
    ----------
    name : str
        Name of the node.
    about : str
        What it does, in one or two lines, for `--help`.
    lists : sequence of ParameterSet classes
        Its parameters.
    make : callable
        Makes the working part from the node and its parameters; it may raise `NodeError` or
        `ParameterError`, and so may any callback.
    argv : sequence of str, optional
        Arguments after the program's name; those of the process by default.

    Returns
    -------
    int
        Exit code: 0 after a signal or when it is done, 1 if the node could not go on, 2 for
        wrong input at start.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    if {'-h', '--help'} & set(arguments[: _ros_start(arguments)]):
        print(f'{about}\n\nParameters (-p NAME:=VALUE after --ros-args):\n{help_text(lists)}')
        return 0
    stop = StopFlag()
    try:
        for path in _parameter_files(arguments):
            # rclpy ignores unknown keys, and says less about a malformed file.
            check_parameter_file(path)
        _start_ros(name, arguments)
    except (ParameterError, OSError) as error:
        return _fail(name, error, USAGE_ERROR)
    try:
        return _run(name, lists, make, arguments, stop)
    finally:
        rclpy.try_shutdown()


class StopFlag:
    """Set by SIGINT and SIGTERM, so that closing is in our hands.

    With the handlers of rclpy the context would be gone before the last diagnostics are out, and
    a second Ctrl-C would break the closing of a file.
    """

    def __init__(self) -> None:
        self._set = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)

    def __bool__(self) -> bool:
        return self._set

    def _on_signal(self, number: int, frame: Any) -> None:
        self._set = True


def make_executor() -> Executor:
    """Return the events executor, which takes half the CPU, or the plain one if it is missing."""
    try:
        from rclpy.experimental.events_executor import EventsExecutor
    except ImportError:
        return SingleThreadedExecutor()
    return EventsExecutor()


def _ros_start(arguments: Sequence[str]) -> int:
    return arguments.index('--ros-args') if '--ros-args' in arguments else len(arguments)


def _parameter_files(arguments: Sequence[str]) -> list[Path]:
    return [
        Path(path) for option, path in itertools.pairwise(arguments) if option == '--params-file'
    ]


def _start_ros(name: str, arguments: list[str]) -> None:
    use_profile()
    # What is wrong with an argument is told below; a second line by rcl would add nothing.
    set_logger_level('rcl', LoggingSeverity.FATAL)
    try:
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
        left = remove_ros_args(arguments)
    except Exception as error:  # RCLError and its kin are private classes of the extension
        raise ParameterError(_first_cause(str(error))) from error
    set_logger_level('rcl', LoggingSeverity.UNSET)
    if left:
        rclpy.try_shutdown()
        raise ParameterError(f'{left[0]} is not an argument; see {name} --help')


def _first_cause(message: str) -> str:
    message = re.sub(r', at \S+:\d+', '', message)
    return ' '.join(message.removeprefix('failed to initialize rcl: ').split())


def _run(
    name: str,
    lists: Sequence[type[ParameterSet]],
    make: Callable[[Node, NodeParameters], Part],
    arguments: Sequence[str],
    stop: StopFlag,
) -> int:
    try:
        node = Node(name, automatically_declare_parameters_from_overrides=True)
    except (ParameterException, ValueError, TypeError) as error:
        return _fail(name, error, USAGE_ERROR)
    try:
        full_name = node.get_fully_qualified_name()
        for path in _parameter_files(arguments):
            check_section(path, full_name, name)
        repeated = repeated_parameters(arguments, full_name, node.get_name())
        if stop:
            return 0
        part = make(node, NodeParameters(node, lists, repeated))
    except ParameterError as error:
        return _fail(name, error, USAGE_ERROR)
    except NodeError as error:
        return _fail(name, error, 1)
    except Interrupted:
        return 0
    try:
        _spin(node, part, stop)
    except NodeError as error:
        return _fail(name, error, 1)
    finally:
        part.close()
        node.destroy_node()
    return 0


def _spin(node: Node, part: Part, stop: StopFlag) -> None:
    # The events executor runs callbacks only from spin_once with a time-out.
    executor = make_executor()
    executor.add_node(node)
    # Asked once: whether an object follows a protocol takes as long as handling a message.
    finite = part if isinstance(part, FinitePart) else None
    try:
        while not (stop or (finite and finite.done())) and rclpy.ok():
            executor.spin_once(timeout_sec=0.1)
    finally:
        executor.shutdown()


def _fail(name: str, error: Exception, code: int) -> int:
    print(f'{name}: {error}', file=sys.stderr)
    return code
