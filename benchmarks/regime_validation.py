"""Compare the monitor's regime in words and its largest exponent with the truth, in noise.

    python benchmarks/regime_validation.py [--each 8] [--seed 1]

Random motions of the default pair, 1000 to 10 000 rpm and 50 to 300 N m, until there are so many of
period 1, of period n, and chaotic ones. The truth: the exact
section of 2048 mesh cycles in the streamed form (with the drive), after 6000 that are left out,
recurs within 1e-5 of its scatter, or does not and nearby motions of the reduced form part (tangent
vectors, 4000 cycles). The monitor gets the stream in the same state with white noise of 0, 0.1 and
1 % of the RMS of delta and delta_dot, and takes the section from the samples; without noise from
exact events as well. Printed are the motions on which the words differ, and how often the
interval of 95 % of the exponent holds the truth.
"""

from __future__ import annotations

import argparse
import collections
import time
from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.cycles import run_cycles
from gear_dynamics.dynamics.exponents import lyapunov_spectrum
from gear_dynamics.dynamics.regimes import recurrence_period
from gear_dynamics.dynamics.tangent import first_tangent_vectors
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings, SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.simulator import Simulator

RATE, BLOCK = 51200.0, 512
TRANSIENT, CYCLES, TANGENT = 6000, 2048, 4000
NOISES = (0.0, 0.001, 0.01)
QUANTILE = 1.96


class Truth(NamedTuple):
    """What a motion is: regime in words, and the largest exponent [1/s] with its error."""

    words: str
    exponent: float
    error: float


def truth(speed: float, load: float) -> Truth:
    pair = GearPair()
    arguments = [pair], speed, load
    transient = run_cycles(*arguments, TRANSIENT, drive=True)
    found = run_cycles(*arguments, CYCLES, drive=True, states=transient.states)
    section = found.sections[0, :, :2]
    period, _ = recurrence_period(section / section.std(axis=0), 1e-5, 64)
    # A period-1 section does not scatter: what is left is compared with half the backlash.
    if np.ptp(section[:, 0]) < 1e-6 * pair.half_backlash:
        period = 1
    reduced = run_cycles(*arguments, TRANSIENT)
    vectors = first_tangent_vectors(1, k=1, pair=pair)
    growth = run_cycles(*arguments, TANGENT, states=reduced.states, vectors=vectors).growth[0]
    spectrum = lyapunov_spectrum(growth, float(found.period[0]))
    exponent, error = float(spectrum.values[0]), float(spectrum.standard_errors[0])
    words = f'period-{period}' if period else 'chaotic' if exponent > 3 * error else 'torus'
    return Truth(words, exponent, error)


def seen(
    simulator: Simulator, noise: float, events: bool, seed: int
) -> tuple[str, float, float] | None:
    """Return what the monitor says of the first full record: words, exponent, its error."""
    monitor = Monitor(AnalyzerSettings(), Thresholds({}))
    monitor.configure(Rig.from_text(configuration_text(GearPair(), SimSettings())))
    rng = np.random.default_rng(seed)
    begin = simulator.samples_done / RATE
    for block in range(6000):
        rows = simulator.advance(BLOCK).copy()
        rows['t'] = np.arange(BLOCK) / RATE
        stamp = round(block * BLOCK / RATE * 1e9)
        for name in ('delta', 'delta_dot'):
            level = np.sqrt(np.mean(rows[name] ** 2))
            rows[name] += noise * level * rng.standard_normal(BLOCK)
        results = monitor.add_block(stamp, rows)
        happened = simulator.take_events()
        if events:
            happened['t'] -= begin + block * BLOCK / RATE
            results += monitor.add_events(stamp, happened)
        for result in results:
            if not isinstance(result, ConditionResult):
                continue
            for row in result.rows:
                if row.subject == 'motion':
                    values = row.values
                    nan = float('nan')
                    return (
                        row.notes['regime'],
                        values.get('lyapunov', nan),
                        values.get('lyapunov_uncertainty', nan),
                    )
    return None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--each', type=int, default=8)
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    agree: dict[str, int] = {}
    counted: dict[str, int] = {}
    kinds: collections.Counter[str] = collections.Counter()
    held = trials = 0
    begin = time.monotonic()
    motion = 0
    while any(kinds[kind] < options.each for kind in ('period-1', 'period-n', 'chaotic')):
        motion += 1
        # Below 4500 rpm nearly all motions are of period 1.
        lowest = 1000 if kinds['period-1'] < options.each else 4500
        rpm, load = rng.uniform(lowest, 10_000), rng.uniform(50, 300)
        speed = rpm * np.pi / 30
        true = truth(speed, load)
        kind = true.words if true.words in ('period-1', 'chaotic', 'torus') else 'period-n'
        if kinds[kind] >= options.each:
            continue
        kinds[kind] += 1
        simulator = Simulator(GearPair(), sample_rate=RATE, speed=speed, load_torque=load)
        simulator.advance(round(TRANSIENT * 2 * np.pi / 34 / speed * RATE))
        simulator.take_events()
        for name, noise, events in [
            ('events', 0.0, True),
            *((f'samples, {noise:.1%}', noise, False) for noise in NOISES),
        ]:
            found = seen(simulator.copy(), noise, events, options.seed + motion)
            assert found is not None
            words, exponent, error = found
            right = words == true.words
            counted[name] = counted.get(name, 0) + 1
            agree[name] = agree.get(name, 0) + right
            if not right:
                print(f'{rpm:6.0f} rpm {load:4.0f} N m, {name}: {words}, truth {true.words}')
            if true.words == 'chaotic' and exponent == exponent:
                trials += 1
                # The truth is known to its own error.
                held += abs(exponent - true.exponent) <= QUANTILE * np.hypot(error, true.error)
                print(
                    f'{rpm:6.0f} rpm {load:4.0f} N m, {name}: '
                    f'exponent {exponent:.1f} +- {error:.1f}, '
                    f'truth {true.exponent:.1f} +- {true.error:.1f} 1/s',
                    flush=True,
                )
    print(f'motions: {dict(kinds)} of {motion}; {time.monotonic() - begin:.0f} s')
    for name, count in counted.items():
        print(f'{name}: {agree[name]} of {count} agree')
    if trials:
        print(f'intervals of 95 %: {held} of {trials} hold the truth')


if __name__ == '__main__':
    main()
