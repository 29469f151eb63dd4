"""Speed of the integrator: against real time, its own floor, and general-purpose solvers.

Run `python benchmarks/integrator.py`. An error is that of the worst column that vibrates, RMS over
the run relative to the column's RMS, against the same integrator at rtol 1e-13, and of the very run
whose speed stands beside it. Against other solvers, which give states alone, it is that of delta,
relative to its standard deviation. All times are those of the processor; against other solvers it
is the quickest of as many whole runs here as there.
"""

from __future__ import annotations

import argparse
import dataclasses
import itertools
import math
import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from equations import right_hand_side, runge_kutta_4
from scipy.integrate import solve_ivp

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.model import faults
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.run_settings import RunSettings
from gear_dynamics.simulation.simulate import simulate
from gear_dynamics.simulation.simulator import Simulator

RATE = 51200.0
SPEED, LOAD = 104.72, 150.0
RUNS_OF_SOLVERS = 4
EXACT = {'rtol': 1e-13, 'atol': 1e-15}
DEFAULT_RTOL = RunSettings().rtol


def model_seconds_cost(runs: int = 15, seconds: float = 1.0, **run) -> float:
    """Return the processor seconds per model second.

    The run is cut into blocks of 20 ms and repeated; each block counts with its quickest time, so
    that other work on the machine disturbs it least.
    """
    pair = run.pop('pair', GearPair())
    blocks = math.ceil(50 * seconds)
    size = round(seconds * run.get('sample_rate', RATE) / blocks)
    times = np.full((runs, blocks), np.inf)
    for row in times:
        simulator = Simulator(pair, **run)
        for i in range(blocks):
            begin = time.process_time()
            simulator.advance(size)
            row[i] = time.process_time() - begin
    return float(times.min(0).sum()) / seconds


def relative_error(found: np.ndarray, exact: np.ndarray) -> float:
    """Return the worst channel's RMS error relative to its RMS."""
    return max(
        float(np.sqrt(np.mean((found[name] - exact[name]) ** 2) / np.mean(exact[name] ** 2)))
        for name in CHANNELS
    )


def real_time() -> None:
    print('Real-time factor and error over 1 s, default pair, 51 200 samples/s, one core')
    for anti_alias in (False, True):
        name = 'anti_alias' if anti_alias else 'raw'
        exact = simulate(GearPair(), 1.0, anti_alias=anti_alias, **EXACT)
        for rtol in sorted({1e-5, 1e-6, 1e-7, 1e-8, DEFAULT_RTOL}, reverse=True):
            run = {'rtol': rtol, 'anti_alias': anti_alias}
            error = relative_error(simulate(GearPair(), 1.0, **run), exact)
            factor = 1 / model_seconds_cost(**run)
            default = ' (default)' if rtol == DEFAULT_RTOL else ''
            print(f'  {name}, rtol {rtol:.0e}{default}: error {error:.1e}, {factor:.0f} x')


def floor() -> None:
    print('What it is made of, raw, default rtol')
    simulator = Simulator(GearPair(), anti_alias=False)
    simulator.advance(51200)
    steps = int(simulator.counters['steps'])
    few = model_seconds_cost(sample_rate=100.0, anti_alias=False)
    many = model_seconds_cost(anti_alias=False)
    per_step, per_sample = few / steps, (many - few) / (RATE - 100)
    print(f'  {steps} steps per model second at {per_step * 1e6:.2f} us: {1 / few:.0f} x')
    print(f'  and {per_sample * 1e9:.0f} ns per sample: {1 / many:.0f} x in all')


def faulty() -> None:
    """Print what faults cost, each in turn with the healthy pair, so that other work hits both."""
    print('Raw, with a fault of severity 0.4: real-time factor over that of the healthy pair')
    for fault in (
        faults.RootCrack('pinion', tooth=5, severity=0.4),
        faults.Spall('gear', tooth=5, severity=0.4),
        faults.PitchErrors('gear', severity=0.4),
        faults.Eccentricity('gear', severity=0.4),
    ):
        pair = [Simulator(GearPair(), anti_alias=False, faults=each) for each in ((), (fault,))]
        ratios = []
        for _ in range(11):
            costs = []
            for simulator in pair:
                begin = time.process_time()
                simulator.advance(12800)
                costs.append(time.process_time() - begin)
                simulator.take_events()
            ratios.append(costs[0] / costs[1])
        print(f'  {fault.kind()}: {np.median(ratios):.2f}')


def quickest(run: Callable[[], np.ndarray]) -> tuple[float, np.ndarray]:
    """Return the least processor seconds of several whole runs, and what the last one gave."""
    costs = []
    for _ in range(RUNS_OF_SOLVERS):
        begin = time.process_time()
        found = run()
        costs.append(time.process_time() - begin)
    return min(costs), found


