"""Speed of the integrator: against real time, its own floor, and general-purpose solvers.

Run `python benchmarks/integrator.py`. Errors are of all accelerations and forces, RMS over the run
relative to the RMS of the response, against the same integrator at rtol 1e-13.
"""

from __future__ import annotations

import argparse
import dataclasses
import resource
import time
from collections.abc import Callable

import numpy as np
from equations import right_hand_side, runge_kutta_4
from scipy.integrate import solve_ivp

from gear_dynamics.model.columns import CHANNELS
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.simulator import Simulator, simulate

RATE = 51200.0
SPEED, LOAD = 104.72, 150.0
EXACT = {'rtol': 1e-13, 'atol': 1e-15}


def model_seconds_cost(blocks: int = 50, runs: int = 15, seconds: float = 1.0, **run) -> float:
    """Return the processor seconds per model second.

    The run is cut into blocks and repeated; each block counts with its quickest time, so that other
    work on the machine disturbs it least.
    """
    pair = run.pop('pair', GearPair())
    size = round(seconds * run.get('sample_rate', RATE) / blocks)
    times = np.full((runs, blocks), np.inf)
    for row in times:
        simulator = Simulator(pair, **run)
        for i in range(blocks):
            begin = time.perf_counter()
            simulator.advance(size)
            row[i] = time.perf_counter() - begin
    return float(times.min(0).sum()) / seconds


def relative_error(found: np.ndarray, exact: np.ndarray) -> float:
    """Return the worst channel's RMS error relative to its RMS."""
    return max(
        float(np.sqrt(np.mean((found[name] - exact[name]) ** 2) / np.mean(exact[name] ** 2)))
        for name in CHANNELS
    )


def real_time() -> None:
    print('Real-time factor at defaults, 51 200 samples/s, one core')
    exact = simulate(GearPair(), 1.0, **EXACT)
    for rtol in (1e-5, 1e-6, 1e-7, 1e-8):
        error = relative_error(simulate(GearPair(), 1.0, rtol=rtol), exact)
        raw = model_seconds_cost(rtol=rtol, anti_alias=False)
        banded = model_seconds_cost(rtol=rtol)
        print(
            f'  rtol {rtol:.0e}: error {error:.1e}, raw {1 / raw:.0f} x, '
            f'anti_alias {1 / banded:.0f} x'
        )


def floor() -> None:
    print('What it is made of, raw, rtol 1e-6')
    simulator = Simulator(GearPair(), anti_alias=False)
    simulator.advance(51200)
    steps = int(simulator.counters['steps'])
    few = model_seconds_cost(sample_rate=100.0, anti_alias=False)
    many = model_seconds_cost(anti_alias=False)
    per_step, per_sample = few / steps, (many - few) / (RATE - 100)
    print(f'  {steps} steps per model second at {per_step * 1e6:.2f} us: {1 / few:.0f} x')
    print(f'  and {per_sample * 1e9:.0f} ns per sample: {1 / many:.0f} x in all')


def against(name: str, solve: Callable[[float], np.ndarray], settings: list[float]) -> None:
    """Print cost and error of a solver at several settings, beside ours at that error."""
    for setting in settings:
        begin = time.perf_counter()
        states, duration = solve(setting)
        cost = (time.perf_counter() - begin) / duration
        exact = simulate(GearPair(), duration, **EXACT)
        count = len(states)
        delta = states @ DELTA_OF_STATE - ERROR_AT(np.arange(count) / RATE)
        error = float(
            np.sqrt(np.mean((delta - exact['delta'][:count]) ** 2)) / np.std(exact['delta'][:count])
        )
        ours, rtol = _ours_at(error)
        print(
            f'  {name} {setting:g}: error {error:.1e}, {1 / cost:.3g} x real time; '
            f'here {1 / ours:.0f} x at rtol {rtol:.0e}: {cost / ours:.0f} times as fast'
        )


DERIVED = GearPair().derived
DELTA_OF_STATE = np.zeros(13)
DELTA_OF_STATE[[3, 1, 4, 5]] = 1, -1, DERIVED.pinion_base_radius, -DERIVED.gear_base_radius


