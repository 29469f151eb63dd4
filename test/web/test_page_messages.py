import json
import struct

import numpy as np
import pytest

from gear_dynamics.web.commands import Pause, Reset, SetFault, SetValue, UsePreset, read_command
from gear_dynamics.web.messages import (
    MessageRefusedError,
    binary_frame,
    json_text,
    read_message,
)
from gear_dynamics.web.presets import PRESETS
from gear_dynamics.web.view import View

KINDS = ('root_crack',)

HOSTILE = [
    '',
    'nonsense',
    '[]',
    '17',
    'null',
    '"text"',
    '[' * 8000,
    '{"a":' * 2000,
    '{"type": "view"}' + ' ' * 20_000,
    '{"value": NaN}',
    '{"value": Infinity}',
    '{"value": ' + '9' * 5000 + '}',
]


@pytest.mark.parametrize('text', HOSTILE)
def test_what_is_no_small_mapping_is_refused_in_one_line(text):
    with pytest.raises(MessageRefusedError) as refusal:
        read_message(text)
    assert '\n' not in str(refusal.value)
    assert len(str(refusal.value)) < 200


@pytest.mark.parametrize(
    ('content', 'command'),
    [
        ({'command': 'set', 'name': 'speed', 'value': 200}, SetValue('speed', 200.0)),
        ({'command': 'pause', 'held': True}, Pause(True)),
        ({'command': 'reset'}, Reset()),
        ({'command': 'preset', 'name': PRESETS[0].name}, UsePreset(PRESETS[0].name)),
        (
            {'command': 'fault', 'kind': 'root_crack', 'wheel': 'gear', 'tooth': 3, 'severity': 1},
            SetFault('root_crack', 1.0, 'gear', 3),
        ),
        (
            {'command': 'fault', 'kind': 'root_crack', 'wheel': 'gear', 'severity': 0.5},
            SetFault('root_crack', 0.5, 'gear', None),
        ),
    ],
)
def test_commands_are_read(content, command):
    assert read_command(content, KINDS) == command


@pytest.mark.parametrize(
    ('content', 'named'),
    [
        ({}, 'command'),
        ({'command': 'explode'}, 'explode'),
        ({'command': 'set', 'name': 'module', 'value': 1}, 'module'),
        ({'command': 'set', 'name': 'speed', 'value': 1e9}, 'speed'),
        ({'command': 'set', 'name': 'speed', 'value': 10**400}, 'speed'),
        ({'command': 'set', 'name': 'speed', 'value': True}, 'speed'),
        ({'command': 'set', 'name': 'speed', 'value': '1'}, 'speed'),
        ({'command': 'set', 'name': 'friction_coefficient', 'value': -0.1}, 'friction'),
        ({'command': 'pause', 'held': 1}, 'held'),
        ({'command': 'preset', 'name': 'none'}, 'none'),
        ({'command': 'fault', 'kind': 'gremlin', 'wheel': 'gear'}, 'gremlin'),
        ({'command': 'fault', 'kind': 'root_crack', 'wheel': 'third'}, 'third'),
        (
            {'command': 'fault', 'kind': 'root_crack', 'wheel': 'gear', 'severity': 1.5},
            'severity',
        ),
    ],
)
def test_a_wrong_command_is_refused_by_name(content, named):
    with pytest.raises(MessageRefusedError, match=named):
        read_command(content, KINDS)


def test_a_view_is_read():
    content = {'rig': 'a', 'channels': ['x'], 'window': 0.5, 'trigger': 'gear', 'pixels': 300}
    assert View.from_message(content) == View('a', ('x',), 0.5, 'gear', 300)


@pytest.mark.parametrize(
    'wrong',
    [
        {'channels': 'x'},
        {'channels': ['x'] * 7},
        {'channels': [1]},
        {'window': 100},
        {'trigger': 'sometimes'},
        {'pixels': 10**400},
        {'rig': 3},
    ],
)
def test_a_wrong_view_is_refused(wrong):
    content = {'rig': 'a', 'channels': ['x'], 'window': 0.5, 'trigger': 'gear', 'pixels': 300}
    with pytest.raises(MessageRefusedError, match=next(iter(wrong))):
        View.from_message({**content, **wrong})


def test_a_frame_holds_its_header_and_arrays():
    arrays = {'t': np.arange(3.0), 'a': np.array([1.5, np.nan], np.float64)}
    frame = binary_frame({'type': 'scope'}, arrays)
    (length,) = struct.unpack('<I', frame[:4])
    assert length % 4 == 0
    header = json.loads(frame[4 : 4 + length])
    assert header == {'type': 'scope', 'arrays': {'t': 3, 'a': 2}}
    numbers = np.frombuffer(frame[4 + length :], '<f4')
    np.testing.assert_array_equal(numbers, [0, 1, 2, 1.5, np.nan])


def test_numbers_that_are_not_finite_become_null():
    assert json_text({'a': [float('nan'), 1.0, {'b': float('inf')}]}) == (
        '{"a": [null, 1.0, {"b": null}]}'
    )
