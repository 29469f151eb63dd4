import numpy as np
import pytest

from gear_dynamics.machine.columns import EVENTS, EventKind
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.contact_state import contact_state
from gear_dynamics.monitoring.poincare import (
    poincare_points,
    section_by_contact_loss,
    section_by_phase,
    section_from_events,
)
from gear_dynamics.signal.order_tracking import mesh_phase, pinion_inertia_share
from gear_dynamics.simulation.simulator import Simulator

RATE = 51200.0
T = np.arange(8192) / RATE
W = 2 * np.pi * 2400  # w h = 0.295


def test_interpolated_section_meets_its_stated_accuracy():
    phase = 566.7 * T + 0.123
    delta, delta_dot = np.sin(W * T), W * np.cos(W * T)
    section = section_by_phase(T, phase, delta, delta_dot, 0.5)
    exact = (section['cycle'] - 0.123) / 566.7
    np.testing.assert_array_equal(np.mod(section['cycle'], 1), 0.5)
    np.testing.assert_allclose(section['t'], exact, atol=1e-12)
    step = W / RATE
    np.testing.assert_allclose(section['delta'], np.sin(W * exact), atol=step**4 / 384)
    np.testing.assert_allclose(
        section['delta_dot'], W * np.cos(W * exact), atol=W * 3 * step**4 / 128
    )


def test_section_at_the_loss_of_contact():
    # 1 + 2 cos falls through 0.5 where cos is -1/4; there its rate is -2 w sqrt(15) / 4.
    w = 2 * np.pi * 500
    delta, delta_dot = 1 + 2 * np.cos(w * T), -2 * w * np.sin(w * T)
    section = section_by_contact_loss(T, 500 * T, delta, delta_dot, 0.5)
    assert len(section) == 80
    np.testing.assert_allclose(section['delta'], 0.5, atol=2e-3)
    np.testing.assert_allclose(section['delta_dot'], -w * np.sqrt(15) / 2, rtol=1e-3)
    np.testing.assert_allclose(np.mod(section['cycle'], 1), np.arccos(-0.25) / 2 / np.pi, atol=1e-3)


def test_section_of_events_takes_one_kind():
    events = np.zeros(4, EVENTS)
    events['kind'] = [EventKind.SECTION, EventKind.DRIVE_LOST, EventKind.SECTION, 2]
    events['delta'] = [3e-4, 1.5e-4, -1.5e-4, 0]
    events['delta_dot'] = [0.0, 1.0, 2.0, 3.0]
    events['cycle'] = [0.5, 0.6, 1.5, 1.7]
    points = poincare_points(section_from_events(events), 1.5e-4, 1e4)
    assert points.dtype.names == ('x', 'y', 'z', 'cycle')
    np.testing.assert_allclose(points['x'], [2, -1], rtol=1e-6)
    np.testing.assert_allclose(points['y'], [0, 2 / 1.5], rtol=1e-6)
    np.testing.assert_allclose(points['z'], 0)
    np.testing.assert_allclose(points['cycle'], [0.5, 1.5])
    events['cycle'] += 2**30  # three weeks of 567 mesh cycles a second
    points = poincare_points(section_from_events(events), 1.5e-4, 1e4)
    assert np.diff(points['cycle']) == [1.0]
    assert section_from_events(events, EventKind.DRIVE_LOST)['delta'] == [1.5e-4]


@pytest.mark.parametrize(
    ('amplitude', 'share', 'text'),
    [
        # delta = 1.5 + A cos over b = 1: out of contact for acos(0.5 / A) / pi of the time
        (0.4, 0.0, 'no impacts'),
        (1.0, 1 / 3, 'single-sided'),
        # and within the backlash where -1 <= 1.5 + 5 cos <= 1, that is -0.5 <= cos <= -0.1
        (5.0, (np.arccos(-0.5) - np.arccos(-0.1)) / np.pi, 'double-sided'),
    ],
)
def test_contact_of_a_sine(amplitude, share, text):
    t = np.arange(100_001) / 100_000
    found = contact_state(1.5 + amplitude * np.cos(2 * np.pi * 10 * t), 1.0)
    assert found.out_of_contact == pytest.approx(share, abs=1e-6)
    assert found.text.startswith(text)
    assert found.losses == (0 if amplitude < 0.5 else 10)
    assert found.back_impacts == (10 if amplitude > 2.5 else 0)


def test_interpolated_section_against_the_integrators_own_states():
    simulator = Simulator(
        GearPair(friction_coefficient=0.0),
        sample_rate=204800.0,
        speed=104.72,
        load_torque=150.0,
        anti_alias=False,
    )
    simulator.advance(51200)
    simulator.take_events()
    samples = simulator.advance(51200)
    events = simulator.take_events()
    exact = section_from_events(events)
    derived = simulator.pair.derived
    share = pinion_inertia_share(derived.pinion_inertia, derived.gear_inertia, 34, 59)
    phase = mesh_phase(samples['pinion_angle'], samples['gear_angle'], 34, 59, share)
    found = section_by_phase(samples['t'], phase, samples['delta'], samples['delta_dot'], 0.5)
    common = min(len(found), len(exact))
    assert common > 130
    offset = np.argmin(np.abs(found['t'] - exact['t'][5])) - 5
    one, other = exact[5 : common - 5], found[5 + offset : common - 5 + offset]
    # Without friction the drive does not twist, and the angles tell the phase of the mesh.
    np.testing.assert_allclose(other['t'], one['t'], atol=1e-9)
    np.testing.assert_allclose(other['delta'], one['delta'], atol=1e-3 * np.ptp(samples['delta']))
    np.testing.assert_allclose(
        other['delta_dot'], one['delta_dot'], atol=5e-3 * np.ptp(samples['delta_dot'])
    )
