"""Real nodes in processes of their own, each test in a ROS domain of its own."""

import contextlib
import fcntl
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

# The ports of domains 102 to 215 lie where Linux takes ports for outgoing connections; those above
# are left to the demo and the benchmarks.
DOMAINS = range(1, 102)


@contextlib.contextmanager
def free_domain():
    """Yield a domain id that no other test run on this machine uses."""
    folder = Path(tempfile.gettempdir()) / 'gear_dynamics_domains'
    folder.mkdir(exist_ok=True)
    for domain in DOMAINS:
        with open(folder / f'{domain}.lock', 'w') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            yield domain
            return
    raise RuntimeError('every ROS domain is taken')


def environment(domain):
    """Return the environment of a node under test."""
    return {
        **os.environ,
        'ROS_DOMAIN_ID': str(domain),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'PYTHONUNBUFFERED': '1',
    }


def wait_until(condition, timeout=30.0, what='the condition'):
    """Wait until `condition()` is true and return what it returned."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f'{what} did not come within {timeout} s')


class Process:
    """A Python module or script run by this interpreter from the source tree; killed at the end.

    `parameters` and `arguments` are ROS parameters and further ROS arguments; with `ros` False the
    program takes none.
    """

    def __init__(self, module, domain, parameters=None, arguments=(), command=(), ros=True):
        self._output = tempfile.TemporaryFile()  # noqa: SIM115  (closed in __exit__)
        given = [f'{name}:={_text(value)}' for name, value in (parameters or {}).items()]
        words = ['--ros-args', *(part for each in given for part in ('-p', each)), *arguments]
        what = [module] if module.endswith('.py') else ['-m', module]
        self._process = subprocess.Popen(
            [sys.executable, *what, *command, *(words if ros else [])],
            cwd=ROOT,
            env=environment(domain),
            stdout=self._output,
            stderr=subprocess.STDOUT,
        )

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        if error[0] is not None:
            print(self.output)
        self._output.close()

    @property
    def pid(self):
        return self._process.pid

    @property
    def running(self):
        return self._process.poll() is None

    @property
    def output(self):
        return os.pread(self._output.fileno(), 10_000_000, 0).decode(errors='replace')

    def wait_for(self, text, timeout=60.0):
        """Wait until the process has written `text`."""
        wait_until(lambda: text in self.output, timeout, f'{text!r}')

    def wait(self, timeout=30.0):
        """Return the exit code."""
        return self._process.wait(timeout)

    def send(self, number):
        self._process.send_signal(number)

    def stop(self, number=signal.SIGINT, timeout=10.0):
        """Signal the process and return its exit code."""
        self.send(number)
        return self.wait(timeout)


def _text(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


class Client:
    """A node inside the test: listens, publishes and calls services."""

    def __init__(self, domain, name='client'):
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
        self.context = rclpy.Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        self.node = rclpy.create_node(name, context=self.context)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def _spin(self):
        while self.context.ok():
            try:
                self._executor.spin_once(timeout_sec=0.1)
            except Exception:
                if self.context.ok():
                    raise

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.context.try_shutdown()
        self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()

    def collect(self, message_type, topic, qos=1000, raw=False):
        """Subscribe and return the list that messages are appended to."""
        messages = []
        self.node.create_subscription(message_type, topic, messages.append, qos, raw=raw)
        return messages

    def publisher(self, message_type, topic, qos=10):
        """Return a publisher, once somebody listens to it."""
        publisher = self.node.create_publisher(message_type, topic, qos)
        wait_until(publisher.get_subscription_count, what=f'a listener to {topic}')
        return publisher

    def call(self, service_type, name, request, timeout=10.0):
        """Call a service and return its response."""
        client = self.node.create_client(service_type, name)
        assert client.wait_for_service(timeout), f'no service {name}'
        done = threading.Event()
        future = client.call_async(request)
        future.add_done_callback(lambda _: done.set())
        assert done.wait(timeout), f'{name} did not answer'
        return future.result()

    def set_parameters(self, node, **values):
        """Set parameters of another node and return the results, in order."""
        from rcl_interfaces.srv import SetParameters
        from rclpy.parameter import Parameter

        request = SetParameters.Request()
        request.parameters = [
            Parameter(name, value=value).to_parameter_msg() for name, value in values.items()
        ]
        return self.call(SetParameters, f'{node}/set_parameters', request).results
