"""The regime of motions of the pair in measurement noise, with the section from the samples."""

import numpy as np
import pytest

from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings, SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.simulator import Simulator

RATE, BLOCK = 51200.0, 512


@pytest.mark.parametrize(
    ('rpm', 'load', 'words'),
    [
        # From the exact states of 1024 cycles without noise: they recur to 1e-6 b, or never.
        (8000, 150.0, 'period-1'),
        (5500, 100.0, 'period-2'),
        (9500, 150.0, 'chaotic'),
    ],
)
def test_one_per_cent_of_noise_does_not_change_the_regime(rpm, load, words):
    simulator = Simulator(GearPair(), speed=rpm * np.pi / 30, load_torque=load)
    simulator.advance(round(2 * RATE))
    monitor = Monitor(AnalyzerSettings(), Thresholds({}))
    monitor.configure(Rig.from_text(configuration_text(GearPair(), SimSettings())))
    rng = np.random.default_rng(0)
    found = []
    for block in range(round(1.6 * RATE / BLOCK)):
        rows = simulator.advance(BLOCK).copy()
        rows['t'] = np.arange(BLOCK) / RATE
        for name in ('delta', 'delta_dot'):
            level = np.sqrt(np.mean(rows[name] ** 2))
            rows[name] += 0.01 * level * rng.standard_normal(BLOCK)
        for result in monitor.add_block(round(block * BLOCK / RATE * 1e9), rows):
            if isinstance(result, ConditionResult):
                found += [row.notes['regime'] for row in result.rows if row.subject == 'motion']
    assert found
    assert set(found) == {words}
