"""Processor seconds of a first start, with no compiled kernels, and of the next one.

Run `python benchmarks/cold_start.py [OTHER_CHECKOUT] [--functions]`. Each start is a process of its
own that imports the package and simulates a hundredth of a second; checkouts take turns. With
--functions, what each function takes to compile without those that it calls.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TURNS = 3

WORKER = """
import sys, time
begin = time.process_time()
from gear_dynamics import GearPair, Simulator
imported = time.process_time()
def run():
    simulator = Simulator(GearPair())
    simulator.advance(512)
    simulator.take_events()
if sys.argv[1] == 'functions':
    from numba.core import event
    costs, open_ones = {}, []
    class Listener(event.Listener):
        def on_start(self, event):
            open_ones.append((time.process_time(), [0.0]))
        def on_end(self, event):
            begun, inner = open_ones.pop()
            took = time.process_time() - begun
            name = event.data['dispatcher'].py_func.__qualname__
            own, count = costs.get(name, (0.0, 0))
            costs[name] = own + took - inner[0], count + 1
            if open_ones:
                open_ones[-1][1][0] += took
    with event.install_listener('numba:compile', Listener()):
        run()
    for name, (own, count) in sorted(costs.items(), key=lambda item: -item[1][0])[:30]:
        print(f'{own:7.2f} s in {count} signatures: {name}')
else:
    run()
    print(imported - begin, time.process_time() - imported)
"""


def start(checkout: Path, cache: str, argument: str) -> str:
    """Run the worker in a process of its own; return what it prints."""
    environment = {**os.environ, 'PYTHONPATH': str(checkout), 'PYTHONSAFEPATH': '1'}
    environment['NUMBA_CACHE_DIR'] = cache
    command = [sys.executable, '-c', WORKER, argument]
    return subprocess.run(
        command, env=environment, cwd=checkout, stdout=subprocess.PIPE, text=True, check=True
    ).stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('other', type=Path, nargs='?', help='another checkout')
    parser.add_argument('--functions', action='store_true', help='the cost of each function')
    arguments = parser.parse_args()
    checkouts = [ROOT, *([arguments.other.resolve()] if arguments.other else [])]
    for _ in range(1 if arguments.functions else TURNS):
        for checkout in checkouts:
            with tempfile.TemporaryDirectory() as cache:
                if arguments.functions:
                    print(checkout, start(checkout, cache, 'functions'), sep='\n')
                    continue
                for which in ('first', 'next'):
                    imports, run = map(float, start(checkout, cache, which).split())
                    print(
                        f'{checkout}, {which} start: {imports + run:.1f} s of the processor, '
                        f'{imports:.1f} s of it imports'
                    )


if __name__ == '__main__':
    main()
