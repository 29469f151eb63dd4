"""Search for a completion of the published study's table whose exponents are near the published.

The study of friction that docs/study.md is beside leaves out masses, inertias, load torque, support
damping and the phase of the transmission error. Differential evolution (Storn and Price 1997, by
SciPy) looks for them, within bounds that a pair of wheels can have: each draw is run at w = 1.222
and mu = 0, 0.03 and 0.05, and is told by how far its largest exponents are from the published ones,
and by whether it shows chaos, chaos and period-4. Short records show almost anything: the nearest
draws are verified, with a long transient, long records and several initial states.

Run `python tools/search_completion.py`. It repeats to the last bit, and a search that was
stopped goes on when it is run again.

The published study gives a damping ratio of the mesh of 0.03. The preset takes that for the mean
over the cycle, so that each tooth pair has 0.03 over the contact ratio; `--mesh-damping-ratio 0.03`
tries the other reading, 0.03 for each pair.
"""

import argparse
import math
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution
from tqdm import tqdm

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.dynamics.regimes import CHAOS
from gear_dynamics.study.assessment import assess
from gear_dynamics.study.experiments.lyapunov import lyapunov
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import (
    OperatingPoint,
    friction_chaos,
    unzip,
    with_frictions,
)
from gear_dynamics.study.outcome import Arrays
from gear_dynamics.study.published import SOURCE
from gear_dynamics.study.tasks import Runner

W = 1.222
SEQUENCE = [CHAOS, CHAOS, 'period-4']

BOUNDS = {
    'pinion_mass': (0.2, 2.0),
    'gear_mass': (0.3, 4.0),
    'pinion_gyration': (0.4, 0.95),
    'gear_gyration': (0.4, 0.95),
    'load_torque': (80.0, 1200.0),
    'support_damping_ratio': (0.02, 0.4),
    'transmission_error_phase': (-math.pi, math.pi),
}
"""Of each draw: radii of gyration are over the pitch radius."""

TRANSIENT, CYCLES = 1000, 400
VERIFIED = {'initial_states': 3, 'transient': 3000, 'cycles': 4000}
WRONG_KIND = 0.03
"""What a motion of another kind than published adds to the distance of a draw."""

AT_ONCE, SHOWN = 30, 3


def completion(preset: OperatingPoint, drawn: np.ndarray) -> OperatingPoint:
    """Return one completion; everything given by the published study is as it was."""
    values = dict(zip(BOUNDS, map(float, drawn), strict=True))
    for wheel in ('pinion', 'gear'):
        pitch_radius = preset.pair.module * getattr(preset.pair, f'{wheel}_teeth') / 2
        gyration = values.pop(f'{wheel}_gyration') * pitch_radius
        values[f'{wheel}_inertia'] = values[f'{wheel}_mass'] * gyration**2
    # Other masses make another wn: w is published, and the speed follows.
    for name, value in [*values.items(), ('w', W)]:
        preset = preset.with_value(name, value)
    return preset


def screen(points: list[OperatingPoint]) -> Arrays:
    """Return kinds and largest exponents of some motions from static deflection; a task."""
    states = np.concatenate([scattered_states(each, 1) for each in points])
    settled = run_cycles(*unzip(points), TRANSIENT, states=states).states
    assessed = assess(points, settled, CYCLES, k=1)
    return {'kind': assessed['kind'], 'largest': assessed['exponents'][:, 0]}


def distance(exponents: np.ndarray) -> np.ndarray:
    """Return how far largest exponents, (..., 3), are from the published ones, root mean square."""
    return np.sqrt(np.mean((np.asarray(exponents) - list(SOURCE.values())) ** 2, axis=-1))


def screened(drawn: list[OperatingPoint], runner: Runner) -> tuple[np.ndarray, np.ndarray]:
    """Return the distances of draws over short records, and which of them show the sequence."""
    arguments = [
        {
            'points': [
                each for one in drawn[i : i + AT_ONCE] for each in with_frictions(one, list(SOURCE))
            ]
        }
        for i in range(0, len(drawn), AT_ONCE)
    ]
    results = runner.run(screen, arguments)
    kinds, largest = (
        np.concatenate([result[name] for result in results]).reshape(-1, len(SOURCE))
        for name in ('kind', 'largest')
    )
    return distance(largest), kinds == np.array(SEQUENCE)


