"""A reliable listener to gear_pair/samples that can be killed or stopped: run as a script."""

import sys

import rclpy
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import PointCloud2

rclpy.init(args=sys.argv)
node = rclpy.create_node('listener')
count = 0


def hear(data):
    global count
    count += 1
    if count == 1:
        print('hears', flush=True)


node.create_subscription(PointCloud2, 'gear_pair/samples', hear, 1000, raw=True)
executor = SingleThreadedExecutor()
executor.add_node(node)
executor.spin()
