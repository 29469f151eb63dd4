"""What the README says is true: its tables, its example, its commands."""

import ast
import itertools
import re
import runpy
import subprocess
import sys

import ros_support
from ros_support import ROOT

from gear_dynamics.__main__ import EXECUTABLES
from gear_dynamics.parameters.files import NODES

README = (ROOT / 'README.md').read_text()


def test_tables_and_example_are_up_to_date():
    tool = runpy.run_path(str(ROOT / 'tools' / 'readme.py'))
    for file in tool['FILES']:
        text = file.read_text(encoding='utf-8')
        assert tool['filled'](text) == text, f'{file.name}: run make readme'


def test_every_parameter_of_every_node_has_a_row():
    for lists in NODES.values():
        for about in (about for each in lists for about in each.parameters()):
            assert f'\n| `{about.name}` | ' in README
            assert about.description in README


def test_every_executable_has_a_row():
    for name in EXECUTABLES:
        assert f'\n| `{name}` | ' in README


def test_files_that_it_names_are_there():
    for name in re.findall(r'\]\(([\w/.]+)\)', README):
        assert (ROOT / name).is_file()


def test_targets_that_it_names_are_in_the_makefile():
    targets = set(re.findall(r'^([\w-]+):', (ROOT / 'Makefile').read_text(), re.MULTILINE))
    assert set(re.findall(r'^ +make ([a-z-]+)', README, re.MULTILINE)) <= targets


def test_python_examples_run():
    section = README.partition('\n## Python\n')[2].partition('\n## ')[0]
    examples = re.findall(r'```python\n(.*?)```', section, re.DOTALL)
    assert len(examples) == 2
    lines = [
        line
        for line in ''.join(examples).splitlines()
        if 'read_log' not in line and 'plot' not in line
    ]
    code = '\n'.join([*lines, 'print(runs.shape)'])
    done = subprocess.run(
        [sys.executable, '-c', code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    mean, *blocks, counters, shape = done.stdout.splitlines()
    # T2 / rb2 of the default load, the mean force over whole cycles without friction.
    assert abs(float(mean) - 2705.5) < 0.005 * 2705.5
    said = [re.fullmatch(r'0\.\d+ s: (\d+) mesh cycles, (\d+) flanks parted', x) for x in blocks]
    # From 300 to 314.16 rad/s at 200 rad/s2: 30.92 rad in 0.1 s, 34 cycles a revolution.
    assert sum(int(each[1]) for each in said) == 167
    assert sum(int(each[2]) for each in said) >= ast.literal_eval(counters)['contact_losses'] > 0
    assert shape == '(2, 5120)'


def test_example_hears_the_stream(domain):
    with ros_support.Process('gear_dynamics.nodes.sim', domain) as sim:
        sim.wait_for('streaming')
        listener = subprocess.Popen(
            [sys.executable, '-u', ROOT / 'examples' / 'listen.py'],
            env=ros_support.environment(domain),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            lines = [listener.stdout.readline() for _ in range(20)]
        finally:
            # SIGINT and SIGTERM may each meet a moment that ends in a traceback of rclpy's own.
            listener.kill()
        errors = listener.communicate(timeout=20)[1]
    assert errors == ''
    said = [re.fullmatch(r'(\d+)\.(\d{9}): (\d+) samples, ([\d.]+) m/s2 RMS\n', x) for x in lines]
    stamps = [int(each[1]) * 10**9 + int(each[2]) for each in said]
    assert {b - a for a, b in itertools.pairwise(stamps)} == {10_000_000}
    assert {each[3] for each in said} == {'512'}
    # The acceleration of the pinion, 794 m/s2 RMS in the long run.
    assert all(500 < float(each[4]) < 1200 for each in said)


def test_code_that_the_documents_for_developers_name_is_there():
    for file in ('CONTRIBUTING.md', 'docs/architecture.md'):
        text = (ROOT / file).read_text(encoding='utf-8')
        for name in set(re.findall(r'`([\w/]+(?:\.py|/))`', text)):
            assert (ROOT / name).exists() or any((ROOT / 'gear_dynamics').rglob(name)), name
        for name in re.findall(r'\]\(([\w/.]+)\)', text):
            assert (ROOT / name).is_file() or (ROOT / 'docs' / name).is_file(), name
