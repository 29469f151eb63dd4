"""Publish three channels and a tacho of a made-up gearbox, for `analyzer` with a machine file."""

import array
import time

import numpy as np
import rclpy
from rclpy.clock import Clock
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import PointCloud2, PointField

RATE, BLOCK = 12800, 256
NAMES = ('housing', 'cover', 'floor', 'tacho')

rclpy.init()
node = rclpy.create_node('data_logger')
publisher = node.create_publisher(PointCloud2, 'gear_pair/samples', qos_profile_sensor_data)
fields = [PointField(name=n, offset=4 * k, datatype=7, count=1) for k, n in enumerate(NAMES)]
begin, random = time.monotonic(), np.random.default_rng()
for number in range(10**9):
    t = (np.arange(BLOCK) + number * BLOCK) / RATE
    values = random.normal(size=(BLOCK, 4)).astype(np.float32)
    values[:, 0] += 5 * np.sin(2 * np.pi * 20 * 25 * t)
    values[:, 3] = 5.0 * (np.mod(25 * t, 1) < 0.1)
    table = PointCloud2(height=1, width=BLOCK, point_step=16, row_step=16 * BLOCK, fields=fields)
    table.data, table.is_dense = array.array('B', values.tobytes()), True
    table.header.stamp = Clock().now().to_msg()
    publisher.publish(table)
    time.sleep(max(0.0, begin + (number + 1) * BLOCK / RATE - time.monotonic()))
