"""A machine as the content of a machine file, for texts that others read."""

from __future__ import annotations

import dataclasses
from typing import Any

from gear_dynamics.machine.channel import Channel
from gear_dynamics.machine.parts import Bearing, Mesh
from gear_dynamics.machine.recording_form import RecordingForm, Severity
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
from gear_dynamics.machine.units import RPM, UNKNOWN

Mapping = dict[str, Any]


def channel_mapping(channel: Channel) -> Mapping:
    """Return what stands under the name of a channel."""
    return _source(channel.source) | _given(
        unit=None if channel.recorded_unit == UNKNOWN else channel.recorded_unit,
        quantity=channel.quantity or None,
        sensitivity=channel.sensitivity,
        full_scale=channel.full_scale,
    )


def shaft_mapping(shaft: Shaft) -> Mapping:
    """Return what stands under the name of a shaft."""
    speed = {} if shaft.speed is None else _speed(shaft.speed)
    return speed | _given(inertia=shaft.inertia)


def mesh_mapping(mesh: Mesh) -> Mapping:
    """Return what stands under the name of a mesh."""
    content = dataclasses.asdict(mesh)
    del content['name']
    return _given(**content)


def bearing_mapping(bearing: Bearing) -> Mapping:
    """Return what stands under the name of a bearing; its geometry became orders."""
    channels = list(bearing.channels) or None
    return {'shaft': bearing.shaft, 'orders': dict(bearing.orders), 'slip': bearing.slip} | _given(
        channels=channels
    )


def form_mapping(form: RecordingForm) -> Mapping:
    """Return the keys that hold for all channels."""
    span = 'record' if form.span is None else form.span
    return _given(
        sample_rate=_rate(form.sample_rate),
        time=_time(form.time),
        span=span,
        files=form.files,
        rows=None if form.rows is None else _given(**dataclasses.asdict(form.rows)),
    )


def severity_mapping(severity: Severity) -> Mapping:
    """Return the limits in mm/s."""
    return {'limits_mm_s': [round(limit * 1e3, 9) for limit in severity.limits]}


def _speed(speed: SpeedSource) -> Mapping:
    if isinstance(speed, Tacho):
        content = _source(speed.source) | _given(pulses=speed.pulses, level=speed.level)
        return {'tacho': content}
    if isinstance(speed, Angle):
        return {'angle': _source(speed.source) | {'counts': speed.revolution}}
    if isinstance(speed, SpeedColumn):
        return {'speed': _source(speed.source) | {'unit': speed.unit}}
    if isinstance(speed, FixedSpeed):
        return {'speed_rpm': speed.speed / RPM}
    if isinstance(speed, TrackedSpeed):
        limits = {'from_rpm': speed.lowest / RPM, 'to_rpm': speed.highest / RPM}
        return {'track': limits | _given(channel=speed.channel, order=speed.order)}
    assert isinstance(speed, DrivenBy)
    return {'driven_by': speed.mesh}


def _source(source: Source) -> Mapping:
    return _given(
        column=source.column,
        file=source.file,
        topic=source.topic,
        sample_rate=_rate(source.sample_rate),
        time=_time(source.time),
    )


def _rate(rate: float | str | None) -> Any:
    return {'column': rate} if isinstance(rate, str) else rate


def _time(time: Time | None) -> Mapping | None:
    if time is None:
        return None
    return {'columns': list(time.columns), 'units': list(time.units)}


def _given(**values: Any) -> Mapping:
    return {name: value for name, value in values.items() if value is not None}