def against(
    name: str, solve: Callable[[float], np.ndarray], settings: list[float], duration: float
) -> None:
    """Print cost and error of a solver at several settings, beside ours at that error."""
    exact = simulate(GearPair(), duration, anti_alias=False, **EXACT)['delta']
    for setting in settings:
        cost, states = quickest(lambda setting=setting: solve(setting))
        error = _delta_error(_delta_of(states), exact)
        rtol, mine = _as_accurate(error, duration, exact)
        run = {'rtol': rtol, 'anti_alias': False}
        ours, _ = quickest(lambda run=run: simulate(GearPair(), duration, **run))
        print(
            f'  {name} {setting:g}: error {error:.1e}, {duration / cost:.3g} x real time; here at '
            f'rtol {rtol:.0e} error {mine:.1e}, {duration / ours:.0f} x: '
            f'{cost / ours:.0f} times as fast'
        )


def _delta_of(states: np.ndarray) -> np.ndarray:
    """Return delta at the sample times of states in th1, th2 coordinates."""
    pair, t = GearPair(), np.arange(len(states)) / RATE
    turned = pair.derived.pinion_base_radius * states[:, 4]
    turned -= pair.derived.gear_base_radius * states[:, 5]
    error = pair.transmission_error_amplitude * np.sin(pair.pinion_teeth * SPEED * t)
    return states[:, 3] - states[:, 1] + turned - error


def _delta_error(found: np.ndarray, exact: np.ndarray) -> float:
    return float(np.sqrt(np.mean((found - exact) ** 2)) / np.std(exact))


def _as_accurate(error: float, duration: float, exact: np.ndarray) -> tuple[float, float]:
    """Return our loosest tolerance with at most this error, in whole decades, and our error."""
    for decade in range(2, 14):
        rtol = 10.0**-decade
        mine = _delta_error(
            simulate(GearPair(), duration, rtol=rtol, anti_alias=False)['delta'], exact
        )
        if mine <= error:
            return rtol, mine
    raise RuntimeError(f'no tolerance gives an error of {error:.1e}')


def solvers(duration: float) -> None:
    print(f'General-purpose solvers, the same equations compiled, over {duration} s; all times are')
    print(f'the quickest of {RUNS_OF_SOLVERS} whole runs from the start state or the parameters on')
    pair = GearPair()
    f = right_hand_side(pair, SPEED, LOAD)
    start = _start_state(pair)
    f(0.0, start)
    times = np.arange(round(duration * RATE)) / RATE

    def scipy_solver(method: str) -> Callable:
        def solve(rtol: float) -> np.ndarray:
            found = solve_ivp(
                f, (0, times[-1]), start, method=method, t_eval=times, rtol=rtol, atol=rtol * 1e-6
            )
            return found.y.T

        return solve

    def fixed(substeps: float) -> np.ndarray:
        n = int(substeps)
        states = runge_kutta_4(f, start, 1 / (RATE * n), (len(times) - 1) * n, n)
        return np.vstack([start, states])

    runge_kutta_4(f, start, 1e-6, 2, 1)
    against('SciPy RK45, rtol', scipy_solver('RK45'), [1e-6, 1e-8], duration)
    against('SciPy DOP853, rtol', scipy_solver('DOP853'), [1e-6, 1e-8], duration)
    against('fixed-step RK4, substeps', fixed, [8, 64], duration)


def _start_state(pair: GearPair) -> np.ndarray:
    """Return the run's start in th1, th2 coordinates, read off the model's own start."""
    simulator = Simulator(pair, anti_alias=False, speed=SPEED, load_torque=LOAD)
    return simulator.state().coordinates()


def conditions() -> None:
    rtols = (1e-4, 1e-6, 1e-8, 1e-10)
    print('Milliseconds per model second, raw, 51 200 samples/s')
    print('  rad/s  N m    mu  ' + ''.join(f'{f"rtol {rtol:.0e}":>12}' for rtol in rtols))
    speeds = (52.36, 104.72, 209.44, 335.1, 837.76, 1047.2, 1570.8)
    for speed, load, mu in itertools.product(speeds, (30.0, 150.0), (0.0, 0.03)):
        pair = dataclasses.replace(GearPair(), friction_coefficient=mu)
        run = {'pair': pair, 'speed': speed, 'load_torque': load, 'anti_alias': False}
        costs = [1e3 * model_seconds_cost(runs=5, rtol=rtol, **run) for rtol in rtols]
        print(f'{speed:7.1f} {load:4.0f} {mu:5.2f}  ' + ''.join(f'{cost:12.1f}' for cost in costs))


def memory(minutes: float) -> None:
    simulator = Simulator(GearPair())
    marks = []
    for second in range(round(60 * minutes) + 1):
        if second % 60 == 1:
            marks.append(_resident())
        for _ in range(10):
            simulator.advance(5120)
            simulator.take_events()
    marks.append(_resident())
    print(
        f'Memory over {minutes:g} model minutes: {marks[0]:.2f} MiB after the first second, '
        f'{marks[-1]:.2f} at the end, {max(marks):.2f} at most'
    )


def _resident() -> float:
    """Return the memory of this process that is in use now [MiB]."""
    pages = int(Path('/proc/self/statm').read_text().split()[1])
    return pages * os.sysconf('SC_PAGE_SIZE') / 2**20


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--slice', type=float, default=0.1, help='model seconds for the solvers')
    parser.add_argument('--minutes', type=float, default=10.0, help='model minutes for the memory')
    arguments = parser.parse_args()
    real_time()
    floor()
    faulty()
    solvers(arguments.slice)
    conditions()
    memory(arguments.minutes)


if __name__ == '__main__':
    main()
