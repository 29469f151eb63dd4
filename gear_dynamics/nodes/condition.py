"""Condition indicators as diagnostic_msgs/DiagnosticArray bytes, to publish and to log alike."""

from __future__ import annotations

from gear_dynamics.monitoring.results import ConditionResult, ConditionRow, StreamSpan
from gear_dynamics.wire.messages import message_class, serialize

SECOND = 1_000_000_000


def condition_bytes(result: ConditionResult, rig: str) -> bytes:
    """Return the message: stamped with the start of the span, one status a row.

    Parameters
    ----------
    result : ConditionResult
    rig : str
        What the statuses belong to, such as 'rig1/gear_pair'; begins their names.
    """
    time = message_class('builtin_interfaces/msg/Time')(*divmod(result.span.start_ns, SECOND))
    header = message_class('std_msgs/msg/Header')(time, '')
    status = [_status(row, result.span, rig) for row in result.rows]
    return serialize(message_class('diagnostic_msgs/msg/DiagnosticArray')(header, status))


def _status(row: ConditionRow, span: StreamSpan, rig: str) -> object:
    key_value = message_class('diagnostic_msgs/msg/KeyValue')
    texts = {
        'stamp': f'{span.start_ns // SECOND}.{span.start_ns % SECOND:09d}',
        'duration': f'{span.duration:.6g}',
        **{name: f'{value:.6g}' for name, value in row.values.items()},
        **row.notes,
    }
    return message_class('diagnostic_msgs/msg/DiagnosticStatus')(
        level=int(row.level),
        name=f'{rig}: {row.subject}',
        message=row.message,
        hardware_id=rig,
        values=[key_value(key, value) for key, value in texts.items()],
    )
