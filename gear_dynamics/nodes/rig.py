"""The `rig` executable: sim, analyzer and page with one command, each a process of its own."""

from __future__ import annotations

import argparse
import dataclasses
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from gear_dynamics.nodes.exit_codes import USAGE_ERROR

RESTARTS = 3
"""How often a process that died is started again."""

GRACE = 5.0
"""Time that a process has to close after each of SIGINT and SIGTERM [s]."""

LOOK = 0.1
"""Time between two looks at the processes [s]."""


@dataclasses.dataclass
class Child:
    """A process of the rig.

    Attributes
    ----------
    name : str
        Its executable.
    arguments : list of str
    restarts : int
        How often it was started again.
    """

    name: str
    arguments: list[str]
    restarts: int = 0

    def __post_init__(self) -> None:
        self.began = time.monotonic()
        self.start()

    def start(self) -> None:
        """Start the process, out of reach of the terminal's Ctrl-C: the rig passes that on."""
        command = [sys.executable, '-m', 'gear_dynamics', self.name, *self.arguments]
        self.process = subprocess.Popen(command, start_new_session=True)

    @property
    def code(self) -> int | None:
        """Exit code of the process, negative for a signal; None while it runs."""
        return self.process.poll()

    def stop(self) -> None:
        """Ask the process to close, and force it after some time."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if self.code is None:
                self.process.send_signal(number)
                try:
                    self.process.wait(GRACE)
                except subprocess.TimeoutExpired:
                    continue

    @property
    def summary(self) -> str:
        """How it went, in one line."""
        code = self.code
        end = f'ended with code {code}'
        if code is not None and code < 0:
            end = f'was ended by {signal.Signals(-code).name}'
        again = f', restarts: {self.restarts}' if self.restarts else ''
        return f'{self.name} {end} after {time.monotonic() - self.began:.0f} s{again}'


class ProcessGroup:
    """Runs processes until a signal comes or one of them ends for good."""

    def __init__(self) -> None:
        self._stop = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)

    def _on_signal(self, number: int, frame: object) -> None:
        self._stop = True

    def run(self, commands: Sequence[tuple[str, list[str]]]) -> int:
        """Run executables with their arguments; return the exit code of the rig.

        Returns
        -------
        int
            0 after a signal or when a process ended with 0, otherwise the code of the process
            that ended the rig: 2 for wrong input, 1 if it died too often.
        """
        children: list[Child] = []
        code = 0
        try:
            for name, arguments in commands:
                if not self._stop:
                    children.append(Child(name, arguments))
            while not self._stop:
                ended = [child for child in children if child.code is not None]
                final = [child for child in ended if not self._revive(child)]
                if final:
                    code = _exit_code(final[0])
                    break
                time.sleep(LOOK)
        finally:
            # The one that was started last feeds the others: it closes first.
            for child in reversed(children):
                child.stop()
            for child in children:
                _say(child.summary)
        return code

    def _revive(self, child: Child) -> bool:
        """Start a process again if it died; tell whether that was done."""
        if child.code in (0, USAGE_ERROR) or child.restarts == RESTARTS:
            return False
        child.restarts += 1
        _say(f'{child.summary}: starting it again, {child.restarts} of {RESTARTS}')
        child.start()
        return True


def commands(arguments: argparse.Namespace) -> list[tuple[str, list[str]]]:
    """Return the executables of a rig with their arguments, the sim last."""
    common = ['--ros-args', '--log-level', arguments.log_level]
    if arguments.params:
        common += ['--params-file', str(arguments.params)]
    if arguments.namespace:
        common += ['-r', f'__ns:=/{arguments.namespace.strip("/")}']
    if arguments.use_sim_time:
        common += ['-p', 'use_sim_time:=true']

    def given(**parameters: object) -> list[str]:
        values = {name: value for name, value in parameters.items() if value is not None}
        return [part for name in values for part in ('-p', f'{name}:={values[name]}')]

    log = {'log': 'false'} if not arguments.log else {'log_directory': arguments.log_directory}
    children = []
    if arguments.analyzer:
        children.append(('analyzer', common + given(**log)))
    if arguments.dashboard:
        children.append(('dashboard', common))
    sim = given(speed=arguments.speed, faults=arguments.faults)
    return [*children, ('sim', common + sim)]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='gear-dynamics rig',
        description='Run sim, analyzer and page until Ctrl-C. What dies is started again, at most '
        f'{RESTARTS} times.',
    )
    add = parser.add_argument
    add('--params', type=_file, metavar='FILE', help='ROS parameter file for all of them')
    add('--faults', type=_file, metavar='FILE', help='file of faults')
    add('--speed', type=float, metavar='RAD/S', help='pinion speed')
    add('--namespace', default='', help='namespace of the rig, so that several can run')
    switch = argparse.BooleanOptionalAction
    add('--analyzer', action=switch, default=True, help='analyse the stream')
    add('--log', action=switch, default=True, help='log it to MCAP')
    add('--log-directory', metavar='FOLDER', help='existing folder in which to log (default: .)')
    add('--dashboard', action=switch, default=False, help='serve the live page')
    add('--use-sim-time', action='store_true', help='take the time from /clock')
    add('--log-level', default='info', help='of all nodes (default: %(default)s)')
    return parser


def _file(text: str) -> Path:
    path = Path(text)
    if not path.is_file():
        raise argparse.ArgumentTypeError(f'{text}: there is no such file')
    return path


def _exit_code(child: Child) -> int:
    code = child.code or 0
    return code if code >= 0 else 1


def _say(line: str) -> None:
    print(f'rig: {line}', file=sys.stderr, flush=True)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a rig until Ctrl-C; return the exit code."""
    arguments = _parser().parse_args(argv)
    os.environ.setdefault('PYTHONUNBUFFERED', '1')
    return ProcessGroup().run(commands(arguments))


if __name__ == '__main__':
    sys.exit(main())
