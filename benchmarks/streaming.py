"""What streaming costs: CPU, highest rate, number of rigs, time to the first block, replay.

    python benchmarks/streaming.py            # everything, a few minutes
    python benchmarks/streaming.py cpu rigs   # parts of it

Each sim, analyzer and listener is a process of its own. A rate or a number of rigs holds if no
listener sees a gap and model time keeps up with the clock.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

RATE, BLOCK = 51200, 512
TICKS = os.sysconf('SC_CLK_TCK')
DOMAIN = '232'  # neither the tests nor the demo take it
KEEPS_UP = 0.99
PROBE = 4.0
"""Seconds of the runs that look for a limit."""
MONITOR = (
    ('gear_pair/pinion/acceleration', 'AccelStamped'),
    ('gear_pair/gear/acceleration', 'AccelStamped'),
    ('gear_pair/mesh_force', 'WrenchStamped'),
    ('gear_pair/friction_force', 'WrenchStamped'),
)


@contextlib.contextmanager
def process(
    what: Sequence[str],
    parameters: dict[str, Any] | None = None,
    ros: Sequence[str] = (),
    **env: str,
) -> Iterator[subprocess.Popen[str]]:
    """Run Python with these arguments and ROS parameters until the block ends."""
    given = [part for k, v in (parameters or {}).items() for part in ('-p', f'{k}:={v}')]
    running = subprocess.Popen(
        [sys.executable, *what, '--ros-args', *given, *ros],
        cwd=ROOT,
        env={
            **os.environ,
            'ROS_DOMAIN_ID': DOMAIN,
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
            **env,
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        yield running
    finally:
        running.send_signal(signal.SIGINT)
        try:
            running.wait(10)
        except subprocess.TimeoutExpired:
            running.kill()
            running.wait()


def sim(namespace: str = '', parameters: dict[str, Any] | None = None, **env: str) -> Any:
    """Run a sim."""
    ros = ['-r', f'__ns:=/{namespace}'] if namespace else []
    return process(['-m', 'gear_dynamics.nodes.sim'], parameters, ros, **env)


def listener(mode: str, seconds: float, *namespaces: str) -> Any:
    """Run this file as a listener that reports after some seconds of messages."""
    return process([__file__, '--listen', mode, '--seconds', str(seconds), *namespaces])


def report(running: subprocess.Popen[str]) -> dict[str, Any]:
    """Return what a listener found."""
    assert running.stdout is not None
    found: dict[str, Any] = json.loads(running.stdout.readline())
    return found


def listen(mode: str, seconds: float, namespaces: Sequence[str]) -> None:
    """Listen to samples or monitor topics and print what was heard, as JSON."""
    import geometry_msgs.msg
    import rclpy
    from rclpy.experimental.events_executor import EventsExecutor
    from rclpy.qos import HistoryPolicy, QoSProfile
    from sensor_msgs.msg import PointCloud2

    from gear_dynamics.nodes.middleware import use_profile
    from gear_dynamics.wire.tables import decode_table

    use_profile()
    rclpy.init(args=[])
    node = rclpy.create_node(f'listener_{os.getpid()}')
    heard: dict[str, list[tuple[float, int]]] = {}
    keep_all = QoSProfile(history=HistoryPolicy.KEEP_ALL)

    def take(name: str, data: bytes) -> None:
        heard.setdefault(name, []).append((time.monotonic(), decode_table(data).stamp_ns))

    for name in namespaces or ['']:
        topic = f'{name}/gear_pair/samples' if name else 'gear_pair/samples'
        if mode == 'samples':
            hear = functools.partial(take, name)
            node.create_subscription(PointCloud2, topic, hear, keep_all, raw=True)
    if mode == 'monitor':
        for topic, kind in MONITOR:
            kind_class = getattr(geometry_msgs.msg, kind)
            node.create_subscription(kind_class, topic, lambda data: None, 1000, raw=True)
    executor = EventsExecutor()
    executor.add_node(node)
    begin = time.monotonic()
    while mode == 'samples' and len(heard) < max(1, len(namespaces)):
        executor.spin_once(timeout_sec=0.1)
        if time.monotonic() - begin > 120:
            break
    if len(namespaces) > 1:
        for blocks in heard.values():
            blocks.clear()  # what came while others were still to start
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)
    print(json.dumps(summary(list(heard.values()))), flush=True)
    os._exit(0)


def summary(streams: list[list[tuple[float, int]]]) -> dict[str, Any]:
    """Return gaps, slowest real-time factor and spacing of streams of (arrival, stamp)."""
    gaps, factors, errors = 0, [], []
    for blocks in streams:
        arrival, stamps = (np.array(column) for column in zip(*blocks, strict=True))
        steps = np.diff(stamps)
        usual = np.median(steps)
        gaps += int(((np.abs(steps - usual) > 2) & (steps > 0)).sum())  # back: a log played again
        factors.append(float((stamps[-1] - stamps[0]) / 1e9 / (arrival[-1] - arrival[0])))
        # While listener and publisher get to know each other, blocks come in a burst.
        errors.append(np.abs(np.diff(arrival[50:]) - usual / 1e9))
    error = np.concatenate(errors) if errors else np.zeros(1)
    return {
        'streams': len(streams),
        'blocks': sum(len(blocks) for blocks in streams),
        'gaps': gaps,
        'factor': min(factors, default=0.0),
        'blocks_per_s': sum(len(each) / (each[-1][0] - each[0][0]) for each in streams),
        'spacing_p50_ms': float(np.quantile(error, 0.5)) * 1e3,
        'spacing_p99_ms': float(np.quantile(error, 0.99)) * 1e3,
    }


def holds(found: dict[str, Any], streams: int) -> bool:
    """Tell whether all streams were heard, without a gap and in time."""
    return found['streams'] == streams and not found['gaps'] and found['factor'] > KEEPS_UP


def cpu_seconds(running: subprocess.Popen[str]) -> float:
    """Return the CPU time that a process has used."""
    fields = Path(f'/proc/{running.pid}/stat').read_text().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def cpu_share(running: subprocess.Popen[str], seconds: float) -> float:
    """Return the share of one core that a process takes."""
    before, begin = cpu_seconds(running), time.monotonic()
    time.sleep(seconds)
    return (cpu_seconds(running) - before) / (time.monotonic() - begin)


def cpu(seconds: float) -> None:
    """Print the CPU share of sim and analyzer at the defaults."""
    with sim() as running, tempfile.TemporaryDirectory() as folder:
        with listener('samples', 1.0) as first:
            report(first)
        print(f'sim, nobody listens: {cpu_share(running, seconds):.1%} of a core')
        with listener('samples', 1e9):
            time.sleep(2)
            print(f'sim, one listener to samples: {cpu_share(running, seconds):.1%}')
            with listener('monitor', 1e9):
                time.sleep(2)
                print(f'sim, and all monitor topics: {cpu_share(running, seconds):.1%}')
        parameters = {'log_directory': folder, 'log_free_floor': 0.0}
        with process(['-m', 'gear_dynamics.nodes.analyzer'], parameters) as analyzer:
            time.sleep(15)
            print(f'sim, with an analyzer: {cpu_share(running, seconds):.1%}')
            print(f'analyzer, logging: {cpu_share(analyzer, seconds):.1%}')


def highest(candidates: Sequence[Any], held: Callable[[Any, float], bool], seconds: float) -> Any:
    """Return the last candidate that holds for so long: found by short runs, then tried in full."""
    below: list[Any] = []
    for candidate in candidates:
        if not held(candidate, PROBE):
            break
        below.append(candidate)
    while below and not held(below[-1], seconds):
        below.pop()
    return below[-1] if below else None


def rate(seconds: float) -> None:
    """Print the highest sample rate that is held, in steps of a quarter of an octave."""

    def held(anti_alias: str, candidate: int, duration: float) -> bool:
        parameters = {
            'sample_rate': float(candidate),
            'monitor_rate': 100.0,
            'block_size': round(candidate / 100),
            'anti_alias': anti_alias,
        }
        with sim('', parameters), listener('samples', duration) as ears:
            return tell(f'{candidate} samples/s', duration, report(ears), 1)

    candidates = [100 * round(RATE * 2 ** (quarter / 4) / 100) for quarter in range(8, 33)]
    for anti_alias in ('true', 'false'):
        found = highest(candidates, functools.partial(held, anti_alias), seconds)
        print(f'highest rate, anti_alias {anti_alias}: {found} samples/s for {seconds:g} s')


def rigs(seconds: float) -> None:
    """Print how many sims are held at once at the defaults."""

    def held(count: int, duration: float) -> bool:
        names = [f'rig{number}' for number in range(count)]
        with contextlib.ExitStack() as stack:
            for name in names:
                stack.enter_context(sim(name))
            found = report(stack.enter_context(listener('samples', duration, *names)))
        return tell(f'{count} rigs', duration, found, count)

    found = highest(range(1, 33), held, seconds)
    print(f'rigs at once on {os.cpu_count()} cores: {found} for {seconds:g} s')


def tell(what: str, seconds: float, found: dict[str, Any], streams: int) -> bool:
    """Print and return whether it holds."""
    if holds(found, streams):
        print(f'  {what}: held for {seconds:g} s', flush=True)
        return True
    print(f'  {what}: not held for {seconds:g} s: {found}', flush=True)
    return False


def start(seconds: float) -> None:
    """Print the time from process start to the first block, with cold and warm compile cache."""
    with tempfile.TemporaryDirectory() as cache:
        for kind in ('cold', 'warm', 'warm'):
            ears = subprocess.Popen(
                [sys.executable, __file__, '--listen', 'samples', '--seconds', '0.1'],
                cwd=ROOT,
                env={
                    **os.environ,
                    'ROS_DOMAIN_ID': DOMAIN,
                    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
                },
                stdout=subprocess.PIPE,
                text=True,
            )
            time.sleep(2)  # until it listens
            begin = time.monotonic()
            with sim(NUMBA_CACHE_DIR=cache):
                report(ears)
                # The listener waits 0.1 s after the first block.
                print(f'first block, {kind} cache: {time.monotonic() - begin - 0.1:.2f} s')
            ears.wait()


def replay(seconds: float) -> None:
    """Print how evenly a log is played at rate 1, and how fast at rate 0."""
    from gear_dynamics.bag.writer import LogWriter
    from gear_dynamics.wire.tables import SAMPLES_FLOAT32, TABLE_TYPE, encode_table

    with tempfile.TemporaryDirectory() as folder:
        writer = LogWriter(Path(folder), {}, free_floor=1.0)
        blocks = round(seconds * RATE / BLOCK)
        rows = np.zeros(BLOCK, SAMPLES_FLOAT32)
        for number in range(blocks):
            rows['mesh_force'] = np.random.default_rng(number).normal(size=BLOCK)
            at = 1_700_000_000 * 10**9 + number * 10_000_000
            data = encode_table(rows, at, 'line_of_action')
            writer.write('/gear_pair/samples', TABLE_TYPE, data, at, at)
            time.sleep(0.0002)
        path = writer.close().path
        module = ['-m', 'gear_dynamics.nodes.replay']
        with listener('samples', seconds - 2) as ears:
            time.sleep(2)
            with process(module, {'log': path}):
                found = report(ears)
        print(
            f'replay at rate 1: spacing error p50 {found["spacing_p50_ms"]:.2f} ms, '
            f'p99 {found["spacing_p99_ms"]:.2f} ms, {found["gaps"]} gaps'
        )
        with listener('samples', 3.0) as ears:
            time.sleep(2)
            with process(module, {'log': path, 'rate': 0, 'loop': 'true'}):
                found = report(ears)
        print(f'replay at rate 0: {found["blocks_per_s"]:.0f} blocks/s, {found["gaps"]} gaps')


PARTS = {'start': start, 'cpu': cpu, 'rate': rate, 'rigs': rigs, 'replay': replay}


def main() -> None:
    """Run the parts that were asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('names', nargs='*', metavar='PART', help=f'of {", ".join(PARTS)}')
    parser.add_argument('--seconds', type=float, default=10.0, help='length of each measurement')
    parser.add_argument('--listen', choices=('samples', 'monitor'), help=argparse.SUPPRESS)
    arguments, _ = parser.parse_known_args()
    if arguments.listen:
        listen(arguments.listen, arguments.seconds, arguments.names)
    for name in arguments.names or PARTS:
        PARTS[name](arguments.seconds)


if __name__ == '__main__':
    main()
