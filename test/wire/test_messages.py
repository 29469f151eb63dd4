"""Message bytes and type hashes against those that ROS itself installs."""

import json
import os
import sys
from pathlib import Path

import numpy as np
import pytest

from gear_dynamics.wire.messages import (
    MessageError,
    deserialize,
    header_stamp,
    message_class,
    message_type,
    serialize,
)

TYPES = [
    'sensor_msgs/msg/PointCloud2',
    'sensor_msgs/msg/JointState',
    'geometry_msgs/msg/AccelStamped',
    'geometry_msgs/msg/WrenchStamped',
    'diagnostic_msgs/msg/DiagnosticArray',
    'std_msgs/msg/String',
    'std_msgs/msg/Float64',
    'rosgraph_msgs/msg/Clock',
]


def installed_description(type_name):
    """Return the type description that ROS has installed, skip the test if there is none."""
    package, _, name = type_name.split('/')
    prefixes = [*os.environ.get('AMENT_PREFIX_PATH', '').split(':'), sys.prefix]
    for prefix in filter(None, prefixes):
        file = Path(prefix) / 'share' / package / 'msg' / f'{name}.json'
        if file.exists():
            return json.loads(file.read_text())
    pytest.skip(f'{type_name} is not installed')


@pytest.mark.parametrize('type_name', TYPES)
def test_the_hash_is_that_of_the_installed_type(type_name):
    content = installed_description(type_name)
    hashes = {entry['type_name']: entry['hash_string'] for entry in content['type_hashes']}
    assert message_type(type_name).hash == hashes[type_name]


@pytest.mark.parametrize('type_name', TYPES)
def test_the_definition_holds_every_nested_type(type_name):
    content = installed_description(type_name)
    definition = message_type(type_name).definition
    nested = content['type_description_msg']['referenced_type_descriptions']
    for entry in nested:
        assert f'MSG: {entry["type_name"].replace("/msg/", "/")}\n' in definition


def test_bytes_are_those_that_rclpy_reads_and_writes():
    serialization = pytest.importorskip('rclpy.serialization', reason='rclpy is not installed')
    from std_msgs.msg import String

    data = serialize(message_class('std_msgs/msg/String')('grüße'))
    assert serialization.deserialize_message(data, String).data == 'grüße'
    again = serialization.serialize_message(String(data='grüße'))
    assert deserialize(again, 'std_msgs/msg/String').data == 'grüße'


def test_stamp_of_a_header():
    time = message_class('builtin_interfaces/msg/Time')(-3, 5)
    header = message_class('std_msgs/msg/Header')(time, 'f')
    empty = np.empty(0)
    joints = message_class('sensor_msgs/msg/JointState')(header, [], empty, empty, empty)
    assert header_stamp(serialize(joints), 'sensor_msgs/msg/JointState') == -3 * 10**9 + 5
    assert header_stamp(b'', 'std_msgs/msg/Float64') is None
    with pytest.raises(MessageError, match='stamp is cut'):
        header_stamp(b'\0\1\0\0', 'sensor_msgs/msg/JointState')


@pytest.mark.parametrize('data', [b'', b'\0', b'\0\1\0\0\xff\xff\xff\xff'])
def test_what_is_no_message_is_refused(data):
    with pytest.raises(MessageError, match='are no std_msgs/msg/String'):
        deserialize(data, 'std_msgs/msg/String')


def test_a_field_of_the_wrong_type_is_refused():
    with pytest.raises(MessageError, match='cannot serialize'):
        serialize(message_class('std_msgs/msg/Float64')('no number'))
