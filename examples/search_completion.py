"""Search for a completion of the published study's table, nearer to its exponents than the preset.

The study of friction that docs/study.md is beside leaves out masses, inertias, load torque, support
damping and the phase of the transmission error. These are drawn about those of
config/friction_chaos.yaml at w = 1.222; each draw is run at mu = 0, 0.03 and 0.05. Draws that show
chaos, chaos and period-4 are verified: a long transient, long records, several initial states.
Those that hold are told by how far their largest exponents are from the published ones.

Run `python examples/search_completion.py`. It repeats to the last bit, and a search that was
stopped goes on when it is run again.

The published study gives a damping ratio of the mesh of 0.03. The preset takes that for the mean
over the cycle, so that each tooth pair has 0.03 over the contact ratio; `--mesh-damping-ratio 0.03`
tries the other reading, 0.03 for each pair.
"""

import argparse
import math
from pathlib import Path

import numpy as np
from tqdm import tqdm

from gear_dynamics import study
from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.judgement import judge, unzip
from gear_dynamics.study.kind import CHAOS
from gear_dynamics.study.lyapunov_table import SOURCE

W = 1.222
SCALED = ('pinion_mass', 'gear_mass', 'pinion_inertia', 'gear_inertia', 'load_torque',
          'support_damping_ratio')  # fmt: skip
SEQUENCE = [CHAOS, CHAOS, 'period-4']
SMALLEST, GREATEST = 0.03, 1.2
"""Spreads of the draws: each has its own, so that some are near the preset and some are far."""

TRANSIENT, CYCLES = 600, 400
VERIFIED = {'initial_states': 3, 'transient': 3000, 'cycles': 4000}
AT_ONCE, SHOWN = 20, 3


def draw(preset, seed):
    """Return one completion; everything given by the published study is as it was."""
    generator = np.random.default_rng(seed)
    spread = SMALLEST * (GREATEST / SMALLEST) ** generator.uniform()
    drawn = preset
    for name in SCALED:
        source = preset if name == 'load_torque' else preset.pair
        factor = math.exp(spread * generator.uniform(-1, 1))
        drawn = drawn.with_value(name, getattr(source, name) * factor)
    phase = min(spread, 1.0) * math.pi * generator.uniform(-1, 1)
    # Other masses make another wn: w is published, and the speed follows.
    return drawn.with_value('transmission_error_phase', phase).with_value('w', W)


def screen(operations):
    """Return the kinds of some motions from static deflection; a task."""
    states = np.concatenate([scattered_states(each, 1) for each in operations])
    settled = run_cycles(*unzip(operations), TRANSIENT, states=states).states
    judged = judge(operations, settled, CYCLES, k=1)
    return {'kind': judged['kind']}


def with_frictions(operation):
    """Return the operation with each published friction coefficient."""
    return [operation.with_value('friction_coefficient', mu) for mu in SOURCE]


def distance(exponents):
    """Return how far largest exponents are from the published ones, root mean square."""
    return float(np.sqrt(np.mean((np.asarray(exponents) - list(SOURCE.values())) ** 2)))


def search(draws, runner):
    """Return the draws that show the sequence over a short record."""
    arguments = [
        {'operations': [each for drawn in draws[i : i + AT_ONCE] for each in with_frictions(drawn)]}
        for i in range(0, len(draws), AT_ONCE)
    ]
    results = runner.run(screen, arguments, 'screening')
    kinds = np.concatenate([result['kind'] for result in results]).reshape(-1, len(SOURCE))
    return [drawn for drawn, kind in zip(draws, kinds, strict=True) if list(kind) == SEQUENCE]


def verify(drawn, runner):
    """Return distance and text of a completion; infinitely far if the sequence does not hold."""
    outcome = study.lyapunov(drawn, list(SOURCE), **VERIFIED, runner=runner)
    kinds = outcome.arrays['kind'].reshape(len(SOURCE), -1)
    largest = outcome.arrays['exponents'][:, 0].reshape(kinds.shape).mean(axis=1)
    holds = np.all(kinds == np.array(SEQUENCE)[:, np.newaxis])
    return distance(largest) if holds else math.inf, f'{describe(drawn)}\n{outcome.text}'


def describe(drawn):
    """Return what was drawn, in a line."""
    values = {name: getattr(drawn.pair, name) for name in SCALED if name != 'load_torque'}
    values |= {'load_torque': drawn.load_torque}
    values |= {'transmission_error_phase': drawn.pair.transmission_error_phase}
    return ' '.join(f'{name}={value:.6g}' for name, value in values.items())


def main():
    """Search, verify and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--draws', type=int, default=2100, help='by default 2100')
    preset = study.friction_chaos()
    ratio = preset.pair.mesh_damping_ratio
    parser.add_argument(
        '--mesh-damping-ratio', type=float, default=ratio, help=f'of each pair; by default {ratio}'
    )
    arguments = parser.parse_args()
    count = arguments.draws
    if count < 1:
        parser.error(f'--draws is {count}: it must be 1 or more')
    preset = preset.with_value('mesh_damping_ratio', arguments.mesh_damping_ratio)
    runner = study.Runner(Path('search_parts'), progress=True)
    found = search([draw(preset, seed) for seed in range(count)], runner)
    quiet = study.Runner(Path('search_parts'))
    verified = [verify(drawn, quiet) for drawn in tqdm(found, 'verifying')]
    held = sorted(each for each in verified if math.isfinite(each[0]))
    print(f'{len(found)} of {count} draws show {", ".join(SEQUENCE)}; {len(held)} hold')
    for far, text in [*held[:SHOWN], verify(preset, quiet)]:
        print(f'\n{far:.4f} away from the published exponents: {text}')
    for each in (runner, quiet):
        each.forget()


if __name__ == '__main__':
    main()
