"""ROS parameter files (YAML): the same file serves Python and `--ros-args --params-file`."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from gear_dynamics.parameters.gear_pair import GearPairParameters
from gear_dynamics.parameters.parameter import (
    Parameter,
    ParameterError,
    ParameterSet,
    refuse_unknown_name,
)
from gear_dynamics.parameters.settings import (
    AnalyzerSettings,
    DashboardSettings,
    FoxgloveSettings,
    ReplaySettings,
    SimSettings,
)
from gear_dynamics.parameters.yaml_text import YamlError, read_yaml

NODES: dict[str, tuple[type[ParameterSet], ...]] = {
    'gear_sim': (GearPairParameters, SimSettings),
    'gear_analyzer': (AnalyzerSettings,),
    'gear_replay': (ReplaySettings,),
    'gear_dashboard': (DashboardSettings,),
    'gear_foxglove': (FoxgloveSettings,),
}
"""The nodes of this package and the parameter lists that each takes."""

ROS_NAMES = ('use_sim_time', 'start_type_description_service', 'qos_overrides')
"""Parameters that ROS itself gives every node; the last is the beginning of many names."""

OPEN_PREFIXES = ('qos_overrides.', 'fault.')
"""Beginnings of names that are checked elsewhere: by ROS, and where faults are known."""

DIMENSIONLESS = 'dimensionless'
"""Top of a file that gives a published model by its dimensionless numbers."""

EXAMPLE = '/**: {ros__parameters: {speed: 104.72}}'


def write_parameters(path: str | Path, values: ParameterSet) -> None:
    """Write every parameter, with unit and meaning, as a ROS parameter file for any node.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    given = values.to_mapping()
    lines = [f'    {_line(about, given[about.name])}' for about in values.parameters()]
    text = '\n'.join(['/**:', '  ros__parameters:', *lines, ''])
    Path(path).write_text(text, encoding='utf-8')


def read_parameters(path: str | Path, node: str = '/gear_sim') -> dict[str, Any]:
    """Return the parameters that a file has for a node, nested names joined by dots.

    As in rclpy, a section applies if its name is the node's or a wildcard that covers it
    (`/**` any, `/*` one level), and of two that apply the later one holds.

    Parameters
    ----------
    path : str or Path
        ROS parameter file.
    node : str
        The node's full name.

    Raises
    ------
    ParameterError
        If the file cannot be read, is malformed, has an unknown name, or nothing for the node.
    """
    sections = list(_sections(path, _load(path)))
    _refuse_unknown(path, sections)
    if not any(_applies(name, node) for name, _ in sections):
        names = ', '.join(name for name, _ in sections)
        raise ParameterError(f'{path}: no section is for {node}; there are {names}')
    return read_section(path, node)


def read_dimensionless(path: str | Path) -> Mapping[str, Any] | None:
    """Return what a file has under `dimensionless` at its top; None if it is another file.

    Raises
    ------
    ParameterError
        If the file cannot be read, or has anything beside that.
    """
    content = _load(path)
    if DIMENSIONLESS not in content:
        return None
    numbers = content[DIMENSIONLESS]
    if len(content) > 1 or not isinstance(numbers, Mapping):
        raise ParameterError(
            f'{path}: {DIMENSIONLESS} must be names with values, and nothing may stand beside it'
        )
    return numbers


def read_section(path: str | Path, node: str) -> dict[str, Any]:
    """Return the parameters that a file has for a node, none if it has no section for it.

    Raises
    ------
    ParameterError
        If the file cannot be read or is malformed.
    """
    applying = [values for name, values in _sections(path, _load(path)) if _applies(name, node)]
    return {name: value for values in applying for name, value in values.items()}


def check_parameter_file(path: str | Path) -> None:
    """Refuse a malformed parameter file or one with unknown names, which ROS would ignore.

    Sections for nodes that are not of this package are left alone.

    Raises
    ------
    ParameterError
        With one line that names the file and what is wrong.
    """
    _refuse_unknown(path, _sections(path, _load(path)))


