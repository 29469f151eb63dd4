"""The launch file, with the `ros2` command where there is one (the wheels on PyPI have none)."""

import os
import shutil
import signal
import subprocess

import pytest
import ros_support
from ros_support import ROOT

needs_ros2 = pytest.mark.skipif(shutil.which('ros2') is None, reason='there is no ros2 command')


@needs_ros2
@pytest.mark.parametrize(
    ('argument', 'words'),
    [
        ('params:=none.yaml', "params is 'none.yaml': there is no such file"),
        ('speed:=9000', 'speed is 9000.0'),
        ('log_directory:=/no/such', "log_directory is '/no/such'"),
    ],
)
def test_wrong_argument_ends_the_whole_launch_with_an_error(domain, tmp_path, argument, words):
    done = subprocess.run(
        ['ros2', 'launch', ROOT / 'launch' / 'rig.launch.py', argument],
        cwd=tmp_path,
        env={**ros_support.environment(domain), 'ROS_LOG_DIR': str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
    )
    assert done.returncode == 1
    assert words in done.stdout


@needs_ros2
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


@needs_ros2
def test_missing_robot_description_is_an_error(domain, tmp_path):
    done = subprocess.run(
        ['ros2', 'launch', ROOT / 'launch' / 'description.launch.py', 'urdf:=none.urdf'],
        cwd=tmp_path,
        env={**ros_support.environment(domain), 'ROS_LOG_DIR': str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
    )
    assert done.returncode == 1
    assert "urdf is 'none.urdf': there is no such file" in done.stdout
