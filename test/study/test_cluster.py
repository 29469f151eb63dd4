"""Studies on a Dask cluster of real processes, some of which are killed."""

import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.study import cache
from gear_dynamics.study import cluster as clusters
from gear_dynamics.study.cluster import Cluster, ClusterError
from gear_dynamics.study.command import main
from gear_dynamics.study.experiments.basins import SCOUTS
from gear_dynamics.study.tasks import Runner

dask = pytest.importorskip('dask', reason='dask is not installed')
distributed = pytest.importorskip('distributed', reason='dask[distributed] is not installed')

CHAOS = study.friction_chaos()


def ends_its_worker(x):
    os._exit(1)


@pytest.fixture(scope='module')
def address():
    """Give the address of a scheduler with two workers, each a process that comes back if lost."""
    with (
        dask.config.set({'distributed.scheduler.allowed-failures': 1}),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            dashboard_address=None,
            silence_logs=50,
            env={'NUMBA_NUM_THREADS': '1'},
        ) as cluster,
    ):
        yield cluster.scheduler_address


@pytest.fixture
def scheduler(tmp_path):
    """Give the address and the process of a scheduler without workers."""
    file = tmp_path / 'scheduler.json'
    command = [sys.executable, '-m', 'distributed.cli.dask_scheduler', '--no-dashboard']
    command += ['--host', '127.0.0.1', '--port', '0', '--scheduler-file', str(file)]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        try:
            while not file.exists():
                assert process.poll() is None
                time.sleep(0.05)
            yield json.loads(file.read_text())['address'], process
        finally:
            process.kill()


def kill_a_busy_worker(address, runner, killed):
    """Kill a worker in the middle of a task, once the study has a first result."""
    with distributed.Client(address, set_as_default=False) as client:
        pids = client.run(os.getpid)
        while runner.computed == 0:
            time.sleep(0.01)
        while not (busy := [worker for worker, tasks in client.processing().items() if tasks]):
            time.sleep(0.01)
        killed.append(pids[busy[0]])
        os.kill(killed[0], signal.SIGKILL)


def test_a_worker_killed_in_the_middle_leaves_every_bit_as_it_was(address, tmp_path):
    size = {'size': 8, 'transient': 400}
    runner, killed = Runner(tmp_path, address), []
    killer = threading.Thread(target=kill_a_busy_worker, args=(address, runner, killed))
    killer.start()
    there = study.basins(CHAOS, **size, runner=runner)
    killer.join()
    runner.close()
    # The coarse picture, the one attractor that is assessed, and the picture.
    assert runner.computed == SCOUTS + 1 + 8
    with pytest.raises(ProcessLookupError):
        os.kill(killed[0], 0)
    here = study.basins(CHAOS, **size)
    assert there.text == here.text
    for name, array in here.arrays.items():
        np.testing.assert_array_equal(there.arrays[name], array, name)


@pytest.mark.parametrize(
    ('name', 'size'),
    [
        ('lyapunov', {'initial_states': 2, 'transient': 10, 'cycles': 200}),
        (
            'bifurcation',
            {'begin': 1.15, 'end': 1.2, 'count': 22, 'transient': 20, 'cycles': 100},
        ),
    ],
)
def test_results_are_the_same_on_a_cluster_to_the_last_bit(address, name, size):
    run = getattr(study, name)
    runner = Runner(cluster=address)
    there = run(CHAOS, [0.0, 0.05], **size, runner=runner)
    runner.close()
    here = run(CHAOS, [0.0, 0.05], **size)
    for column, array in here.arrays.items():
        assert there.arrays[column].tobytes() == array.tobytes(), column


def test_a_task_that_ends_its_workers_is_given_up(address):
    cluster = Cluster(address)
    with pytest.raises(ClusterError, match='2 workers died with the same ends_its_worker') as error:
        list(cluster.map(ends_its_worker, [{'x': 1}], [0]))
    cluster.close()
    assert 'the same command goes on' in str(error.value)


def test_a_worker_with_other_code_is_refused(address, monkeypatch):
    code = {**cache.code(), 'numpy': '0.1'}
    monkeypatch.setattr(clusters, 'code', lambda: code)
    cluster = Cluster(address)
    words = f'the worker at tcp.* has numpy {np.__version__}, not 0.1: install the same there'
    with pytest.raises(ClusterError, match=words):
        list(cluster.map(study.default_operating_point, [{}], [0]))
    cluster.close()


def test_a_scheduler_without_the_package_is_refused(scheduler):
    cluster = Cluster(scheduler[0])
    with pytest.raises(ClusterError, match='or a worker has no module test_cluster: install'):
        list(cluster.map(ends_its_worker, [{'x': 1}], [0]))
    cluster.close()


def test_a_lost_scheduler_is_told(scheduler):
    address, process = scheduler
    cluster = Cluster(address)
    threading.Timer(1.0, process.kill).start()
    with pytest.raises(ClusterError, match=f'scheduler at {address} was lost: start it again'):
        list(cluster.map(study.default_operating_point, [{}], [0]))
    cluster.close()


def test_it_is_said_if_there_are_no_workers(scheduler, monkeypatch, capsys):
    address, process = scheduler
    monkeypatch.setattr(clusters, 'PATIENCE', 0.1)
    cluster = Cluster(address)
    threading.Timer(1.0, process.kill).start()
    with pytest.raises(ClusterError):
        list(cluster.map(study.default_operating_point, [{}], [0]))
    cluster.close()
    lines = capsys.readouterr().err.splitlines()
    assert lines == [f'study: waiting: the Dask scheduler at {address} has no workers: start one']


@pytest.mark.parametrize('address', ['127.0.0.1:1', '127.0.0.1', 'nowhere:8786'])
def test_an_address_without_a_scheduler_is_refused_in_one_line(tmp_path, capsys, address):
    assert main(['basins', '--cluster', address, '--output', str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f'study: no Dask scheduler answers at {address} (')
    assert error.endswith('): start one with "dask scheduler", or give "local"\n')
    assert error.count('\n') == 1
    assert not list(tmp_path.iterdir())
