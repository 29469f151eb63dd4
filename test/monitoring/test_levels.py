"""Faults that belong to no tooth are named by their kind: wear, lubrication, load."""

import numpy as np
import pytest

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model import faults
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult
from gear_dynamics.monitoring.thresholds import AlarmRule, Limit, Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings, SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.simulator import Simulator

RATE, BLOCK = 51200.0, 512
SPAN = 0.2
LIMITS = {
    'mesh/wear': Limit(warn=2.0),
    'mesh/lubrication': Limit(warn=1.5),
    'mesh/load': Limit(warn=1.05, below_warn=0.95),
}


class Bench:
    """A simulated pair under a monitor, with 1 % of noise on every channel."""

    def __init__(self, rpm, load, seed):
        self.simulator = Simulator(GearPair(), speed=rpm * np.pi / 30, load_torque=load)
        self.simulator.advance(round(0.5 * RATE))
        self.rng = np.random.default_rng(seed)
        settings = AnalyzerSettings(statistics_duration=SPAN, learn_spans=3)
        self.monitor = Monitor(settings, Thresholds(LIMITS, rule=AlarmRule(0.1, 2, 3)))
        self.monitor.configure(Rig.from_text(configuration_text(GearPair(), SimSettings())))
        self.blocks = 0
        self.said_load = load

    def run(self, seconds):
        """The messages of the mesh, each change once."""
        found = []
        for _ in range(round(seconds * RATE / BLOCK)):
            rows = self.simulator.advance(BLOCK).copy()
            rows['t'] = np.arange(BLOCK) / RATE
            rows['load_torque'] = self.said_load
            for name in CHANNELS:
                level = np.sqrt(np.mean(rows[name] ** 2))
                rows[name] += 0.01 * level * self.rng.standard_normal(BLOCK)
            stamp = round(self.blocks * BLOCK / RATE * 1e9)
            self.blocks += 1
            for result in self.monitor.add_block(stamp, rows):
                if isinstance(result, ConditionResult):
                    found += [row.message for row in result.rows if row.subject == 'mesh']
        return found


@pytest.mark.parametrize(
    ('rpm', 'fault', 'words'),
    [
        (1000, None, ''),
        (4000, faults.Wear('gear', severity=0.2), 'mesh: all teeth alike: wear, '),
        (1000, faults.LubricationLoss(severity=0.3), 'mesh: everywhere: lubrication, '),
    ],
)
def test_the_kind_of_a_fault_of_all_teeth_is_named(rpm, fault, words):
    """10 um of wear; a friction coefficient of 0.075 in place of 0.03."""
    bench = Bench(rpm, 150.0, seed=1)
    before = bench.run(2.0)
    assert before.count('within its limits') >= 3
    assert not [text for text in before if text.startswith('mesh')]
    if fault is not None:
        bench.simulator.change(faults=[fault])
    after = bench.run(2.2)
    if fault is None:
        assert not [text for text in after if text.startswith('mesh')]
    else:
        assert after[-1].startswith(words)
        assert 'first seen' in after[-1]


def test_a_load_that_is_not_the_one_stated_is_named():
    bench = Bench(1000, 150.0, seed=2)
    bench.run(2.0)
    bench.simulator.command(load_torque=170.0)
    after = bench.run(2.2)
    assert after[-1].startswith('mesh: everywhere: load, ')
