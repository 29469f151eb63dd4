"""Compare two checkouts of the package: results of twelve operating points, and speed.

Run `python benchmarks/compare_commits.py OTHER_CHECKOUT [--speed]`. Each checkout runs in a process
of its own under this Python. Samples and events must be equal to the last bit; where they are not,
the largest difference relative to each column's root mean square is printed, and for chaotic
motions when they part. With --speed both run the default pair in turns, so that other work on the
machine disturbs both alike.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PAIRS = 15

WORKER = """
import sys, time
import numpy as np
from gear_dynamics import GearPair, Simulator

RPM = np.pi / 30
POINTS = {
    'default': {},
    'raw': dict(anti_alias=False),
    'mu 0': dict(pair=dict(friction_coefficient=0.0)),
    '3200 rpm': dict(speed=3200 * RPM),
    'constant stiffness': dict(pair=dict(mesh_stiffness='constant'), speed=2000 * RPM),
    'damping in gap': dict(pair=dict(damping_in_gap=True), speed=3200 * RPM),
    'back flank': dict(load_torque=-150.0),
    '20/75 teeth, 5120 Hz': dict(
        pair=dict(pinion_teeth=20, gear_teeth=75, module=0.003), load_torque=400.0,
        sample_rate=5120.0,
    ),
    'reduced form': dict(drive=False, anti_alias=False, speed=3200 * RPM),
    'commands': dict(commands=True, speed_rate_limit=500.0, torque_rate_limit=5000.0),
    'chaotic, 5100 rpm': dict(speed=5100 * RPM, anti_alias=False),
    'chaotic, 11616 rpm': dict(speed=11616 * RPM, pair=dict(half_backlash=20e-6)),
}

def results(pair=None, commands=False, **values):
    simulator = Simulator(GearPair(**(pair or {})), **values)
    samples, events = [], []
    for block in range(40):
        if commands and block in (10, 20):
            simulator.command(speed=125.0 - block, load_torque=100.0 + block)
        if commands and block == 30:
            simulator.change(pair=GearPair(friction_coefficient=0.05, half_backlash=1e-4))
        samples.append(simulator.advance(512))
        events.append(simulator.take_events())
    return np.concatenate(samples), np.concatenate(events)

def main():
    if sys.argv[1] != '--speed':
        found = {}
        for i, point in enumerate(POINTS.values()):
            found[f'samples{i}'], found[f'events{i}'] = results(**point)
        np.savez(sys.argv[1], names=np.array(list(POINTS)), **found)
        return
    Simulator(GearPair()).advance(5000)
    for line in sys.stdin:
        simulator = Simulator(GearPair(), anti_alias=line.strip() != 'raw')
        begin = time.process_time()
        for _ in range(20):
            simulator.advance(5120)
            simulator.take_events()
        print(time.process_time() - begin, flush=True)

main()
"""


def command(checkout: Path, argument: str) -> dict:
    """Return the arguments of a process that runs the worker on a checkout."""
    environment = {**os.environ, 'PYTHONPATH': str(checkout), 'PYTHONSAFEPATH': '1'}
    return {
        'args': [sys.executable, '-c', WORKER, argument],
        'env': environment,
        'cwd': checkout,
        'text': True,
    }


def relative_difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the largest difference of each row over the columns' root mean square."""
    worst = np.zeros(len(a))
    for name in a.dtype.names or ():
        x, y = a[name].astype(float), b[name].astype(float)
        scale = np.sqrt(np.mean(x**2)) or 1.0
        worst = np.maximum(worst, np.abs(x - y) / scale)
    return worst


def compare_results(other: Path) -> bool:
    """Print how the results differ; return whether all are equal to the last bit."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f'{side}.npz' for side in ('here', 'other')]
        for checkout, file in zip((ROOT, other), files, strict=True):
            subprocess.run(**command(checkout, str(file)), check=True)
        here, there = (dict(np.load(file)) for file in files)
    equal = True
    for i, name in enumerate(here['names']):
        texts = []
        for what in ('samples', 'events'):
            a, b = here[f'{what}{i}'], there[f'{what}{i}']
            if len(a) != len(b):
                texts.append(f'{len(a)} and {len(b)} {what}')
            elif a.tobytes() != b.tobytes():
                worst = relative_difference(a, b)
                far = np.flatnonzero(worst > 1e-12)
                since = f', beyond 1e-12 from row {far[0]} of {len(a)} on' if len(far) else ''
                texts.append(f'{what} differ by {worst.max():.1e}{since}')
        equal = equal and not texts
        print(f'  {name}: {"; ".join(texts) or "equal to the last bit"}')
    return equal


def compare_speed(other: Path) -> None:
    """Print the ratio of this checkout's real-time factor to the other's."""
    workers = [
        subprocess.Popen(
            **command(checkout, '--speed'), stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        for checkout in (ROOT, other)
    ]
    for kind in ('raw', 'band-limited'):
        times = np.zeros((PAIRS, 2))
        for row in times:
            for j, worker in enumerate(workers):
                assert worker.stdin is not None
                assert worker.stdout is not None
                worker.stdin.write(kind + '\n')
                worker.stdin.flush()
                row[j] = float(worker.stdout.readline())
        ratios = times[:, 1] / times[:, 0]
        low, middle, high = np.percentile(ratios, [25, 50, 75])
        print(
            f'  {kind}: {middle:.3f} times as fast as the other, quartiles {low:.3f} to {high:.3f}'
            f'; quickest runs {times[:, 1].min() / times[:, 0].min():.3f}'
        )
    for worker in workers:
        worker.communicate()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('other', type=Path, help='the other checkout')
    parser.add_argument('--speed', action='store_true', help='compare the speed as well')
    arguments = parser.parse_args()
    print(f'{ROOT} against {arguments.other}')
    equal = compare_results(arguments.other.resolve())
    if arguments.speed:
        compare_speed(arguments.other.resolve())
    raise SystemExit(not equal)


if __name__ == '__main__':
    main()
