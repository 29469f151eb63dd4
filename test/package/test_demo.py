import os
import re
import signal
import subprocess
import sys

import numpy as np
import pytest
import ros_support
from ros_support import ROOT

from demo.report import mesh_frequency
from demo.stream import Child, DemoError
from gear_dynamics.bag.reader import read_log


def start(folder, domain):
    return subprocess.Popen(
        [sys.executable, '-m', 'demo'],
        cwd=folder,
        env={**ros_support.environment(domain), 'PYTHONPATH': str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def test_demo_streams_logs_and_tells_what_happened(domain, tmp_path):
    demo = start(tmp_path, domain)
    said = demo.communicate(timeout=280)[0]
    assert demo.returncode == 0, said
    # 24 s of 51 200 samples/s in blocks of 512
    assert 'Streamed 2400 blocks of 512 samples, 24 s' in said
    assert 'The log has no gaps.' in said
    # 34 teeth at 1000 and 5100 rpm
    found = [float(hertz) for hertz in re.findall(r'the spectrum shows ([\d.]+) Hz', said)]
    np.testing.assert_allclose(found, [34 * 1000 / 60, 34 * 5100 / 60], rtol=1e-3)
    # In contact over 1.73 teeth, and ringing for a moment after it.
    assert 'Tooth 20 of the pinion was cracked, which is in contact from 20 to 21.7' in said
    assert 20 <= float(re.search(r'is greatest at ([\d.]+)\.', said)[1]) <= 22
    assert read_log(tmp_path / re.search(r'Log: +(\S+)', said)[1], end=0.1)['t'][0] == 0.0
    picture = tmp_path / re.search(r'Picture: +(\S+)', said)[1]
    assert picture.read_bytes().startswith(b'\x89PNG')


def test_interrupted_demo_ends_with_its_processes(domain, tmp_path):
    demo = start(tmp_path, domain)
    said = tmp_path / 'demo' / 'output' / 'sim.txt'
    ros_support.wait_until(lambda: said.exists() and 'streaming' in said.read_text(), 120)
    os.killpg(demo.pid, signal.SIGINT)  # what Ctrl-C does
    said = demo.communicate(timeout=60)[0]
    assert demo.returncode == 130
    assert 'Traceback' not in said
    assert said.splitlines()[-1] == 'Stopped. What was logged so far is in demo/output/.'
    with pytest.raises(ProcessLookupError):
        os.killpg(demo.pid, 0)


def test_process_that_ends_is_told_of_in_one_line(tmp_path):
    with Child('none', tmp_path, {}) as child, pytest.raises(DemoError) as failure:
        ros_support.wait_until(lambda: child.check())
    line = str(failure.value)
    assert line.startswith('none ended with exit code 1: ')
    assert 'gear_dynamics.nodes.none' in line
    assert '\n' not in line


def tones(*harmonics, mesh, noise=0.0):
    """Return frequencies and the amplitude spectrum of harmonics, {number: amplitude}, in noise."""
    rate, length = 51200.0, 8192
    t = np.arange(length) / rate
    x = noise * np.random.default_rng(1).standard_normal(length)
    for number, amplitude in harmonics:
        x = x + amplitude * np.sin(2 * np.pi * number * mesh * t + number)
    window = np.hanning(length)
    return np.fft.rfftfreq(length, 1 / rate), abs(np.fft.rfft(x * window)) * 2 / window.sum()


@pytest.mark.parametrize('mesh', [283.3, 566.7, 2890.0])
def test_mesh_frequency_is_found_though_another_harmonic_is_higher(mesh):
    frequency, amplitude = tones((1, 1.0), (2, 7.0), (3, 20.0), (5, 4.0), mesh=mesh, noise=0.1)
    assert abs(mesh_frequency(frequency, amplitude) - mesh) < 0.2


def test_no_mesh_frequency_is_found_in_silence():
    frequency, amplitude = tones(mesh=100.0)
    assert np.isnan(mesh_frequency(frequency, amplitude))
