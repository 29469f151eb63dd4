"""The default pair's known behaviour, as seen with an independent event-exact code."""

import dataclasses

import numpy as np
import pytest

from gear_dynamics.machine.columns import EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

RPM = np.pi / 30
CYCLES = 25
PER_CYCLE = 100021 / CYCLES
"""Not whole, so that the samples over CYCLES cycles fall on 100021 mesh phases."""
SPEED = 104.72

# 104.72 rad/s, 150 N m, sampled finely: mean, root mean square variation, least and greatest
# mesh force [N], root mean square accelerations [m/s2].
FIGURES = {
    0.0: {'mean': 2705.5, 'variation': 743.8, 'least': 122.5, 'greatest': 6130.5,
          'pinion_ay': 815.6, 'gear_ay': 243.2, 'pinion_ax': 0.0},
    0.03: {'mean': 2710.6, 'variation': 725.5, 'least': 194.0, 'greatest': 5993.7,
           'pinion_ay': 793.9, 'gear_ay': 238.3, 'pinion_ax': 88.3},
}  # fmt: skip


def settled(pair, speed, cycles_before, cycles, **values):
    """Return samples over whole cycles of the settled motion, and the simulator."""
    rate = values.pop('per_cycle', PER_CYCLE) * pair.pinion_teeth * speed / (2 * np.pi)
    slow = Simulator(pair, speed=speed, sample_rate=rate, anti_alias=False, **values)
    slow.advance(round(cycles_before * rate * 2 * np.pi / (pair.pinion_teeth * speed)))
    slow.take_events()
    return slow.advance(round(cycles * rate * 2 * np.pi / (pair.pinion_teeth * speed))), slow


@pytest.mark.parametrize('mu', list(FIGURES))
def test_default_pair_shows_the_known_figures(mu):
    pair = dataclasses.replace(GearPair(), friction_coefficient=mu)
    samples, run = settled(pair, SPEED, 250, CYCLES)
    assert run.counters['contact_losses'] == 0
    force = samples['mesh_force']
    got = {
        'mean': force.mean(),
        'variation': force.std(),
        'least': force.min(),
        'greatest': force.max(),
    }
    for name in ('pinion_ax', 'pinion_ay', 'gear_ay'):
        got[name] = np.sqrt(np.mean(samples[name] ** 2))
    # Half of the last digit known, and as much for where the samples fall about the jumps.
    assert got == pytest.approx(FIGURES[mu], rel=0, abs=0.1)


def test_motion_at_1000_rpm_is_of_period_one():
    _, run = settled(dataclasses.replace(GearPair(), friction_coefficient=0.0), SPEED, 250, 20,
                     per_cycle=8)  # fmt: skip
    events = run.take_events()
    deltas = events['delta'][events['kind'] == EventKind.SECTION]
    assert len(deltas) >= 19
    np.testing.assert_allclose(deltas, deltas[0], rtol=1e-7)


@pytest.mark.parametrize(('rpm', 'lost'), [(1000, False), (2000, True), (3200, True), (8000, True)])
def test_contact_is_lost_at_the_known_speeds(rpm, lost):
    _, run = settled(GearPair(), rpm * RPM, 300, 40, per_cycle=8)
    events = run.take_events()
    assert np.any(events['kind'] == EventKind.DRIVE_LOST) == lost


@pytest.mark.parametrize(
    ('rpm', 'irregular'),
    [(1000, False), (8000, False), (5000, True), (5100, True), (5200, True), (9000, True),
     (9500, True)],
)  # fmt: skip
def test_motion_is_aperiodic_where_known(rpm, irregular):
    _, run = settled(GearPair(), rpm * RPM, 2000, 64, per_cycle=4)
    events = run.take_events()
    deltas = events['delta'][events['kind'] == EventKind.SECTION]
    # No short period: no lag up to 16 cycles repeats the section to a thousandth of its spread.
    spread = np.ptp(deltas)
    repeats = [np.max(np.abs(deltas[lag:] - deltas[:-lag])) for lag in range(1, 17)]
    if irregular:
        assert min(repeats) > 0.01 * spread
        assert spread > 1e-6
    else:
        assert repeats[0] < 1e-6 * 150e-6


@pytest.mark.parametrize('rpm', [1000, 3200])
def test_mean_mesh_force_carries_load_and_friction(rpm):
    # Over whole cycles of a periodic motion the gear's balance is rb2 F = T2 + Tf2; without
    # friction F = T2 / rb2 whatever the vibration.
    pair = dataclasses.replace(GearPair(), friction_coefficient=0.0)
    samples, _ = settled(pair, rpm * RPM, 600, 40, per_cycle=1000.025)
    expected = 150.0 / pair.derived.gear_base_radius
    assert samples['mesh_force'].mean() == pytest.approx(expected, rel=1e-3)
    assert np.all(samples['friction_force'] == 0)
    assert np.all(samples['pinion_ax'] == 0)
