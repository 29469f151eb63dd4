"""Logs made to exhaust memory, time or patience: read or refused by every reader, in bounds."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name('hostile_support.py')
ROOT = SCRIPT.parents[2]
MEMORY = 800
"""Largest memory of a process that reads them all [MB]; most is a chunk, as read and unpacked."""


@pytest.mark.parametrize(
    'words',
    [
        ['bombs:'],
        [f'lengths: {value} at' for value in (2**36, 2**63, 2**64 - 1)],
        ['lengths: CHUNK of', 'lengths: index', 'indexes:'],
        ["'\\x00'", '20 000', 'no slash', 'names: time', 'clouds:', 'messages:'],
        ["topic 'xxx", "topic 'a", "topic '/a", "topic '..", "QoS '[", "text '["],
    ],
    ids=['bombs', 'lengths', 'indexes', 'messages', 'names'],
)
def test_every_reader_reads_or_refuses_in_one_line(tmp_path, words):
    path = os.pathsep.join([str(ROOT), str(SCRIPT.parent)])
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(tmp_path), *words],
        env={**os.environ, 'PYTHONPATH': path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    *failures, last = done.stdout.splitlines()
    assert failures == []
    files, memory = map(int, last.split())
    assert files > 3
    assert memory < MEMORY
