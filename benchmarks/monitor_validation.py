"""Check that the monitor is silent on a healthy rig and names the fault of a faulty one.

    python benchmarks/monitor_validation.py [--minutes 60] [--seed 1] [--noise 0.01] [--fault NAME]
        [--pair config/quiet.yaml] [--bins 3]

The pair runs through a random walk of speed (300 to 6000 rpm) and load (20 to 400 N m), with dwell
times of 10 to 40 s between commands, lost blocks, pauses and resets, and white noise on every
channel (a fraction of its RMS, block by block). With --bins it goes to and fro between so many
places, so that what is normal there is learned. Printed are the alarms, the faults named, the share
of the truly steady time that was judged, and the bound on the rate of false alarms.

A fault is one of gd.faults:

    --fault RootCrack:pinion:17:0.33        a crack at tooth 17 of the pinion
    --fault Eccentricity:gear::0.1          the gear, whole
    --fault LubricationLoss:::0.3 --begin 10    from the tenth minute on
"""

from __future__ import annotations

import argparse
import collections
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model import faults
from gear_dynamics.model.faults import Fault
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings, SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.simulator import Simulator

ROOT = Path(__file__).resolve().parents[1]
RATE, BLOCK = 51200.0, 512
SECONDS = BLOCK / RATE
LOST, PAUSED, RESET = 1 / 3000, 1 / 12000, 1 / 12000
"""Chances a block: once in half a minute, and once in two minutes."""

Block = tuple[int, np.ndarray, np.ndarray, bool]


def walk(
    simulator: Simulator, minutes: float, noise: float, rng: np.random.Generator, bins: int = 0
) -> Iterator[Block]:
    """Yield stamp, samples, events of each block, and whether operation is truly steady."""
    places = [_place(rng) for _ in range(bins)]
    wait = settled = 0.0
    stamp, start = 0, 0.0
    for index in range(round(minutes * 60 / SECONDS)):
        if wait <= 0:
            rpm, load = places[rng.integers(bins)] if bins else _place(rng)
            # Long enough for the ramps of the command, which are limited, and for settling.
            old = simulator.settings
            ramp = max(abs(rpm * np.pi / 30 - old.speed) / 200, abs(load - old.load_torque) / 1000)
            simulator.command(speed=rpm * np.pi / 30, load_torque=load)
            wait, settled = float(rng.uniform(10, 40)) + ramp, -ramp - 0.5
        chance = rng.uniform()
        if index and chance < RESET:
            simulator.reset()
            simulator.take_events()
            start, settled, stamp = 0.0, -0.5, stamp + 10**9
        elif chance < RESET + PAUSED:
            stamp += 5 * 10**9
        rows = simulator.advance(BLOCK).copy()
        events = simulator.take_events()
        events['t'] -= start
        rows['t'] = np.arange(BLOCK) / RATE
        for name in CHANNELS:
            level = np.sqrt(np.mean(rows[name] ** 2))
            rows[name] += noise * level * rng.standard_normal(BLOCK)
        if chance < 1 - LOST:
            yield stamp, rows, events, settled >= 0
        wait, settled = wait - SECONDS, settled + SECONDS
        stamp, start = stamp + round(SECONDS * 1e9), start + SECONDS


def _place(rng: np.random.Generator) -> tuple[float, float]:
    return float(np.exp(rng.uniform(np.log(300), np.log(6000)))), float(rng.uniform(20, 400))


def faulty(text: str) -> list[Fault]:
    """Return the fault KIND:WHEEL:TOOTH:SEVERITY; the tooth is empty where there is none."""
    if not text:
        return []
    kind, wheel, tooth, severity = text.split(':')
    values: dict[str, object] = {'severity': float(severity)}
    if wheel:
        values['wheel'] = wheel
    if tooth:
        values['tooth'] = int(tooth)
    fault: Fault = getattr(faults, kind)(**values)
    return [fault]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--minutes', type=float, default=60.0)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--noise', type=float, default=0.01)
    parser.add_argument('--fault', default='', help='KIND:WHEEL:TOOTH:SEVERITY')
    parser.add_argument('--pair', default='', help='parameter file of the pair')
    parser.add_argument('--bins', type=int, default=0)
    parser.add_argument('--begin', type=float, default=0.0, help='minutes after which it begins')
    options = parser.parse_args()
    pair = GearPair.from_yaml(options.pair) if options.pair else GearPair()
    rng = np.random.default_rng(options.seed)
    fault = faulty(options.fault)
    simulator = Simulator(pair, sample_rate=RATE, faults=[] if options.begin else fault)
    thresholds = Thresholds.from_yaml(ROOT / 'config' / 'thresholds.yaml')
    monitor = Monitor(AnalyzerSettings(), thresholds)
    monitor.configure(Rig.from_text(configuration_text(pair, SimSettings())))
    raised: collections.Counter[str] = collections.Counter()
    named: collections.Counter[str] = collections.Counter()
    averages: collections.Counter[str] = collections.Counter()
    steady = told = 0.0
    first_named = None
    begin = time.monotonic()
    for stamp, rows, events, truly in walk(
        simulator, options.minutes, options.noise, rng, options.bins
    ):
        if fault and not simulator.faults and monitor.health.seconds > 60 * options.begin:
            simulator.change(faults=fault)
        steady += SECONDS * truly
        if monitor.health.seconds >= told + 300:
            told += 300
            print(f'{told / 60:g} min: {dict(averages)}, raised {dict(raised)}', flush=True)
        results = monitor.add_block(stamp, rows) + monitor.add_events(stamp, events)
        for result in results:
            if not isinstance(result, ConditionResult):
                continue
            for row in result.rows:
                if 'not judged' in row.notes:
                    continue
                if row.subject in ('pinion', 'gear'):
                    averages[row.subject] += 1
                for text in row.message.split('; first seen')[:-1]:
                    named[text.rpartition('; ')[2].rpartition(',')[0]] += 1
                    first_named = monitor.health.seconds if first_named is None else first_named
        for change in monitor.take_changes():
            speed, load = simulator.settings.speed, simulator.settings.load_torque
            if change.after > change.before:
                raised[f'{change.subject}/{change.name}'] += 1
                where = f'({speed:.1f} rad/s, {load:.0f} N m)'
                print(f'{monitor.health.seconds:8.1f} s {change} {where}')
    hours = options.minutes / 60
    print(f'{options.minutes:g} min in {time.monotonic() - begin:.0f} s; noise {options.noise:g}')
    print(f'levels raised: {dict(raised)}')
    print(f'averages judged: {dict(averages)}; named: {dict(named)}; first at {first_named}')
    share = monitor.health.steady_seconds / max(steady, 1e-9)
    print(f'truly steady {steady:.0f} s, of which judged {share:.1%}')
    # No event in a time T bounds the rate of a Poisson process by 3.0 / T with 95 % confidence.
    if not raised:
        print(f'false alarms: fewer than {3000 / hours:.0f} per 1000 h (95 % confidence)')
    print(f'tasks failed: {dict(monitor.health.failed)}; dropped: {dict(monitor.health.dropped)}')


if __name__ == '__main__':
    main()