def search(
    preset: OperatingPoint, arguments: argparse.Namespace, runner: Runner
) -> list[OperatingPoint]:
    """Return the draws that show the sequence over a short record, the nearest first."""
    found: list[tuple[float, OperatingPoint]] = []

    def penalised(draws: np.ndarray) -> np.ndarray:
        drawn = [completion(preset, each) for each in draws.T]
        far, right = screened(drawn, runner)
        found.extend((far[i], drawn[i]) for i in np.flatnonzero(right.all(axis=1)))
        return far + WRONG_KIND * np.sum(~right, axis=1)

    with tqdm(total=arguments.generations, desc='searching', unit='generation') as bar:
        differential_evolution(
            penalised,
            list(BOUNDS.values()),
            popsize=arguments.members,
            maxiter=arguments.generations,
            tol=0,
            mutation=(0.4, 1.0),
            recombination=0.8,
            seed=arguments.seed,
            polish=False,
            updating='deferred',
            vectorized=True,
            callback=lambda *_, **__: bool(bar.update()) and False,
        )
    return [drawn for _, drawn in sorted(found, key=lambda each: each[0])]


def verify(drawn: OperatingPoint, runner: Runner) -> tuple[bool, float, str]:
    """Return whether the sequence of a completion holds, its distance and its text."""
    outcome = lyapunov(drawn, list(SOURCE), **VERIFIED, runner=runner)
    kinds = outcome.arrays['kind'].reshape(len(SOURCE), -1)
    largest = outcome.arrays['exponents'][:, 0].reshape(kinds.shape).mean(axis=1)
    holds = bool(np.all(kinds == np.array(SEQUENCE)[:, np.newaxis]))
    return holds, float(distance(largest)), f'{describe(drawn)}\n{outcome.text}'


def describe(drawn: OperatingPoint) -> str:
    """Return what was drawn, in a line."""
    names = ('pinion_mass', 'gear_mass', 'pinion_inertia', 'gear_inertia',
             'support_damping_ratio', 'transmission_error_phase')  # fmt: skip
    values = {name: getattr(drawn.pair, name) for name in names}
    values |= {'load_torque': drawn.load_torque, 'speed': drawn.speed}
    return ' '.join(f'{name}={value:.9g}' for name, value in values.items())


def main() -> None:
    """Search, verify and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or '').splitlines()[0])
    parser.add_argument('--generations', type=int, default=60, help='by default 60')
    parser.add_argument(
        '--members', type=int, default=30, help='of a generation, for each unknown; by default 30'
    )
    parser.add_argument(
        '--verified', type=int, default=60, help='at most this many draws; by default 60'
    )
    parser.add_argument('--seed', type=int, default=0, help='of the draws; by default 0')
    preset = friction_chaos()
    ratio = preset.pair.mesh_damping_ratio
    parser.add_argument(
        '--mesh-damping-ratio', type=float, default=ratio, help=f'of each pair; by default {ratio}'
    )
    arguments = parser.parse_args()
    for name in ('generations', 'members', 'verified'):
        if getattr(arguments, name) < 1:
            parser.error(f'--{name} is {getattr(arguments, name)}: it must be 1 or more')
    runner = Runner(Path('search_parts'))
    first = preset.with_value('mesh_damping_ratio', arguments.mesh_damping_ratio)
    found = search(first, arguments, runner)
    verified = [verify(each, runner) for each in tqdm(found[: arguments.verified], 'verifying')]
    held = sorted(each[1:] for each in verified if each[0])
    print(
        f'{len(found)} draws showed {", ".join(SEQUENCE)}; of the nearest {len(verified)} '
        f'{len(held)} hold'
    )
    for far, text in [*held[:SHOWN], verify(preset, runner)[1:]]:
        print(f'\n{far:.4f} away from the published exponents: {text}')
    runner.forget()


if __name__ == '__main__':
    main()
