"""Run the nodes for hours under what happens to nodes, and measure what they lose.

Usage: soak.py --hours 2 [--folder FOLDER]

A sim streams to an analyzer that logs, and to a steady listener that must miss nothing. Meanwhile,
at random moments (the seed is fixed): a second listener is killed or stopped for a while, the
analyzer is killed and started again, finished logs are read and replayed in another domain, and
the disk of the logs is filled and emptied again (only where a tmpfs can be mounted).

Printed at the end, and as it goes: gaps, latency percentiles, memory and its slope, shared memory,
and what each killed log lost. The exit code is 1 if the steady listener had a gap, a process ended
by itself, or a log lost more than it may.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
DOMAIN, REPLAY_DOMAIN = '231', '230'
LOST = 2.0
"""What the log of a killed analyzer may lose [s]: a second, and what was under way to it."""
RATE, BLOCK = 51200.0, 512
PAUSES = {'kill listener': 20.0, 'stop listener': 30.0, 'kill analyzer': 60.0, 'fill disk': 90.0}
"""Mean time between two events of a kind [s]."""


class Node:
    """A process that is started again whenever it is ended on purpose."""

    def __init__(self, name: str, folder: Path, *arguments: str, domain: str = DOMAIN) -> None:
        self.name, self._folder, self._arguments, self._domain = name, folder, arguments, domain
        self.ends = 0
        self.start()

    def start(self) -> None:
        """Start the process; its output goes to a file."""
        environment = dict(os.environ, ROS_DOMAIN_ID=self._domain, PYTHONUNBUFFERED='1')
        environment['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
        with open(self._folder / f'{self.name}.txt', 'a') as said:
            self.process = subprocess.Popen(
                [sys.executable, *self._arguments],
                cwd=ROOT,
                env=environment,
                stdout=said,
                stderr=subprocess.STDOUT,
            )

    def send(self, number: int) -> None:
        """Send a signal, if the process is there."""
        with contextlib.suppress(ProcessLookupError):
            self.process.send_signal(number)

    def again(self, number: int) -> None:
        """End the process by a signal and start it again."""
        self.send(number)
        self.process.wait()
        self.start()

    def check(self) -> None:
        """Start the process again if it ended by itself, and count that."""
        if self.process.poll() is not None:
            self.ends += 1
            print(f'{self.name} ended by itself with exit code {self.process.returncode}')
            self.start()

    @property
    def memory(self) -> float:
        """Resident memory [MB]; 0 where /proc is missing."""
        with contextlib.suppress(OSError):
            pages = Path(f'/proc/{self.process.pid}/statm').read_text().split()[1]
            return int(pages) * os.sysconf('SC_PAGE_SIZE') / 1e6
        return 0.0

    def close(self) -> None:
        """End the process for good."""
        self.send(signal.SIGCONT)
        self.send(signal.SIGINT)
        try:
            self.process.wait(15)
        except subprocess.TimeoutExpired:
            print(f'{self.name} did not close')
            self.ends += 1
            self.process.kill()
            self.process.wait()


@contextlib.contextmanager
def small_disk(folder: Path) -> Iterator[bool]:
    """Mount a tmpfs at a folder if that is allowed; yield whether it was."""
    command = ['mount', '-t', 'tmpfs', '-o', 'size=256m', 'soak', str(folder)]
    mounted = (
        sys.platform == 'linux' and not subprocess.run(command, capture_output=True).returncode
    )
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(['umount', '-l', str(folder)], capture_output=True)


class Soak:
    """The processes, what happens to them, and what is measured."""

    def __init__(self, folder: Path, seed: int, full: bool) -> None:
        self.folder, self.logs = folder, folder / 'logs'
        self._random, self._full = random.Random(seed), full
        self._due = {kind: pause / 2 for kind, pause in PAUSES.items()}
        self._begin = time.monotonic()
        self._memory: list[tuple[float, ...]] = []
        self._stopped_until = self._full_until = 0.0
        self._old_logs: set[Path] = set()
        self.losses: list[float] = []
        self.played = 0
        module, log = '-m', ['-p', f'log_directory:={self.logs}', '-p', 'log_free_floor:=0.0']
        listen = [__file__, '--listen']
        self.sim = Node('sim', folder, module, 'gear_dynamics.nodes.sim')
        analyzer = [module, 'gear_dynamics.nodes.analyzer', '--ros-args', *log]
        self.analyzer = Node('analyzer', folder, *analyzer)
        self.steady = Node('steady', folder, *listen, str(folder / 'steady.json'))
        self.victim = Node('victim', folder, *listen, str(folder / 'victim.json'))
        self.nodes = (self.sim, self.analyzer, self.steady, self.victim)

    def _next(self, kind: str, now: float) -> float:
        return now + self._random.expovariate(1 / PAUSES[kind])

    def step(self) -> None:
        """Do what is due."""
        now = time.monotonic() - self._begin
        if self._stopped_until and now > self._stopped_until:
            self.victim.send(signal.SIGCONT)
            self._stopped_until = 0.0
        for kind, due in self._due.items():
            if now > due:
                self._do(kind, now)
                self._due[kind] = self._next(kind, now)
        for node in self.nodes:
            node.check()
        self._memory.append((now, *(node.memory for node in self.nodes[:3]), shared_memory()))

    def _do(self, kind: str, now: float) -> None:
        if kind == 'kill listener' and not self._stopped_until:
            self.victim.again(signal.SIGKILL)
        elif kind == 'stop listener' and not self._stopped_until:
            self.victim.send(signal.SIGSTOP)
            self._stopped_until = now + self._random.uniform(1.0, 15.0)
        elif kind == 'kill analyzer':
            self._kill_analyzer()
        elif kind == 'fill disk' and self._full:
            self._fill_disk()

    def _kill_analyzer(self) -> None:
        killed = time.time()
        self.analyzer.again(signal.SIGKILL)
        logs = set(self.logs.glob('gear_log_*'))
        for log in logs - self._old_logs:
            if time.monotonic() - self._begin > self._full_until:
                self.losses += lost(log, killed)
            if self._random.random() < 0.5:
                self._replay(log)
        for log in self._old_logs:
            shutil.rmtree(log)
        self._old_logs = logs - self._old_logs

    def _replay(self, log: Path) -> None:
        """Play a log as fast as it goes, in a domain of its own."""
        ros = ['--ros-args', '-p', f'log:={log}', '-p', 'rate:=0.0']
        player = Node(
            'replay', self.folder, '-m', 'gear_dynamics.nodes.replay', *ros, domain=REPLAY_DOMAIN
        )
        with contextlib.suppress(subprocess.TimeoutExpired):
            if player.process.wait(60) == 0:
                self.played += 1
        player.close()

    def _fill_disk(self) -> None:
        if not set(self.logs.glob('gear_log_*')) - self._old_logs:
            return  # the analyzer is still starting, and would refuse to
        filler = self.logs / 'filler'
        with contextlib.suppress(OSError), filler.open('wb') as stream:
            while True:
                stream.write(bytes(1 << 20))
        time.sleep(self._random.uniform(2.0, 8.0))
        filler.unlink(missing_ok=True)
        self._full_until = time.monotonic() - self._begin + 10.0

    def close(self) -> int:
        """End all, print what was measured, and return an exit code."""
        for node in (self.victim, self.steady, self.analyzer, self.sim):
            node.close()
        found = json.loads((self.folder / 'steady.json').read_text())
        print(json.dumps(found))
        rows = np.array(self._memory)
        late = rows[rows[:, 0] > 0.2 * rows[-1, 0]]
        for name, column in zip(
            ('sim', 'analyzer', 'listener', '/dev/shm'), range(1, 5), strict=True
        ):
            slope = np.polyfit(late[:, 0] / 3600, late[:, column], 1)[0] if len(late) > 10 else 0.0
            print(f'{name}: {rows[:, column].max():.0f} MB at most, {slope:+.1f} MB/h')
        worst = max(self.losses, default=0.0)
        print(
            f'{len(self.losses)} killed logs lost {worst:.2f} s at most; {self.played} were played'
        )
        ends = sum(node.ends for node in self.nodes)
        return int(bool(found['gaps'] or ends or worst > LOST or not found['blocks']))


def shared_memory() -> float:
    """Return what is in /dev/shm [MB]."""
    total = 0
    for path in Path('/dev/shm').glob('*'):
        with contextlib.suppress(OSError):
            total += path.stat().st_blocks * 512
    return total / 1e6


def lost(log: Path, killed: float) -> list[float]:
    """Return how much of the stream before a kill is not in a log [s]; nothing if it had none."""
    from gear_dynamics.bag.channel import LogError
    from gear_dynamics.bag.reader import read_messages

    last = 0
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        with contextlib.suppress(LogError):
            for message in read_messages(log, 'gear_pair/samples'):
                last = max(last, message.log_time)
    return [killed - last / 1e9] if last else []


def listen(file: Path) -> None:
    """Hear the samples, and write gaps and latencies into a file every five seconds."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.signals import SignalHandlerOptions
    from sensor_msgs.msg import PointCloud2

    from gear_dynamics.wire.messages import header_stamp
    from gear_dynamics.wire.tables import TABLE_TYPE

    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(f'soak_{os.getpid()}')
    latencies: list[float] = []
    found: dict[str, float] = {'blocks': 0, 'gaps': 0, 'lost': 0}
    last = 0
    period = round(BLOCK / RATE * 1e9)

    def hear(data: bytes) -> None:
        nonlocal last
        stamp = header_stamp(data, TABLE_TYPE) or 0
        missing = round((stamp - last) / period) - 1 if last else 0
        if missing > 0:
            found['gaps'] += 1
            found['lost'] += missing
        last = stamp
        found['blocks'] += 1
        latencies.append(time.time() - (stamp + period) / 1e9)

    node.create_subscription(PointCloud2, 'gear_pair/samples', hear, 1000, raw=True)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    running = True

    def stop(*_: object) -> None:
        nonlocal running
        running = False

    signal.signal(signal.SIGINT, stop)
    written = time.monotonic()
    while running:
        executor.spin_once(timeout_sec=0.1)
        if time.monotonic() > written + 5 or not running:
            written = time.monotonic()
            recent = np.array(latencies[-1_000_000:] or [0.0]) * 1e3
            for share in (50, 99, 99.9):
                found[f'latency_p{share}_ms'] = round(float(np.percentile(recent, share)), 2)
            file.write_text(json.dumps(found))
    os._exit(0)


def main() -> int:
    """Run, and return the exit code."""
    parser = argparse.ArgumentParser(description='Run the nodes long, and measure what they lose.')
    parser.add_argument('--hours', type=float, default=2.0, help='how long; default 2')
    parser.add_argument('--seed', type=int, default=1, help='of what happens; default 1')
    parser.add_argument('--listen', type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.listen:
        listen(options.listen)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / 'logs').mkdir()
        with small_disk(folder / 'logs') as full:
            print(
                f'{options.hours:g} h, seed {options.seed}, disk {"fills" if full else "is left"}'
            )
            soak = Soak(folder, options.seed, full)
            end = time.monotonic() + options.hours * 3600
            try:
                while time.monotonic() < end:
                    soak.step()
                    time.sleep(0.5)
            except KeyboardInterrupt:
                print('stopped')
            code = soak.close()
            for said in sorted(folder.glob('*.txt')):
                for line in said.read_text(errors='replace').splitlines():
                    if 'Traceback' in line:
                        print(f'{said.name}: {line}')
                        code = 1
    print('held' if code == 0 else 'did not hold')
    return code


if __name__ == '__main__':
    sys.exit(main())
