import signal

import pytest
import ros_support


def pytest_configure():
    # A shell that runs in the background ignores SIGINT, and so would all that the tests start.
    signal.signal(signal.SIGINT, signal.default_int_handler)


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
