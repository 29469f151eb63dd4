"""The one reader of YAML text that comes from outside: small, shallow and plain, or refused.

Parameter files, configurations of a rig, alarm limits, machine files, QoS profiles and the
metadata of bags are all read here.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

LARGEST_TEXT = 1 << 18
"""Bytes of YAML text that are read by default."""

DEEPEST = 32
"""Lists and mappings inside each other."""

MOST_VALUES = 100_000
"""Scalars, lists and mappings, each alias counted with all that it stands for."""

LONGEST_NUMBER = 100
"""Characters of a number; a longer one would take long to convert."""

# libyaml is ten times faster than the parser in Python; some builds of PyYAML lack it.
_Loader: Any = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)

# What PyYAML raises on a scalar that does not fit its tag, such as `!!bool 3` or 2001-99-99.
_MISFITS = (ValueError, LookupError, AttributeError, TypeError, OverflowError)

_INTEGER_RANGE = range(-(1 << 63), 1 << 64)


class YamlError(ValueError):
    """Text is no YAML, or exceeds a limit; the message says where and why in one line."""


class _PlainLoader(_Loader):  # type: ignore[misc]
    """The safe loader, with bounds on numbers."""

    def construct_integer(self, node: yaml.ScalarNode) -> int:
        """Return an integer that fits 64 bits."""
        _check_length(node)
        value = self.construct_yaml_int(node)
        if value not in _INTEGER_RANGE:
            raise YamlError(f'line {_line(node)}: the integer {value} exceeds 64 bits')
        return int(value)

    def construct_list(self, node: yaml.SequenceNode) -> list[Any]:
        """Return a list."""
        return list(self.construct_sequence(node, deep=True))

    def construct_number(self, node: yaml.ScalarNode) -> float:
        """Return a float written in a reasonable length."""
        _check_length(node)
        return float(self.construct_yaml_float(node))


_PlainLoader.add_constructor('tag:yaml.org,2002:int', _PlainLoader.construct_integer)
_PlainLoader.add_constructor('tag:yaml.org,2002:float', _PlainLoader.construct_number)
# launch_ros writes a list of a launch file as a tuple of Python.
_PlainLoader.add_constructor('tag:yaml.org,2002:python/tuple', _PlainLoader.construct_list)


def parse_yaml(text: str, largest: int = LARGEST_TEXT) -> Any:
    """Return what a YAML document says, as `yaml.safe_load` would.

    Parameters
    ----------
    text : str
        One document, from any source.
    largest : int
        Limit on its length in UTF-8 [bytes].

    Raises
    ------
    YamlError
        With one line, if the text is no YAML or exceeds a limit: its size, `DEEPEST`,
        `MOST_VALUES`, `LONGEST_NUMBER`, or 64 bits of an integer.
    """
    size = len(text.encode(errors='surrogatepass'))
    if size > largest:
        raise YamlError(f'the text has {size} bytes: the limit is {largest}')
    text = text.removeprefix('\ufeff')
    try:
        _check_structure(text)
        return yaml.load(text, _PlainLoader)
    except yaml.MarkedYAMLError as error:
        raise YamlError(f'is not YAML: {_place(error)}{_one_line(error.problem)}') from None
    except yaml.YAMLError as error:
        raise YamlError(f'is not a YAML text file: {_one_line(error)}') from None
    except YamlError:
        raise
    except _MISFITS as error:
        raise YamlError(f'is not a YAML text file: {_one_line(error)}') from None


def read_yaml(path: str | Path, largest: int = LARGEST_TEXT) -> Any:
    """Return what a YAML file says; see `parse_yaml`.

    Raises
    ------
    YamlError
        With one line that does not name the file, if it cannot be read, is no UTF-8 text or no
        YAML, or exceeds a limit.
    """
    try:
        with Path(path).open('rb') as stream:
            content = stream.read(largest + 1)
    except OSError as error:
        raise YamlError(f'cannot be read: {error.strerror}') from None
    except ValueError as error:  # a path with a NUL
        raise YamlError(f'cannot be read: {error}') from None
    if len(content) > largest:
        raise YamlError(f'the file has more than {largest} bytes, which is the limit')
    try:
        return parse_yaml(content.decode(), largest)
    except UnicodeDecodeError as error:
        raise YamlError(f'is not a YAML text file: byte {error.start} is not UTF-8') from None


def _check_structure(text: str) -> None:
    """Refuse what is too deep or grows too large, before any of it is built."""
    open_: list[tuple[str | None, int]] = []  # anchors and counts before them
    sizes: dict[str, int] = {}
    count = 0
    for event in yaml.parse(text, _Loader):
        anchor = getattr(event, 'anchor', None)
        if isinstance(event, yaml.AliasEvent):
            if anchor in {name for name, _ in open_}:
                raise YamlError(f'line {_line(event)}: the alias *{anchor} stands in itself')
            count += sizes.get(str(anchor), 1)  # the composer refuses an unknown one
        elif isinstance(event, yaml.CollectionStartEvent):
            open_.append((anchor, count))
            count += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            name, before = open_.pop()
            if name is not None:
                sizes[name] = count - before
        elif isinstance(event, yaml.ScalarEvent):
            count += 1
            if anchor is not None:
                sizes[anchor] = 1
        if len(open_) > DEEPEST:
            raise YamlError(f'line {_line(event)}: more than {DEEPEST} levels, which is the limit')
        if count > MOST_VALUES:
            raise YamlError(f'more than {MOST_VALUES} values, which is the limit')


def _check_length(node: yaml.ScalarNode) -> None:
    length = len(node.value)
    if length > LONGEST_NUMBER:
        raise YamlError(
            f'line {_line(node)}: a number of {length} characters: the limit is {LONGEST_NUMBER}'
        )


def _line(marked: yaml.Event | yaml.Node) -> int:
    return int(marked.start_mark.line) + 1 if marked.start_mark else 1


def _place(error: yaml.MarkedYAMLError) -> str:
    return f'line {error.problem_mark.line + 1}: ' if error.problem_mark else ''


def _one_line(reason: object) -> str:
    """Return an error's text in one line of printable characters."""
    text = ' '.join(str(reason).split())
    return re.sub(r'[^ -~]', '?', text)[:200]
