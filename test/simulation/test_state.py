"""A simulator's state can be taken, set and copied, to the last bit."""

import numpy as np
import pytest

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Ports, Table, ToothDeviation, smooth_pulse
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.simulation.batch import simulate_batch
from gear_dynamics.simulation.simulate import simulate
from gear_dynamics.simulation.simulator import Simulator

PORTS = Ports(
    [
        ToothDeviation('pinion', 2, [0.0, 0.01], stiffness=[[-0.2]], error=[[2e-6]]),
        Harmonic('transmission_error', 'gear', 1.0, 5e-6),
        Table('pinion_rest_y', 'pinion', [0.0, 0.02, 0.1], [smooth_pulse(1e-6), [0.0] * 7]),
    ]
)


def later(simulator):
    """Return what a simulator does next: samples and events."""
    samples = [simulator.advance(300)]
    simulator.command(speed=150.0)
    samples.append(simulator.advance(700))
    return np.concatenate(samples).tobytes(), simulator.take_events().tobytes()


@pytest.mark.parametrize('anti_alias', [False, True])
def test_a_state_brings_back_what_follows(anti_alias):
    simulator = Simulator(GearPair(), ports=PORTS, speed=335.0, anti_alias=anti_alias)
    simulator.advance(500)
    simulator.change(ports=PORTS.scaled(0.5), ramp=0.02)
    simulator.advance(500)
    state, twin = simulator.state(), simulator.copy()
    expected = later(simulator)
    assert later(twin) == expected
    simulator.set_state(state)
    assert later(simulator) == expected
    other = Simulator(GearPair(), anti_alias=anti_alias)
    other.advance(10)
    other.set_state(state)
    assert other.ports == PORTS.scaled(0.5)
    assert later(other) == expected


def test_a_state_of_other_samples_is_refused():
    state = Simulator(GearPair(), sample_rate=25600.0).state()
    with pytest.raises(ParameterError, match='sample_rate is 51200'):
        Simulator(GearPair()).set_state(state)
    with pytest.raises(ParameterError, match='anti_alias is False'):
        Simulator(GearPair(), sample_rate=25600.0, anti_alias=False).set_state(state)


def test_what_is_no_state_is_refused_by_name():
    with pytest.raises(ParameterError, match=r'^state is 3: it must be the final_state of a run'):
        Simulator(GearPair()).set_state(3)
    with pytest.raises(ParameterError, match=r'^initial_state is '):
        simulate(GearPair(), duration=0.01, initial_state={})


def test_coordinates_can_be_set_at_the_start_alone():
    simulator = Simulator(GearPair(), anti_alias=False)
    y = simulator.state().coordinates()
    moved = y * 1.01
    simulator.set_state(simulator.state().at(moved))
    np.testing.assert_allclose(simulator.state().coordinates(), moved, rtol=1e-12, atol=1e-20)
    simulator.advance(10)
    with pytest.raises(ParameterError, match='start'):
        simulator.state().at(y)


def test_pairs_of_a_batch_differ_in_their_ports():
    ports = [Ports(), PORTS, PORTS.scaled(0.3)]
    rows = simulate_batch([GearPair()] * 3, duration=0.02, anti_alias=False, ports=ports)
    for row, one in zip(rows, ports, strict=True):
        alone = Simulator(GearPair(), ports=one, anti_alias=False).advance(len(row))
        assert row.tobytes() == alone.tobytes()
    with pytest.raises(ParameterError, match='ports has 2 values: give one, or 3'):
        simulate_batch([GearPair()] * 3, duration=0.02, ports=ports[:2])