def check_section(path: str | Path, node: str, name: str) -> None:
    """Refuse a parameter file that was meant for a node but has no section for it.

    A file for other nodes of this package alone is left as it is: one file may serve several.

    Parameters
    ----------
    path : str or Path
    node : str
        The node's full name.
    name : str
        The name that it has unless it is renamed, such as 'gear_sim'.

    Raises
    ------
    ParameterError
        If no section is for the node, and one has its name in another namespace, or none has the
        name of a node of this package.
    """
    places = [place for place, _ in _sections(path, _load(path))]
    if not places or any(_applies(place, node) for place in places):
        return
    names = {place.rsplit('/', 1)[-1] for place in places}
    if names & {name, node.rsplit('/', 1)[-1]} or not names & NODES.keys():
        raise ParameterError(f'{path}: no section is for {node}; there are {", ".join(places)}')


def known_names() -> frozenset[str]:
    """Return the names of all parameters of all nodes of this package.

    One file may serve several nodes, so that each must bear the others' names.
    """
    lists = {each for lists in NODES.values() for each in lists}
    return frozenset(about.name for each in lists for about in each.parameters())


def refuse_unknown(names: Collection[str]) -> None:
    """Refuse names that no node of this package takes.

    Raises
    ------
    ParameterError
        With the first such name, and the nearest known one.
    """
    known = known_names() | set(ROS_NAMES)
    for name in names:
        if not name.startswith(OPEN_PREFIXES):
            refuse_unknown_name(name, known)


def _load(path: str | Path) -> Mapping[str, Any]:
    try:
        content = read_yaml(path)
    except YamlError as error:
        raise ParameterError(f'{path}: {error}') from None
    if not isinstance(content, Mapping):
        raise ParameterError(f'{path}: is not a ROS parameter file, such as {EXAMPLE}')
    return content


def _sections(
    path: str | Path, content: Mapping[Any, Any], above: str = ''
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name of each section, with a slash before it, and its flattened parameters."""
    for key, value in content.items():
        place = f'{above}/{key}' if above else f'/{str(key).removeprefix("/")}'
        if not re.fullmatch(r'(/(\w+|\*\*?))+', place):
            raise ParameterError(f'{path}: {place} is no name of a node')
        if not isinstance(value, Mapping):
            raise ParameterError(
                f'{path}: {place} is {value!r}: parameters must stand under ros__parameters, '
                f'such as {EXAMPLE}'
            )
        if 'ros__parameters' in value:
            yield place, dict(_flatten(path, value['ros__parameters']))
        others = {name: each for name, each in value.items() if name != 'ros__parameters'}
        yield from _sections(path, others, place)


def _flatten(path: str | Path, values: Any, above: str = '') -> Iterator[tuple[str, Any]]:
    if not isinstance(values, Mapping):
        place = above.rstrip('.') or 'ros__parameters'
        raise ParameterError(f'{path}: {place} is {values!r}: it must be names with values')
    for key, value in values.items():
        name = f'{above}{key}'
        if isinstance(value, Mapping):
            yield from _flatten(path, value, f'{name}.')
        elif value is None:
            raise ParameterError(f'{path}: {name} has no value')
        else:
            yield name, value


def _refuse_unknown(
    path: str | Path, sections: Collection[tuple[str, dict[str, Any]]] | Iterator[Any]
) -> None:
    for section, values in sections:
        last = section.rsplit('/', 1)[-1]
        if last in NODES or '*' in last:
            try:
                refuse_unknown(values)
            except ParameterError as error:
                raise ParameterError(f'{path}: {error}') from None


def _applies(section: str, node: str) -> bool:
    # The very substitution that rclpy makes.
    return re.fullmatch(section.replace('/*', r'(/\w+)'), node) is not None


def _line(about: Parameter, value: Any) -> str:
    # safe_dump writes numbers in the form that YAML and rcl both read as numbers.
    unit = f' [{about.unit}]' if about.unit else ''
    return f'{yaml.safe_dump({about.name: value}).strip()}  # {about.description}{unit}'
