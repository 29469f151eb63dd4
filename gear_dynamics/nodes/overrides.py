"""Parameters that are given more than once at the start: the last one holds, whatever its type.

ROS keeps a value of each type for a name, and takes the integer where a file says 120 and the
command line 130.5 later.
"""

from __future__ import annotations

import collections
import itertools
from collections.abc import Iterator, Sequence
from typing import Any

from gear_dynamics.parameters.files import read_section
from gear_dynamics.parameters.yaml_text import YamlError, parse_yaml


def repeated_parameters(arguments: Sequence[str], node: str, name: str) -> dict[str, Any]:
    """Return the last value of each parameter that is given more than once.

    Parameters
    ----------
    arguments : sequence of str
        Those of the process.
    node : str
        The node's full name.
    name : str
        Its name without the namespace.
    """
    values: dict[str, Any] = {}
    counts: collections.Counter[str] = collections.Counter()
    for parameter, value in _given(arguments, node, name):
        values[parameter] = value
        counts[parameter] += 1
    return {parameter: value for parameter, value in values.items() if counts[parameter] > 1}


def _given(arguments: Sequence[str], node: str, name: str) -> Iterator[tuple[str, Any]]:
    for option, text in itertools.pairwise(arguments):
        if option == '--params-file':
            yield from read_section(text, node).items()
        elif option in ('-p', '--param'):
            rule, _, value = text.partition(':=')
            target, _, parameter = rule.rpartition(':')
            if target in ('', name, node):
                try:
                    yield parameter, parse_yaml(value)
                except YamlError:
                    continue  # ROS has refused it
