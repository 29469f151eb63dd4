import numpy as np
import pytest

from gear_dynamics.web.samples import SampleRing
from gear_dynamics.web.windows import begin_of_window, mesh_cycle

TEETH = 34
PERIOD = 1000.0
"""Samples in a revolution of the pinion."""


@pytest.fixture
def ring():
    turns = np.arange(5300) / PERIOD
    names = ('pinion_angle', 'gear_angle', 'mesh_force', 'friction_force')
    rows = np.zeros(len(turns), [(name, float) for name in names])
    rows['pinion_angle'] = 2 * np.pi * np.mod(turns, 1)
    rows['gear_angle'] = 2 * np.pi * np.mod(turns * TEETH / 59, 1)
    rows['mesh_force'] = np.sin(2 * np.pi * TEETH * turns)
    rows['friction_force'] = np.cos(2 * np.pi * TEETH * turns)
    ring = SampleRing(names, 6000)
    ring.add(rows)
    return ring


def test_a_window_begins_at_a_revolution(ring):
    before = begin_of_window(ring, 'pinion', 800, TEETH)
    angle = ring.last('pinion_angle', 800, before)
    assert angle[0] == pytest.approx(0.0, abs=2 * np.pi / PERIOD)
    assert before < 800 + PERIOD


def test_a_window_begins_at_a_revolution_of_the_gear(ring):
    before = begin_of_window(ring, 'gear', 800, TEETH)
    angle = ring.last('gear_angle', 800, before)
    assert angle[0] == pytest.approx(0.0, abs=2 * np.pi / PERIOD)


def test_a_window_begins_at_a_tooth(ring):
    before = begin_of_window(ring, 'tooth', 100, TEETH)
    cycles = ring.last('pinion_angle', 100, before)[0] * TEETH / (2 * np.pi)
    assert cycles % 1 == pytest.approx(0.0, abs=TEETH / PERIOD)
    assert before < PERIOD / TEETH + 1


@pytest.mark.parametrize('trigger', ['none', 'pinion'])
def test_a_window_longer_than_what_is_held_is_the_last_one(ring, trigger):
    assert begin_of_window(ring, trigger, 5300, TEETH) == 0


def test_the_forces_over_a_mesh_cycle_begin_at_its_phase_0(ring):
    force, friction = mesh_cycle(ring, ('mesh_force', 'friction_force'), TEETH, 16)
    phase = 2 * np.pi * np.arange(16) / 16
    # A sample is 1/29 of a cycle: the nearest one is off by half of that.
    bound = 2 * np.pi * TEETH / PERIOD / 2 * 1.1
    np.testing.assert_allclose(force, np.sin(phase), atol=bound)
    np.testing.assert_allclose(friction, np.cos(phase), atol=bound)
