"""Listen to the stream and print the vibration of the pinion, block by block."""

import contextlib

import numpy as np
import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import PointCloud2

FORMATS = {6: '<u4', 7: '<f4', 8: '<f8'}  # sensor_msgs/PointField: UINT32, FLOAT32, FLOAT64


def rows(table):
    """Return a table as a structured array, one field a column, without copying."""
    columns = [(field.name, FORMATS[field.datatype]) for field in table.fields]
    return np.frombuffer(table.data, columns)


def on_block(table):
    """Take one block of samples."""
    block, start = rows(table), table.header.stamp
    rms = np.sqrt(np.mean(block['pinion_ay'] ** 2))
    print(f'{start.sec}.{start.nanosec:09d}: {len(block)} samples, {rms:.1f} m/s2 RMS', flush=True)


rclpy.init()
node = rclpy.create_node('listener')
node.create_subscription(PointCloud2, 'gear_pair/samples', on_block, 1000)
with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
    rclpy.spin(node)
