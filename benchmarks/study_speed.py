"""Speed of the orbit diagram with exponents, against SciPy and pynamicalsys on slices of it.

Run `python benchmarks/study_speed.py`. The job is that of `study bifurcation`: 600 frequencies, two
friction coefficients, both directions, 300 mesh cycles before each record of 150 with all ten
exponents; what the study adds to that (motions followed for longer, a finer sweep of the onset of
chaos) is in the time, not in the count of cycles. The others are given the same equations compiled,
with their own error control and without events, and are measured over a few cycles at a few
frequencies; their estimate is that per cycle times the job's cycles, over as many cores.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numba
import numpy as np
from reduced_equations import jacobian, motion, motion_and_variations, numbers
from scipy.integrate import solve_ivp

from gear_dynamics import study
from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import OperatingPoint

FREQUENCIES, TRANSIENT, KEPT, CHAINS = 600, 300, 150, 4
RTOL, ATOL = 1e-9, 1e-12
SLICE = (0.5, 1.0, 1.5, 2.0)
SLICE_CYCLES = 10

REDUCED = [0, 1, 2, 3, 4, 6, 7, 8, 9, 10]
"""The reduced form's numbers among the integrator's states."""


def seconds(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def check() -> None:
    """Print how far the two forms of the equations are apart after two cycles."""
    operation = study.friction_chaos()
    pair, wn = operation.pair, operation.pair.derived.wn
    scale = pair.half_backlash * np.array([1.0] * 5 + [wn] * 5)
    states = scattered_states(operation, 2)[1:]
    start = states[0, REDUCED] / scale
    ours = run_cycles([pair], operation.speed, operation.load_torque, 2, states=states, rtol=1e-12)
    span = (0, 2 * operation.cycle)
    theirs = solve_ivp(
        motion, span, start, 'DOP853', args=(numbers(operation),), rtol=1e-12, atol=1e-13
    )
    apart = np.abs(ours.states[0, REDUCED] / scale - theirs.y[:, -1]).max()
    print(f'two forms of the equations after two cycles: {apart:.1e} b apart')


def slice_operations() -> list[OperatingPoint]:
    chaos = study.friction_chaos()
    return [
        chaos.with_value('friction_coefficient', mu).with_value('w', w)
        for mu in (0.0, 0.03)
        for w in SLICE
    ]


def scipy_per_cycle() -> tuple[float, float]:
    """Return seconds a cycle without and with variations, by DOP853."""

    def run(rates: Callable, size: int, cycles: int) -> None:
        for operation in slice_operations():
            start = np.zeros(size)
            start[4] = 1.02
            start[10:] = np.eye(10).ravel()[: size - 10]
            end, p = cycles * operation.cycle, numbers(operation)
            solve_ivp(rates, (0, end), start, 'DOP853', args=(p,), rtol=RTOL, atol=ATOL)

    run(motion, 10, 1)
    run(motion_and_variations, 110, 1)
    count = SLICE_CYCLES * len(slice_operations())
    return (
        seconds(lambda: run(motion, 10, SLICE_CYCLES)) / count,
        seconds(lambda: run(motion_and_variations, 110, SLICE_CYCLES)) / count,
    )


def pynamicalsys_per_cycle() -> tuple[float, float]:
    """Return seconds a cycle without and with exponents, by its adaptive Runge-Kutta 4(5)."""
    from pynamicalsys import ContinuousDynamicalSystem  # type: ignore[import-untyped]

    system = ContinuousDynamicalSystem(
        equations_of_motion=motion, jacobian=jacobian, system_dimension=10, number_of_parameters=20
    )
    system.integrator('rk45', atol=ATOL, rtol=RTOL)

    def run(work: str, cycles: int) -> None:
        for operation in slice_operations():
            start = np.zeros(10)
            start[4] = 1.02
            call = getattr(system, work)
            call(start, cycles * operation.cycle, parameters=numbers(operation))

    run('evolve_system', 1)
    run('lyapunov', 1)
    count = SLICE_CYCLES * len(slice_operations())
    return (
        seconds(lambda: run('evolve_system', SLICE_CYCLES)) / count,
        seconds(lambda: run('lyapunov', SLICE_CYCLES)) / count,
    )


def job(count: int) -> float:
    """Return the seconds of the orbit diagram with `count` frequencies, compiled before."""
    chaos = study.friction_chaos()
    study.bifurcation(chaos, count=2, transient=5, cycles=100)
    took = seconds(lambda: study.bifurcation(chaos, count=count, transient=TRANSIENT, cycles=KEPT))
    cycles = CHAINS * count * (TRANSIENT + KEPT)
    print(f'orbit diagram, {count} frequencies x 2 mu x 2 directions, on {numba.get_num_threads()}')
    print(f'  threads: {took:.1f} s, {cycles / took:.0f} mesh cycles per second')
    return took


def estimate(name: str, per_cycle: tuple[float, float], ours: float) -> None:
    plain, varied = per_cycle
    total = CHAINS * FREQUENCIES * (TRANSIENT * plain + KEPT * varied) / numba.get_num_threads()
    print(
        f'{name}: {plain * 1e3:.2f} ms a cycle, {varied * 1e3:.2f} ms with exponents: '
        f'{total / 60:.0f} min for the whole, {total / ours:.0f} times longer'
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--frequencies', type=int, default=FREQUENCIES)
    count = parser.parse_args().frequencies
    check()
    ours = job(count) * FREQUENCIES / count
    estimate('SciPy DOP853', scipy_per_cycle(), ours)
    try:
        estimate('pynamicalsys', pynamicalsys_per_cycle(), ours)
    except ModuleNotFoundError:
        print('pynamicalsys is not installed: pip install pynamicalsys')


if __name__ == '__main__':
    main()
