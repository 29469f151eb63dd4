"""What the shafts do: the gear's own speed, and the torque of the drive."""

import numpy as np
import pytest

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator


@pytest.mark.parametrize('anti_alias', [False, True])
def test_gear_speed_is_the_rate_of_the_gear_angle(anti_alias):
    rate = 1e6
    simulator = Simulator(GearPair(), sample_rate=rate, anti_alias=anti_alias)
    simulator.advance(1000)
    angle = np.unwrap(simulator.advance(5000)['gear_angle'])
    speed = simulator.shafts['gear_speed']
    # Over ten samples, by the trapezoidal rule: a kink of the speed then counts for little.
    turned = np.cumsum((speed[1:] + speed[:-1]) / 2) / rate
    got = (turned[10:] - turned[:-10]) * rate / 10
    expected = (angle[11:] - angle[1:-10]) * rate / 10
    np.testing.assert_allclose(got, expected, rtol=0, atol=2e-3 * np.std(speed))


def test_drive_torque_balances_the_load_and_turns_the_inertias():
    # Without friction q stays zero, and T1 = T2 z1/z2 + It Theta1''.
    pair = GearPair(friction_coefficient=0.0)
    derived = pair.derived
    inertia = derived.pinion_inertia + derived.gear_inertia * (34 / 59) ** 2
    simulator = Simulator(pair, speed_rate_limit=200.0)
    simulator.advance(512)
    steady = simulator.shafts['drive_torque']
    np.testing.assert_allclose(steady, 150 * 34 / 59, rtol=1e-12)
    simulator.command(speed=150.0)
    simulator.advance(1024)
    ramp = simulator.shafts['drive_torque'][100:]
    np.testing.assert_allclose(ramp, 150 * 34 / 59 + 200 * inertia, rtol=1e-12)


def test_drive_torque_with_friction_makes_up_the_mean_loss():
    # Newton: the mean of T1 is rb1 F - Tf1, where Tf1 = (rb1 + rb2) tan a Ff - Tf2 and the gear's
    # own balance gives Tf2 = rb2 F - T2.
    pair = GearPair(friction_coefficient=0.1)
    derived = pair.derived
    simulator = Simulator(pair, anti_alias=False)
    simulator.advance(12 * 51200)
    samples = simulator.advance(4 * 51200)
    rb1, rb2 = derived.pinion_base_radius, derived.gear_base_radius
    force, friction = samples['mesh_force'].mean(), samples['friction_force'].mean()
    arms = (rb1 + rb2) * np.tan(np.radians(20.0))
    expected = (rb1 + rb2) * force - arms * friction - 150.0
    loss = expected - 150.0 * 34 / 59
    assert loss > 0.1
    assert simulator.shafts['drive_torque'].mean() - expected == pytest.approx(0, abs=0.02 * loss)
