"""Labels of faults as diagnostic_msgs/DiagnosticArray bytes, to publish and to log alike."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from gear_dynamics.wire.messages import message_class, serialize

SECOND = 1_000_000_000


def label_bytes(labels: Iterable[Mapping[str, str]], stamp_ns: int, rig: str) -> bytes:
    """Return the message: one status a fault, none for a healthy machine.

    Parameters
    ----------
    labels : iterable of mapping
        Values of each fault, `fault` among them.
    stamp_ns : int
        Time of the sample from which on they hold [ns].
    rig : str
        What they belong to, such as 'rig1/gear_pair'; begins the names of the statuses.
    """
    time = message_class('builtin_interfaces/msg/Time')(*divmod(stamp_ns, SECOND))
    header = message_class('std_msgs/msg/Header')(time, '')
    status = [_status(values, rig) for values in labels]
    return serialize(message_class('diagnostic_msgs/msg/DiagnosticArray')(header, status))


def _status(values: Mapping[str, str], rig: str) -> object:
    key_value = message_class('diagnostic_msgs/msg/KeyValue')
    return message_class('diagnostic_msgs/msg/DiagnosticStatus')(
        level=0,
        name=f'{rig}: {values["fault"]}',
        message=f'severity {values["severity"]}',
        hardware_id=rig,
        values=[key_value(key, value) for key, value in values.items()],
    )
