"""Parameters: types, ranges, messages."""

import dataclasses
import math

import numpy as np
import pytest

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.parameter import Parameter, ParameterError, ParameterSet, parameter
from gear_dynamics.parameters.run_settings import RunSettings

LISTS = [GearPair, RunSettings]
NUMBERS = [
    (kind, about)
    for kind in LISTS
    for about in kind.parameters()
    if isinstance(about.default, int | float) and not isinstance(about.default, bool)
]
SWITCHES = [
    (kind, about)
    for kind in LISTS
    for about in kind.parameters()
    if isinstance(about.default, bool)
]


def named(case):
    return getattr(case, 'name', getattr(case, '__name__', None))


@pytest.mark.parametrize('kind', LISTS)
def test_every_parameter_says_what_it_is(kind):
    for about in kind.parameters():
        assert about.description, about.name
        assert not about.description.endswith('.'), about.name
        assert about.check(about.default) == about.default
        if isinstance(about.default, int | float) and not isinstance(about.default, bool):
            assert about.minimum is not None, about.name
            assert about.maximum is not None, about.name


@pytest.mark.parametrize(('kind', 'about'), NUMBERS, ids=named)
@pytest.mark.parametrize(
    'wrong', [math.nan, math.inf, -math.inf, 'fast', '', None, True, [1.0], 1j, '1e400'], ids=repr
)
def test_what_is_no_finite_number_is_refused(kind, about, wrong):
    with pytest.raises(ParameterError, match=about.name):
        kind(**{about.name: wrong})


@pytest.mark.parametrize(('kind', 'about'), NUMBERS, ids=named)
def test_ranges_are_inclusive_and_messages_name_value_and_range(kind, about):
    for edge, outside in ((about.minimum, -1), (about.maximum, 1)):
        assert about.check(edge) == edge
        beyond = (
            edge + outside
            if isinstance(about.default, int)
            else np.nextafter(edge, outside * math.inf)
        )
        with pytest.raises(ParameterError) as caught:
            kind(**{about.name: beyond})
        message = str(caught.value)
        assert '\n' not in message
        for part in (about.name, repr(beyond), f'{about.minimum:g}', f'{about.maximum:g}'):
            assert part in message
        if about.unit:
            assert about.unit in message


@pytest.mark.parametrize(
    ('value', 'number'), [('5.33e8', 5.33e8), (533000000, 5.33e8), (np.float64(5.33e8), 5.33e8)]
)
def test_a_number_may_come_as_text_or_integer(value, number):
    stiffness = GearPair(tooth_pair_stiffness=value).tooth_pair_stiffness
    assert stiffness == number
    assert type(stiffness) is float


@pytest.mark.parametrize('value', [34, 34.0, '34', np.int64(34)])
def test_an_integer_may_come_as_any_number_that_is_whole(value):
    teeth = GearPair(pinion_teeth=value).pinion_teeth
    assert teeth == 34
    assert type(teeth) is int


@pytest.mark.parametrize('value', [34.5, '34.5', 'thirty'])
def test_a_broken_tooth_count_is_refused(value):
    with pytest.raises(ParameterError, match=r'pinion_teeth is .* an integer from 4 to 1000'):
        GearPair(pinion_teeth=value)


@pytest.mark.parametrize(('kind', 'about'), SWITCHES, ids=named)
@pytest.mark.parametrize('wrong', [1, 0, 'true', None, 1.0])
def test_a_switch_takes_only_true_and_false(kind, about, wrong):
    with pytest.raises(ParameterError, match=f'{about.name} is .* true or false'):
        kind(**{about.name: wrong})


def test_a_choice_names_what_may_be_chosen():
    with pytest.raises(ParameterError, match="'sine': it must be 'rectangular' or 'constant'"):
        GearPair(mesh_stiffness='sine')


def test_a_pair_is_frozen_and_replaced():
    pair = GearPair()
    with pytest.raises(dataclasses.FrozenInstanceError):
        pair.module = 1.0
    smooth = dataclasses.replace(pair, friction_coefficient=0)
    assert smooth.friction_coefficient == 0.0
    assert pair.friction_coefficient == 0.03
    with pytest.raises(ParameterError, match='friction_coefficient'):
        dataclasses.replace(pair, friction_coefficient=-1)


def test_mapping_there_and_back():
    pair = GearPair(module='0.003', damping_in_gap=True)
    values = pair.to_mapping()
    assert list(values) == [about.name for about in GearPair.parameters()]
    assert GearPair.from_mapping({**values, 'block_size': 512}) == pair


def test_list_and_text_parameters():
    @dataclasses.dataclass(frozen=True)
    class Names(ParameterSet):
        names: list = parameter(['a'], 'some names')  # noqa: RUF009
        title: str = parameter('', 'any text')

    assert Names().names == ['a']
    assert Names().names is not Names().names
    assert Names(names=('b', 'c')).names == ['b', 'c']
    for wrong in ('b', [1], None):
        with pytest.raises(ParameterError, match=r'names is .* a list of texts'):
            Names(names=wrong)
    with pytest.raises(ParameterError, match='title is 3: it must be a text'):
        Names(title=3)


def test_the_limits_of_an_integer_are_written_whole():
    most = Parameter('n', 512, 'samples', minimum=64, maximum=1048576)
    assert most.allowed() == 'an integer from 64 to 1048576'
