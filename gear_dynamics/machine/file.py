"""Reads a machine from a machine file; docs/machines.md describes the keys."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from gear_dynamics.machine.channel import Channel
from gear_dynamics.machine.keys import Keys, number
from gear_dynamics.machine.parts import DEFECTS, Bearing, Mesh, Wheel, bearing_orders
from gear_dynamics.machine.recording_form import FILES, ISO_10816_3, RecordingForm, Rows, Severity
from gear_dynamics.machine.shaft import (
    Angle,
    DrivenBy,
    FixedSpeed,
    Shaft,
    SpeedColumn,
    SpeedSource,
    Tacho,
    TrackedSpeed,
)
from gear_dynamics.machine.source import Source, Time
from gear_dynamics.machine.units import RPM, UNKNOWN, factor, unit
from gear_dynamics.parameters.yaml_text import YamlError, read_yaml

_Part = TypeVar('_Part')

SOURCE_KEYS = ('column', 'file', 'topic', 'sample_rate', 'time')


def read_machine(path: str | Path) -> dict[str, Any]:
    """Return the arguments of `Machine` that stand in a machine file.

    Raises
    ------
    ValueError
        With one line that names the file, the key and what is wrong.
    """
    try:
        return machine_arguments(read_yaml(path))
    except (YamlError, ValueError) as error:
        raise ValueError(f'{path}: {error}') from None


def machine_arguments(content: Any) -> dict[str, Any]:
    """Return the arguments of `Machine` from the content of a machine file."""
    keys = Keys(
        content,
        'the machine file',
        (
            *('machine', 'sample_rate', 'time', 'span', 'files', 'rows', 'channels', 'shafts'),
            *('wheels', 'meshes', 'bearings', 'severity'),
        ),
    )
    return {
        'name': keys.text('machine', 'machine'),
        'channels': _parts(keys, 'channels', _channel),
        'shafts': _parts(keys, 'shafts', _shaft),
        'wheels': _parts(keys, 'wheels', _wheel),
        'meshes': _parts(keys, 'meshes', _mesh),
        'bearings': _parts(keys, 'bearings', _bearing),
        'recording': _recording_form(keys),
        'severity': _severity(keys.get('severity')),
    }


def _parts(keys: Keys, kind: str, make: Callable[[str, Any], _Part]) -> tuple[_Part, ...]:
    if kind not in keys:
        return ()
    return tuple(make(name, each) for name, each in Keys(keys.get(kind), kind, None).items())


def _channel(name: str, content: Any) -> Channel:
    own = ('unit', 'sensitivity', 'quantity', 'full_scale')
    keys = Keys(content, f'channel {name}', (*SOURCE_KEYS, *own))
    recorded = keys.text('unit', UNKNOWN)
    quantity = keys.text('quantity', '')
    assert recorded is not None
    assert quantity is not None
    sensitivity = keys.number('sensitivity')
    if (sensitivity is None) != (quantity == ''):
        raise ValueError(
            f'{keys.where}: sensitivity and quantity belong together: {recorded} per quantity'
        )
    _check_units(keys.where, recorded, quantity or recorded)
    full_scale = keys.number('full_scale')
    return Channel(name, _source(keys), recorded, quantity, sensitivity, full_scale)


def _check_units(where: str, *names: str) -> None:
    for name in names:
        try:
            unit(name)
        except ValueError as error:
            raise ValueError(f'{where}: {error}') from None


def _source(keys: Keys) -> Source:
    column = keys.get('column')
    if isinstance(column, bool | list | Mapping | float):
        raise ValueError(f'{keys.where}: column is {column!r}: it must be a name or a number')
    if isinstance(column, int) and column < 1:
        raise ValueError(f'{keys.where}: column is {column}: columns are counted from 1')
    return Source(
        column=column,
        file=keys.text('file'),
        topic=keys.text('topic'),
        sample_rate=_rate(keys),
        time=_time(keys),
    )


def _rate(keys: Keys) -> float | str | None:
    value = keys.get('sample_rate')
    if isinstance(value, Mapping):
        where = f'{keys.where}: sample_rate'
        return Keys(value, where, ('column',)).text('column')
    return keys.number('sample_rate')


def _time(keys: Keys) -> Time | None:
    if 'time' not in keys:
        return None
    where = f'{keys.where}: time'
    inner = Keys(keys.get('time'), where, ('column', 'columns', 'unit', 'units'))
    columns = inner.get('columns') if 'columns' in inner else [inner.require('column')]
    units = inner.get('units') if 'units' in inner else [inner.get('unit') or 's']
    if not isinstance(columns, list) or not isinstance(units, list) or len(columns) != len(units):
        raise ValueError(f'{where}: columns and units must be lists of the same length')
    for each in units:
        try:
            factor(str(each), 's')
        except ValueError as error:
            raise ValueError(f'{where}: {error}') from None
    return Time(tuple(columns), tuple(str(each) for each in units))


def _shaft(name: str, content: Any) -> Shaft:
    ways: dict[str, Callable[[Any, str], SpeedSource]] = {
        'tacho': _tacho,
        'angle': _angle,
        'speed': _speed,
        'speed_rpm': _speed_rpm,
        'track': _track,
        'driven_by': lambda value, where: DrivenBy(str(value)),
    }
    keys = Keys(content if content is not None else {}, f'shaft {name}', (*ways, 'inertia'))
    given = [way for way in ways if way in keys]
    if len(given) > 1:
        raise ValueError(f'{keys.where} has {" and ".join(given)}: one of them must go')
    speed = None
    if given:
        speed = ways[given[0]](keys.get(given[0]), f'{keys.where}: {given[0]}')
    return Shaft(name, speed, keys.number('inertia'))


def _tacho(content: Any, where: str) -> Tacho:
    keys = Keys(content, where, (*SOURCE_KEYS, 'pulses', 'level'))
    pulses = keys.number('pulses', 1.0)
    assert pulses is not None
    return Tacho(_source(keys), pulses, keys.number('level', least=-math.inf))


def _angle(content: Any, where: str) -> Angle:
    keys = Keys(content, where, (*SOURCE_KEYS, 'counts', 'unit'))
    counts = keys.number('counts')
    if counts is not None:
        return Angle(_source(keys), counts)
    try:
        return Angle(_source(keys), 2 * math.pi / factor(keys.text('unit', 'rad') or '', 'rad'))
    except ValueError as error:
        raise ValueError(f'{where}: {error}') from None


def _speed(content: Any, where: str) -> SpeedColumn:
    keys = Keys(content, where, (*SOURCE_KEYS, 'unit'))
    name = keys.text('unit', 'rpm')
    assert name is not None
    try:
        factor(name, 'rad/s')
    except ValueError as error:
        raise ValueError(f'{where}: {error}') from None
    return SpeedColumn(_source(keys), name)


def _speed_rpm(content: Any, where: str) -> FixedSpeed | TrackedSpeed:
    if not isinstance(content, Mapping):
        return FixedSpeed(number(content, where) * RPM)
    keys = Keys(content, where, ('nominal', 'within'))
    nominal = number(keys.require('nominal'), f'{where}: nominal')
    within = number(keys.require('within'), f'{where}: within')
    if within >= 1:
        raise ValueError(f'{where}: within is {within:g}: it is a fraction, below 1')
    return TrackedSpeed(nominal * (1 - within) * RPM, nominal * (1 + within) * RPM)


def _track(content: Any, where: str) -> TrackedSpeed:
    keys = Keys(content, where, ('channel', 'order', 'from_rpm', 'to_rpm'))
    lowest = number(keys.require('from_rpm'), f'{where}: from_rpm')
    highest = number(keys.require('to_rpm'), f'{where}: to_rpm')
    if highest <= lowest:
        raise ValueError(f'{where}: to_rpm is {highest:g}: it must be above from_rpm, {lowest:g}')
    return TrackedSpeed(lowest * RPM, highest * RPM, keys.text('channel'), keys.number('order'))


def _wheel(name: str, content: Any) -> Wheel:
    keys = Keys(content, f'wheel {name}', ('shaft', 'teeth'))
    return Wheel(name, str(keys.require('shaft')), keys.count('teeth'))


def _mesh(name: str, content: Any) -> Mesh:
    if isinstance(content, list):
        if len(content) != 2:
            raise ValueError(f'mesh {name} has {len(content)} wheels: it must have 2')
        return Mesh(name, str(content[0]), str(content[1]))
    texts = ('driver', 'driven', 'displacement', 'velocity')
    keys = Keys(content, f'mesh {name}', (*texts, 'half_backlash', 'natural_frequency'))
    return Mesh(
        name,
        str(keys.require('driver')),
        str(keys.require('driven')),
        keys.text('displacement'),
        keys.text('velocity'),
        keys.number('half_backlash'),
        keys.number('natural_frequency'),
    )


def _bearing(name: str, content: Any) -> Bearing:
    geometry = ('elements', 'element_diameter', 'pitch_diameter', 'contact_angle_deg')
    keys = Keys(content, f'bearing {name}', ('shaft', 'orders', *geometry, 'channels', 'slip'))
    shaft = str(keys.require('shaft'))
    channels = keys.get('channels') or []
    if not isinstance(channels, list):
        raise ValueError(f'{keys.where}: channels is {channels!r}: it must be a list of names')
    slip = keys.number('slip', 0.02, above=False)
    assert slip is not None
    if 'orders' in keys:
        orders = _orders(keys)
    else:
        elements, angle = keys.count('elements'), keys.number('contact_angle_deg', 0, above=False)
        element, pitch = (
            number(keys.require(each), f'{keys.where}: {each}') for each in geometry[1:3]
        )
        assert angle is not None
        try:
            orders = bearing_orders(elements, element, pitch, angle)
        except ValueError as error:
            raise ValueError(f'{keys.where}: {error}') from None
    return Bearing(name, shaft, orders, channels=tuple(map(str, channels)), slip=slip)


def _orders(keys: Keys) -> dict[str, float]:
    inner = Keys(keys.get('orders'), f'{keys.where}: orders', DEFECTS)
    given = {name: number(value, f'{inner.where}: {name}') for name, value in inner.items()}
    if not given:
        raise ValueError(f'{inner.where} is empty: give one of {", ".join(DEFECTS)} at least')
    return {each: given[each] for each in DEFECTS if each in given}


def _recording_form(keys: Keys) -> RecordingForm:
    span = None if keys.get('span') == 'record' else keys.number('span', 1.0)
    rows = None
    if 'rows' in keys:
        inner = Keys(keys.get('rows'), 'rows', ('name', 'samples', 'rate', 'unit'))
        names = str(inner.require('name')), str(inner.require('samples'))
        rows = Rows(*names, inner.text('rate'), inner.text('unit'))
    files = keys.choice('files', FILES, 'joined')
    return RecordingForm(_rate(keys), _time(keys), span, files, rows)


def _severity(content: Any) -> Severity | None:
    if content is None:
        return None
    keys = Keys(content, 'severity', ('limits_mm_s', 'standard', 'group', 'support'))
    if 'limits_mm_s' in keys:
        limits = keys.get('limits_mm_s')
        if not isinstance(limits, list) or len(limits) != 3:
            raise ValueError(f'severity: limits_mm_s is {limits!r}: it must be three numbers')
        values = [number(each, 'severity: limits_mm_s') for each in limits]
        if sorted(values) != values:
            raise ValueError(f'severity: limits_mm_s is {limits!r}: the limits must rise')
        origin = 'machine file'
    else:
        standard = keys.choice('standard', ('ISO 10816-3',), None)
        group = keys.choice('group', (1, 2), None)
        support = keys.choice('support', ('rigid', 'flexible'), None)
        values = list(ISO_10816_3[group, support])
        origin = f'{standard}, group {group}, {support} support'
    a, b, c = (value * 1e-3 for value in values)
    return Severity((a, b, c), origin)