def ERROR_AT(t: np.ndarray) -> np.ndarray:
    return GearPair().transmission_error_amplitude * np.sin(GearPair().pinion_teeth * SPEED * t)


def _ours_at(error: float) -> tuple[float, float]:
    """Return our cost at the loosest tolerance that is at least as accurate."""
    exact = simulate(GearPair(), 0.1, **EXACT)
    for rtol in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11):
        found = simulate(GearPair(), 0.1, rtol=rtol)
        mine = float(np.std(found['delta'] - exact['delta']) / np.std(exact['delta']))
        if mine <= error:
            break
    return model_seconds_cost(rtol=rtol, anti_alias=False, runs=5), rtol


def solvers(duration: float) -> None:
    print(f'General-purpose solvers, the same equations compiled, over {duration} s')
    pair = GearPair()
    f = right_hand_side(pair, SPEED, LOAD)
    start = _start_state(pair)
    f(0.0, start)
    times = np.arange(round(duration * RATE)) / RATE

    def scipy_solver(method: str) -> Callable:
        def solve(rtol: float) -> tuple[np.ndarray, float]:
            found = solve_ivp(
                f, (0, times[-1]), start, method=method, t_eval=times, rtol=rtol, atol=rtol * 1e-6
            )
            return found.y.T, duration

        return solve

    def fixed(substeps: float) -> tuple[np.ndarray, float]:
        n = int(substeps)
        states = runge_kutta_4(f, start, 1 / (RATE * n), (len(times) - 1) * n, n)
        return np.vstack([start, states]), duration

    runge_kutta_4(f, start, 1e-6, 2, 1)
    against('SciPy RK45, rtol', scipy_solver('RK45'), [1e-6, 1e-8])
    against('SciPy DOP853, rtol', scipy_solver('DOP853'), [1e-6, 1e-8])
    against('fixed-step RK4, substeps', fixed, [8, 64])


def _start_state(pair: GearPair) -> np.ndarray:
    """Return the run's start in th1, th2 coordinates, read off the model's own start."""
    simulator = Simulator(pair, anti_alias=False, speed=SPEED, load_torque=LOAD)
    motion = simulator._motion.records[0]
    state, p = motion['state'], motion['constants']
    th = np.array([[p['th1_psi'], 1.0], [-p['th2_psi'], p['ratio']]])
    start = np.zeros(13)
    start[:4], start[6:10] = state[:4], state[6:10]
    start[4:6], start[10:12] = th @ state[4:6], th @ state[10:12]
    return start


def conditions() -> None:
    print('Milliseconds per model second, raw, 51 200 samples/s')
    base = GearPair()
    for speed in (52.36, 104.72, 209.44, 335.1, 837.76, 1047.2, 1570.8):
        for load in (30.0, 150.0):
            costs = []
            for mu in (0.0, 0.03):
                pair = dataclasses.replace(base, friction_coefficient=mu)
                run = {'pair': pair, 'speed': speed, 'load_torque': load, 'anti_alias': False}
                costs.append(1e3 * model_seconds_cost(runs=5, **run))
            print(
                f'  {speed:7.1f} rad/s {load:5.0f} N m: mu 0 {costs[0]:.1f}, mu 0.03 {costs[1]:.1f}'
            )


def memory(minutes: float) -> None:
    simulator = Simulator(GearPair())
    marks = []
    for _ in range(10):
        for _ in range(round(minutes * 60 * RATE / 10 / 5120)):
            simulator.advance(5120)
            simulator.take_events()
        marks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    print(f'Peak memory over {minutes:g} model minutes: {marks[0]:.1f} to {marks[-1]:.1f} MiB')


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--slice', type=float, default=0.1, help='model seconds for the solvers')
    parser.add_argument('--minutes', type=float, default=10.0, help='model minutes for the memory')
    arguments = parser.parse_args()
    real_time()
    floor()
    solvers(arguments.slice)
    conditions()
    memory(arguments.minutes)


if __name__ == '__main__':
    main()
