import pytest
import ros_support


@pytest.fixture
def domain():
    """Give the test a ROS domain of its own; skip it where there is no ROS."""
    pytest.importorskip('rclpy', reason='rclpy is not installed')
    with ros_support.free_domain() as number:
        yield number


@pytest.fixture
def client(domain):
    """Give the test a node of its own that listens, publishes and calls services."""
    with ros_support.Client(domain) as node:
        yield node
