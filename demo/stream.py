"""The processes of the demo: a sim that streams, an analyzer that logs, and what happens to it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple

from tqdm import tqdm

from gear_dynamics.parameters.settings import SimSettings

if TYPE_CHECKING:
    from demo.remote import Remote

SECOND_SPEED = 534.07
"""Pinion speed of the second part [rad/s]: 5100 rpm, at which the teeth rattle chaotically."""

SECOND, THIRD = 7.5, 13.0
"""When the second and the third part begin [s]. In the third the pinion is back at its first speed
and has a cracked tooth."""

CRACKED_TOOTH, SEVERITY = 20, 1.0
"""The tooth of the pinion that cracks, counted from 0, and how badly: 2 mm deep."""

PATIENCE = 300.0
"""How long the first start may take [s]: it compiles the model."""

SILENCE = 30.0
"""How long no block may come while it streams [s]."""

PAUSE = 2.0
"""How long the analyzer lets pass between two results at most [s]."""

CLOSING = 8.0
"""How long a process may take to close [s]."""

BAR = '{desc}: {percentage:3.0f} %|{bar}| {n:.0f} of {total:.0f} s'


class DemoError(Exception):
    """The demo cannot go on; the message is the one line that the user sees."""


class Streamed(NamedTuple):
    """What was heard while it streamed."""

    blocks: int
    real_time_factor: float


def stream(folder: Path, duration: float) -> Streamed:
    """Run sim and analyzer as two processes, change the speed twice, and crack a tooth.

    Parameters
    ----------
    folder : Path
        Where the log and what the processes say go.
    duration : float
        How long to stream, in the time of the model [s].

    Raises
    ------
    DemoError
        If ROS is missing, or a process ends or does not begin to stream.
    """
    # On this machine alone and, unless one is given, in a domain that hardly anyone uses, so that
    # it meets no other system.
    os.environ.setdefault('ROS_DOMAIN_ID', str(216 + os.getpid() % 16))
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    sim = Child('sim', folder, {})
    analyzer = Child('analyzer', folder, {'log_directory': folder})
    with _remote() as rig, analyzer:
        with sim:
            children = (sim, analyzer)
            _wait_for_stream(rig, children)
            streamed = _drive(rig, children, duration)
        _let_finish(rig)
        return streamed


def _remote() -> Remote:
    try:
        from demo.remote import Remote

        return Remote()
    except ModuleNotFoundError as error:
        raise DemoError(f'{error.name} is missing; make demo installs what is needed') from None
    except Exception as error:  # RCLError is a private class of the extension
        raise DemoError(f'ROS 2 does not start: {" ".join(str(error).split())}') from None


def _wait_for_stream(rig: Remote, children: tuple[Child, ...]) -> None:
    print('Starting sim and analyzer. The first time, they compile the model for this machine.')
    start = time.monotonic()
    with tqdm(desc='starting', bar_format='{desc}: {elapsed}') as bar:
        while not (rig.blocks and rig.analyzer_listens):
            rig.listen(0.1)
            bar.update()
            _check(children)
            if time.monotonic() - start > PATIENCE:
                raise DemoError(f'nothing was streamed within {PATIENCE:.0f} s')


def _drive(rig: Remote, children: tuple[Child, ...], duration: float) -> Streamed:
    settings = SimSettings()
    block = settings.block_size / settings.sample_rate
    first, start, part = rig.blocks, rig.heard, 1
    with tqdm(desc='streaming', total=duration, bar_format=BAR) as bar:
        while bar.n < duration:
            rig.listen(0.1)
            bar.update((rig.blocks - first) * block - bar.n)
            _check(children)
            if time.monotonic() - rig.heard > SILENCE:
                raise DemoError(f'the sim has been silent for {SILENCE:.0f} s')
            if bar.n > SECOND and part == 1:
                rig.set_speed(SECOND_SPEED)
                part = 2
            if bar.n > THIRD and part == 2:
                rig.set_speed(settings.speed)
                rig.crack(CRACKED_TOOTH, SEVERITY)
                part = 3
    return Streamed(rig.blocks - first, bar.n / (rig.heard - start))


def _let_finish(rig: Remote) -> None:
    """Wait until the analyzer, which may be behind on a busy machine, has no more to say."""
    end = time.monotonic() + SILENCE
    while time.monotonic() < min(end, rig.heard_result + PAUSE):
        rig.listen(0.1)


def _check(children: tuple[Child, ...]) -> None:
    for child in children:
        child.check()


class Child:
    """An executable of this package in a process of its own; ended when the context is left."""

    def __init__(self, name: str, folder: Path, parameters: dict[str, object]) -> None:
        self._name = name
        self._said = folder / f'{name}.txt'
        given = [part for item in parameters.items() for part in ('-p', '{}:={}'.format(*item))]
        self._command = [sys.executable, '-m', f'gear_dynamics.nodes.{name}']
        self._command += ['--ros-args', *given] if given else []

    def __enter__(self) -> Child:
        with self._said.open('w') as said:
            self._process = subprocess.Popen(self._command, stdout=said, stderr=subprocess.STDOUT)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(CLOSING)
        except subprocess.TimeoutExpired:
            print(f'demo: {self._name} did not close and was ended', file=sys.stderr)
        finally:
            self._process.kill()
            self._process.wait()

    def check(self) -> None:
        """Raise a `DemoError` with the last thing that the process said if it has ended."""
        code = self._process.poll()
        if code is not None:
            said = self._said.read_text(errors='replace').strip().splitlines()
            last = said[-1] if said else 'it said nothing'
            raise DemoError(f'{self._name} ended with exit code {code}: {last}')
