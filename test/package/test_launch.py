"""The launch file, with the `ros2` command where there is one (the wheels on PyPI have none)."""

import os
import shutil
import signal
import subprocess

import pytest
import ros_support
from ros_support import ROOT


@pytest.mark.skipif(shutil.which('ros2') is None, reason='the ros2 command is not installed')
def test_rig_is_launched_in_its_namespace_and_closes(client, domain, tmp_path):
    from sensor_msgs.msg import PointCloud2

    spectra = client.collect(PointCloud2, '/rig1/gear_pair/spectrum')
    launched = subprocess.Popen(
        ['ros2', 'launch', ROOT / 'launch' / 'rig.launch.py', 'namespace:=rig1'],
        cwd=tmp_path,
        env={**ros_support.environment(domain), 'ROS_LOG_DIR': str(tmp_path)},
        start_new_session=True,
    )
    try:
        ros_support.wait_until(lambda: spectra, timeout=120, what='a spectrum')
    finally:
        os.killpg(launched.pid, signal.SIGINT)
        assert launched.wait(20) == 0
