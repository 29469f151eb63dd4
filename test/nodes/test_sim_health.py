import time
import types

import pytest

from gear_dynamics.nodes.pacing import SECOND, Schedule
from gear_dynamics.parameters.settings import SimSettings

RATE = 51200.0


def levels(monkeypatch, block_size, pace, seconds=20, factor=1.0):
    """Return the levels of reports once a second, while blocks take 1/pace of their time."""
    pytest.importorskip('rclpy', reason='rclpy is not installed')
    from gear_dynamics.nodes.sim_health import SimHealth

    now = 0
    monkeypatch.setattr(time, 'monotonic_ns', lambda: now)
    settings = SimSettings(block_size=block_size, real_time_factor=factor)
    simulator = types.SimpleNamespace(samples_done=0)
    schedule = Schedule(block_size / RATE * SECOND / factor)
    schedule.start(0)
    health = SimHealth(settings, simulator, schedule, lambda: 0)
    found, free = [], 0
    for now in range(0, seconds * SECOND, SECOND // 1000):
        if now >= free and schedule.due(now):
            free = now + schedule.interval_ns / pace
            simulator.samples_done += block_size
            schedule.done(now)
        if now % SECOND == 0 and now:
            found.append(health.tasks()['pace']().level.name)
    return found


@pytest.mark.parametrize('block_size', [512, 4096, 5120, 65536])
@pytest.mark.parametrize('factor', [0.5, 1.0, 2.0])
def test_whole_blocks_are_no_lack_of_pace(monkeypatch, block_size, factor):
    assert set(levels(monkeypatch, block_size, 10.0, factor=factor)) == {'OK'}


@pytest.mark.parametrize('block_size', [512, 4096])
def test_a_pace_of_nine_tenths_is_told(monkeypatch, block_size):
    assert levels(monkeypatch, block_size, 0.9)[1:].count('OK') == 0
