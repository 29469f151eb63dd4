"""The bounded YAML reader: plain text as PyYAML reads it, and hostile text refused at once."""

import math

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from gear_dynamics.parameters import yaml_text
from gear_dynamics.parameters.yaml_text import YamlError, parse_yaml, read_yaml

PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


@settings(deadline=None, max_examples=200)
@given(PLAIN)
def test_what_safe_dump_writes_is_read_back(value):
    text = yaml.safe_dump(value)
    assert parse_yaml(text) == yaml.safe_load(text)


@settings(deadline=None, max_examples=300)
@given(st.text('{}[]&*<:-!?|>\'"%@` \n\tab01.e_#,', max_size=60))
def test_any_text_is_read_as_pyyaml_does_or_refused_in_one_line(text):
    try:
        value = parse_yaml(text)
    except YamlError as error:
        reason = str(error)
    else:
        reason = ''
        assert repr(value) == repr(yaml.load(text, yaml_text._Loader))
    assert '\n' not in reason
    assert len(reason) < 300


def test_aliases_and_merge_keys_of_a_reasonable_size_are_read():
    text = 'base: &b {x: 1, y: 2}\nother: {<<: *b, y: 3}\nagain: *b\n'
    assert parse_yaml(text) == {
        'base': {'x': 1, 'y': 2},
        'other': {'x': 1, 'y': 3},
        'again': {'x': 1, 'y': 2},
    }


def laughs(step):
    """Return a text of nine levels, each ten times what is before it."""
    lines = ['a0: &a0 ' + step.format(', '.join(['x: 1']))]
    for level in range(1, 10):
        inner = ', '.join([f'*a{level - 1}'] * 10)
        lines.append(f'a{level}: &a{level} {{<<: [{inner}]}}')
    return '\n'.join(lines)


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        pytest.param('[' * 100_000, 'line 1: (more than 32 levels|exceeded max)', id='flow'),
        pytest.param('- ' * 100_000, 'line 1: more than 32 levels', id='block'),
        pytest.param('{a: ' * 40, 'line 1: more than 32 levels', id='mappings'),
        pytest.param('? ' * 100, 'more than 32 levels', id='keys'),
        pytest.param('x: ' + '9' * 5000, 'line 1: a number of 5000 characters', id='digits'),
        pytest.param('x: ' + '1:' * 90 + '1', 'characters|exceeds 64 bits', id='base60'),
        pytest.param(
            'a: 1\nx: -9223372036854775809', 'line 2: the integer -92.* 64 bits', id='low'
        ),
        pytest.param('x: 0x1ffffffffffffffff', 'exceeds 64 bits', id='hexadecimal'),
        pytest.param('x: 1.' + '0' * 200, 'a number of 202 characters', id='float'),
        pytest.param('a: &x [*x]', r'line 1: the alias \*x stands in itself', id='circle'),
        pytest.param(laughs('{{{}}}'), 'more than 100000 values', id='merge keys'),
        pytest.param(
            'a0: &a0 [1, 1]\n'
            + '\n'.join(f'a{n}: &a{n} [*a{n - 1}, *a{n - 1}]' for n in range(1, 30)),
            'more than 100000 values',
            id='laughs',
        ),
        pytest.param('- 1\n' * 70_000, 'the text has 280000 bytes: the limit is 262144', id='size'),
        pytest.param('[' + '1,' * 110_000, 'more than 100000 values', id='values'),
        pytest.param('a: *b', 'is not YAML: line 1', id='unknown alias'),
        pytest.param('a: \x00', 'is not', id='NUL'),
        pytest.param('a: \ud800', 'is not', id='surrogate'),
        pytest.param('a: !!python/object/apply:os.system [x]', 'is not YAML: line 1', id='tag'),
        pytest.param('a: !!bool 3', 'is not', id='bool'),
        pytest.param('a: !!timestamp 3', 'is not', id='timestamp'),
        pytest.param('a: !!int ""', 'is not', id='empty integer'),
        pytest.param('a: 2001-99-99', 'is not a YAML text file', id='date'),
        pytest.param('[a]: 1', 'is not YAML', id='key'),
        pytest.param('a: 1\n---\nb: 2', 'is not YAML', id='documents'),
    ],
)
def test_hostile_text_is_refused_in_one_line(text, words):
    with pytest.raises(YamlError, match=words) as caught:
        parse_yaml(text)
    assert '\n' not in str(caught.value)


def test_the_python_parser_refuses_the_same(monkeypatch):
    """PyYAML may lack libyaml."""
    monkeypatch.setattr(yaml_text, '_Loader', yaml.SafeLoader)
    for text in ('[' * 100_000, '- ' * 100_000, 'a: &x [*x]', laughs('{{{}}}')):
        with pytest.raises(YamlError):
            parse_yaml(text)


def test_numbers_at_the_limits_are_read():
    assert parse_yaml('[18446744073709551615, -9223372036854775808]') == [2**64 - 1, -(2**63)]
    assert parse_yaml('.inf') == math.inf


def test_a_file_is_read_and_what_is_none_is_refused(tmp_path):
    file = tmp_path / 'file.yaml'
    file.write_bytes('\ufeffa: ä'.encode())
    assert read_yaml(file) == {'a': 'ä'}
    with pytest.raises(YamlError, match='cannot be read: No such file'):
        read_yaml(tmp_path / 'nothing')
    with pytest.raises(YamlError, match='cannot be read: Is a directory'):
        read_yaml(tmp_path)
    with pytest.raises(YamlError, match='cannot be read'):
        read_yaml('a\0b')
    file.write_bytes(b'a: \xff')
    with pytest.raises(YamlError, match='is not a YAML text file: byte 3 is not UTF-8'):
        read_yaml(file)
    with pytest.raises(YamlError, match='more than 262144 bytes'):
        read_yaml('/dev/zero')


def test_a_list_as_launch_files_hand_it_on_is_a_list():
    assert parse_yaml('topics: !!python/tuple\n- a\n- [b]\n') == {'topics': ['a', ['b']]}
    with pytest.raises(YamlError):
        parse_yaml('topics: !!python/object:os.system [a]')
