"""kill -9 of a writer at random moments: at most one second is lost."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from gear_dynamics.bag.reader import read_messages
from gear_dynamics.bag.recover import recover
from gear_dynamics.wire.tables import decode_table

SCRIPT = Path(__file__).with_name('writer_process.py')
ROOT = SCRIPT.parents[2]
DEFAULT_RATE, HIGH_RATE = 100.0, 1000.0
MOMENTS = np.random.default_rng(5).uniform(0.3, 2.5, 20).tolist()
COMPRESSIONS = ('none', 'zstd', 'lz4')
AT_ONCE = 4


def killed_writer(directory, compression, rate, threads, moment):
    """Run a writer, kill it `moment` seconds after its first block; return number, time lines."""
    environment = {**os.environ, 'PYTHONPATH': str(ROOT)}
    command = [sys.executable, str(SCRIPT), str(directory), compression, str(rate), str(threads)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment)
    try:
        first = process.stdout.readline()
        time.sleep(moment)
    finally:
        process.send_signal(signal.SIGKILL)
        rest, _ = process.communicate()
    lines = (first + rest).decode().splitlines()
    complete = [line.split() for line in lines if len(line.split()) == 2]
    return {int(number): float(at) for number, at in complete}


@pytest.fixture(scope='module')
def killed(tmp_path_factory):
    """Return directory and what was handed in of each of some writers, run side by side."""
    directories = [tmp_path_factory.mktemp('killed') for _ in MOMENTS]

    def run(number):
        rate = HIGH_RATE if number % 5 == 0 else DEFAULT_RATE
        compression = COMPRESSIONS[number % len(COMPRESSIONS)]
        threads = 0 if rate == HIGH_RATE else number % 3
        return killed_writer(directories[number], compression, rate, threads, MOMENTS[number])

    with ThreadPoolExecutor(AT_ONCE) as pool:
        return list(zip(directories, pool.map(run, range(len(MOMENTS))), strict=True))


@pytest.mark.parametrize('number', range(len(MOMENTS)))
def test_kill_loses_at_most_a_second(tmp_path, killed, number):
    directory, handed_in = killed[number]
    (folder,) = directory.iterdir()
    damage = []
    messages = list(read_messages(folder, on_damage=damage.append))
    numbers = [message.publish_time for message in messages]
    assert numbers == list(range(len(numbers)))
    assert damage
    last_kept = handed_in[numbers[-1]] if numbers else handed_in[0]
    assert max(handed_in.values()) - last_kept <= 1.0
    assert all(decode_table(m.data).stamp_ns == m.publish_time for m in messages)
    if numbers:
        assert recover(folder, tmp_path / 'sound').messages == len(numbers)
