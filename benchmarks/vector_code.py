"""What the vector code of the integrator gains: whole runs with each part of it in plain code.

Run `python benchmarks/vector_code.py [PART...]`. Vector code stays where plain loops make a whole
run of some kind slower by 15 % or more. Each part is compiled as plain loops in a process of its
own; the processes take turns with one that has all vector code. Printed are the median and the
quartiles of the ratio of processor times, above 1 where plain code is slower.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from gear_dynamics.integrator import lanes, polynomials
from gear_dynamics.integrator.layout import (
    AX1,
    DELTA,
    PADDED_TAPS,
    PSI,
    Q_SUM,
    ROWS,
    SUPPORTED,
    TAPS,
)
from gear_dynamics.kernels import kernel

PARTS = {
    'samples': (polynomials, ('fill_rates', 'fill_values')),
    'contact': (polynomials, ('sixteenths', 'delta_stays_above')),
    'end of step': (polynomials, ('advance_columns',)),
    'sections': (polynomials, ('columns_at',)),
    'filter': (lanes, ('weighted_rows', 'weighted_line')),
}
KINDS = {
    'raw': {'anti_alias': False},
    'band-limited': {},
    'raw, chaotic': {'anti_alias': False, 'speed': 5100 * np.pi / 30},
    'raw, steps alone': {'anti_alias': False, 'sample_rate': 100.0},
}
CYCLES = 'mesh cycles'
TURNS = 10


@kernel
def weighted_rows(weights, rows, first, out, row):
    for j in range(AX1, AX1 + 8):
        out[row, j] = 0.0
    for k in range(TAPS):
        for j in range(AX1, AX1 + 8):
            out[row, j] += weights[k] * rows[first + k, j]


@kernel
def weighted_line(weights, numbers, first):
    total = 0.0
    for k in range(PADDED_TAPS):
        total += weights[k] * numbers[first + k]
    return total


@kernel
def columns_at(series, t, out):
    for j in range(8):
        out[0, j], out[1, j] = series[ROWS - 1, j], 0.0
    for k in range(ROWS - 2, -1, -1):
        for j in range(8):
            out[1, j] = out[1, j] * t + out[0, j]
            out[0, j] = out[0, j] * t + series[k, j]


@kernel
def advance_columns(series, t, state):
    x1 = y1 = x2 = y2 = psi = q = q_sum = 0.0
    vx1 = vy1 = vx2 = vy2 = v_psi = v_q = 0.0
    for k in range(ROWS - 1, -1, -1):
        vx1, vy1, vx2 = vx1 * t + x1, vy1 * t + y1, vx2 * t + x2
        vy2, v_psi, v_q = vy2 * t + y2, v_psi * t + psi, v_q * t + q
        x1, y1, x2 = x1 * t + series[k, 0], y1 * t + series[k, 1], x2 * t + series[k, 2]
        y2, psi, q = y2 * t + series[k, 3], psi * t + series[k, 4], q * t + series[k, 5]
        q_sum = q_sum * t + series[k, Q_SUM]
    state[0], state[1], state[2], state[3], state[4], state[5] = x1, y1, x2, y2, psi, q
    state[6], state[7], state[8] = vx1, vy1, vx2
    state[9], state[10], state[11], state[12] = vy2, v_psi, v_q, q_sum


@kernel
def fill_rates(series, rates):
    for k in range(ROWS - 1):
        for j in range(SUPPORTED):
            rates[k, j] = (k + 1) * (k + 2) * series[k + 2, j] if k + 2 < ROWS else 0.0
        for j in range(SUPPORTED, 8):
            rates[k, j] = (k + 1) * series[k + 1, j]


@kernel
def fill_values(series, rates, times, values):
    for row in range(DELTA + 1 + 8 - PSI):
        for i in range(8):
            values[row, i] = 0.0
    for k in range(ROWS - 2, -1, -1):
        for row in range(DELTA + 1):
            for i in range(8):
                values[row, i] = values[row, i] * times[i] + rates[k, row]
    for k in range(ROWS - 1, -1, -1):
        for column in range(PSI, 8):
            row = DELTA + 1 + column - PSI
            for i in range(8):
                values[row, i] = values[row, i] * times[i] + series[k, column]


@kernel
def sixteenths(polynomials, row, h, out):
    for i in range(16):
        out[0, i], out[1, i] = polynomials[row, ROWS - 1], 0.0
    for k in range(ROWS - 2, -1, -1):
        term = polynomials[row, k]
        for i in range(16):
            t = h * ((i + 1) / 16)
            out[1, i] = out[1, i] * t + out[0, i]
            out[0, i] = out[0, i] * t + term


@kernel
def delta_stays_above(series, h, level):
    values, slopes = np.empty(16), np.zeros(16)
    for i in range(16):
        values[i] = series[ROWS - 1, DELTA]
    for k in range(ROWS - 2, -1, -1):
        term = series[k, DELTA]
        for i in range(16):
            t = h * ((i + 1) / 16)
            slopes[i] = slopes[i] * t + values[i]
            values[i] = values[i] * t + term
    before, slope_before = series[0, DELTA], series[1, DELTA]
    for i in range(16):
        value, slope = values[i], slopes[i]
        dip = (slope - slope_before) * h / 32 if slope_before < 0 < slope else 0.0
        if not min(before, value) - dip > level:
            return False
        before, slope_before = value, slope
    return True


def work(part: str) -> None:
    """Put plain code in the place of a part, then time each run that is asked for."""
    if part:
        module, names = PARTS[part]
        for name in names:
            setattr(module, name, globals()[name])
    # After the replacement.
    from gear_dynamics.dynamics.cycles import run_cycles
    from gear_dynamics.model.gear_pair import GearPair
    from gear_dynamics.simulation.simulator import Simulator

    for line in sys.stdin:
        kind = line.strip()
        begin = time.process_time()
        if kind == CYCLES:
            run_cycles([GearPair()], 104.72, 150.0, 1000, samples_per_cycle=64, with_bodies=True)
        else:
            simulator = Simulator(GearPair(), **KINDS[kind])
            for _ in range(60):
                simulator.advance(round(simulator.sample_rate / 10))
                simulator.take_events()
        print(time.process_time() - begin, flush=True)


def measured(worker: subprocess.Popen, kind: str) -> float:
    """Return the processor seconds that a worker's run takes."""
    assert worker.stdin is not None
    assert worker.stdout is not None
    worker.stdin.write(kind + '\n')
    worker.stdin.flush()
    return float(worker.stdout.readline())


def start(part: str, cache: str) -> subprocess.Popen:
    """Start a worker, with compiled kernels of its own."""
    root = Path(__file__).resolve().parents[1]
    return subprocess.Popen(
        [sys.executable, __file__, '--work', part],
        env={**os.environ, 'PYTHONPATH': str(root), 'NUMBA_CACHE_DIR': cache},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('parts', nargs='*', metavar='PART', help='all by default')
    parser.add_argument('--work', help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.work is not None:
        work(arguments.work)
        return
    with tempfile.TemporaryDirectory() as folder:
        for part in arguments.parts or PARTS:
            workers = [start(name, f'{folder}/{name}') for name in ('', part)]
            for kind in [*KINDS, CYCLES]:
                for worker in workers:
                    measured(worker, kind)  # compiles
                times = [[measured(worker, kind) for worker in workers] for _ in range(TURNS)]
                ratios = np.divide(*np.transpose(times)[::-1])
                low, middle, high = np.percentile(ratios, [25, 50, 75])
                print(f'{part}, {kind}: {middle:.3f}, quartiles {low:.3f} to {high:.3f}')
            for worker in workers:
                worker.communicate()


if __name__ == '__main__':
    main()
