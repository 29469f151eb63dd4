"""One command runs a rig: it passes signals on, restarts what dies, and says how all ended."""

import os
import re
import signal
from pathlib import Path

import pytest
import ros_support

from gear_dynamics.nodes import rig

RIG = 'gear_dynamics.nodes.rig'


def children(pid):
    """Return the process ids of the children of a process by the name of their executable."""
    found = {}
    for child in Path(f'/proc/{pid}/task/{pid}/children').read_text().split():
        words = Path(f'/proc/{child}/cmdline').read_text().split('\0')
        found[words[words.index('gear_dynamics') + 1]] = int(child)
    return found


class Stub:
    """Stands in for a process that ends with the given codes, start after start."""

    def __init__(self, monkeypatch, codes):
        self.codes = codes
        self.starts = []
        monkeypatch.setattr(rig.subprocess, 'Popen', self._popen)
        monkeypatch.setattr(rig, 'LOOK', 0.0)
        monkeypatch.setattr(rig.signal, 'signal', lambda *_: None)

    def _popen(self, command, start_new_session):
        name = command[3]
        self.starts.append(name)
        left = self.codes[name]
        code = left.pop(0) if left else None
        return StubProcess(code)


class StubProcess:
    def __init__(self, code):
        self.code = code

    def poll(self):
        return self.code

    def send_signal(self, number):
        self.code = 0

    def wait(self, timeout):
        return self.code


@pytest.mark.parametrize(
    ('codes', 'exit_code', 'starts'),
    [
        ({'analyzer': [], 'sim': [0]}, 0, 1),
        ({'analyzer': [], 'sim': [2]}, 2, 1),
        ({'analyzer': [], 'sim': [-9, 1, 0]}, 0, 3),
        ({'analyzer': [], 'sim': [-9, -9, -9, -9]}, 1, 4),
    ],
)
def test_what_dies_is_started_again_at_most_thrice(monkeypatch, capsys, codes, exit_code, starts):
    stub = Stub(monkeypatch, codes)
    assert rig.ProcessGroup().run([('analyzer', []), ('sim', [])]) == exit_code
    assert stub.starts.count('sim') == starts
    lines = capsys.readouterr().err.splitlines()
    assert sum('starting it again' in line for line in lines) == starts - 1
    assert lines[-2].startswith('rig: analyzer ended with code 0')
    assert lines[-1].startswith('rig: sim ')


def test_arguments_reach_the_nodes(tmp_path):
    file = tmp_path / 'rig.yaml'
    file.write_text('')
    arguments = rig._parser().parse_args(
        ['--params', str(file), '--speed', '300', '--namespace', 'a', '--no-log', '--dashboard']
    )
    found = dict(rig.commands(arguments))
    assert list(found) == ['analyzer', 'dashboard', 'sim']
    for words in found.values():
        assert words[:3] == ['--ros-args', '--log-level', 'info']
        assert ['--params-file', str(file), '-r', '__ns:=/a'] == words[3:7]
    assert found['analyzer'][7:] == ['-p', 'log:=false']
    assert found['sim'][7:] == ['-p', 'speed:=300.0']


def test_a_missing_file_is_refused(capsys):
    with pytest.raises(SystemExit) as error:
        rig.main(['--params', 'none.yaml'])
    assert error.value.code == 2
    assert 'none.yaml: there is no such file' in capsys.readouterr().err


def test_rig_streams_restarts_and_closes(domain, client, tmp_path):
    from sensor_msgs.msg import PointCloud2

    spectra = client.collect(PointCloud2, '/a/gear_pair/spectrum', raw=True)
    options = ['--namespace', 'a', '--log-directory', str(tmp_path)]
    with ros_support.Process(RIG, domain, command=options, ros=False) as process:
        ros_support.wait_until(lambda: spectra, 120, 'a spectrum')
        os.kill(children(process.pid)['sim'], signal.SIGKILL)
        process.wait_for('starting it again, 1 of 3')
        heard = len(spectra)
        ros_support.wait_until(lambda: len(spectra) > heard + 1, 120, 'spectra of the new sim')
        assert process.stop(timeout=20) == 0
        last = process.output.splitlines()[-2:]
    assert re.fullmatch(r'rig: analyzer ended with code 0 after \d+ s', last[0])
    assert re.fullmatch(r'rig: sim ended with code 0 after \d+ s, restarts: 1', last[1])
    assert list(tmp_path.glob('gear_log_a_*'))
