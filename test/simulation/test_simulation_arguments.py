"""What a caller may get wrong: one clear line that names the value and the remedy."""

import numpy as np
import pytest

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.ports import Harmonic, Ports, ToothDeviation
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.simulation.batch import simulate_batch
from gear_dynamics.simulation.simulate import simulate
from gear_dynamics.simulation.simulator import Simulator


def run_alone(duration, **values):
    return simulate(GearPair(), duration, **values)


def run_together(duration, **values):
    return simulate_batch([GearPair()] * 2, duration=duration, **values)


def message_of(call, *arguments, **values):
    with pytest.raises(ParameterError) as caught:
        call(*arguments, **values)
    message = str(caught.value)
    assert '\n' not in message
    return message


@pytest.mark.parametrize('run', [run_alone, run_together])
@pytest.mark.parametrize(
    ('duration', 'remedy'),
    [
        ('x', 'a finite number from 0 to 1e+09 s'),
        (None, 'a finite number from 0 to 1e+09 s'),
        (np.nan, 'a finite number from 0 to 1e+09 s'),
        (np.inf, 'a finite number from 0 to 1e+09 s'),
        (-1, 'a finite number from 0 to 1e+09 s'),
        (1e12, 'a finite number from 0 to 1e+09 s'),
        (1e8, 'advance a Simulator block by block'),
        (1e-9, 'a sample or more, 1.95e-05 s'),
        (0.0, 'a sample or more, 1.95e-05 s'),
    ],
    ids=repr,
)
def test_a_duration_is_a_number_of_seconds_that_memory_holds(run, duration, remedy):
    message = message_of(run, duration)
    assert message.startswith(f'duration is {duration!r}: ')
    assert remedy in message


@pytest.mark.parametrize('run', [run_alone, run_together])
def test_a_sample_rate_is_looked_at_before_it_is_used(run):
    message = message_of(run, 0.1, sample_rate='fast')
    assert message.startswith("sample_rate is 'fast': it must be a finite number from 100")


def test_a_batch_needs_memory_for_all_its_runs():
    # Many times the memory of any machine, in runs that each are short.
    message = message_of(simulate_batch, [GearPair()] * 100, duration=1e7)
    assert '5.32e+06 GB' in message  # 100 x 1e7 s x 51 200 /s x 13 columns x 8 bytes


@pytest.mark.parametrize('wrong', ['pair', None, {}, GearPair], ids=repr)
def test_a_gear_pair_is_a_gear_pair(wrong):
    for call in (simulate, Simulator, lambda pair: simulate_batch([GearPair(), pair])):
        message = message_of(call, wrong)
        assert message == f'pair is {wrong!r}: it must be a GearPair, such as GearPair()'
    assert 'must be a GearPair' in message_of(Simulator(GearPair()).change, pair='pair')


def test_a_batch_is_a_list_of_gear_pairs():
    assert message_of(simulate_batch, GearPair()).endswith('it must be a list of GearPair')
    assert message_of(simulate_batch, []) == 'pairs is empty: give one gear pair or more'


@pytest.mark.parametrize('wrong', ['x', {}, [1.0, 'x'], [[1.0], [2.0, 3.0]]], ids=repr)
@pytest.mark.parametrize('name', ['speeds', 'load_torques'])
def test_commands_of_a_batch_are_numbers(name, wrong):
    message = message_of(simulate_batch, [GearPair()] * 2, **{name: wrong})
    assert message == f'{name} is {wrong!r}: give one number, or 2, one a gear pair'


def test_an_unknown_setting_is_refused_with_the_nearest_name():
    message = message_of(Simulator, GearPair(), sped=1)
    assert message == 'sped is not a parameter; the nearest name is speed'


@pytest.mark.parametrize('wrong', [-1, 1.5, 'x', None, 512.0], ids=repr)
def test_a_number_of_samples_is_whole(wrong):
    simulator = Simulator(GearPair(), anti_alias=False)
    message = message_of(simulator.advance, wrong)
    assert message == f'n is {wrong!r}: it must be a whole number of samples, 0 or more'
    # The run has not moved.
    assert simulator.advance(np.int64(1))['t'] == 0.0
    assert len(simulator.advance(0)) == 0


@pytest.mark.parametrize('ports', [[1], np.zeros(3), None])
def test_ports_must_be_ports(ports):
    with pytest.raises(ParameterError, match=r'ports is .*: it must be Ports'):
        Simulator(GearPair(), ports=ports)


def test_tooth_that_the_wheel_does_not_have_is_refused():
    ports = Ports([ToothDeviation('pinion', 34, [0.0, 0.01], stiffness=[[-0.1]])])
    with pytest.raises(ParameterError, match='tooth is 34: the pinion has teeth 0 to 33'):
        Simulator(GearPair(), ports=ports)


def test_backlash_that_could_close_is_refused():
    ports = Ports([Harmonic('half_backlash', 'pinion', 1.0, 160e-6)])
    with pytest.raises(ParameterError, match=r'half_backlash is 0\.00015 m'):
        Simulator(GearPair(), ports=ports)
