"""The `study` command: stopped and given again, on a full disk, and with wrong input."""

import functools
import inspect
import os
import re
import resource
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from gear_dynamics import study
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.study.command import main
from gear_dynamics.study.declaration import defaults, study_module, study_names
from gear_dynamics.study.experiments.basins import SCOUTS
from gear_dynamics.study.warm_up import warm_up

ROWS = 24
COMMAND = ['basins', '--size', str(ROWS), '--transient', '400', '--quiet']
TASKS = SCOUTS + 1 + ROWS
"""Rows of the coarse picture, one attractor that is assessed, and rows of the picture."""

STOPPED = 'study: stopped; the same command goes on from what is finished'


def start(output, *options, **how):
    command = [sys.executable, '-m', 'gear_dynamics', 'study', *COMMAND, *options]
    return subprocess.Popen(
        [*command, '--output', str(output)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **how,
    )


def last_line(text):
    """Return the last line, as the one before may tell that all is compiled."""
    return text.splitlines()[-1]


def finished(output):
    return len(list(output.glob('.basins_parts/*.part')))


@pytest.fixture(scope='module')
def whole():
    """Give the result of the study without any stop; all is compiled before."""
    warm_up()
    return study.basins(study.friction_chaos(), size=ROWS, transient=400)


def test_a_stopped_study_goes_on_and_loses_nothing(whole, tmp_path):
    """Ctrl-C, then SIGTERM, then SIGKILL, each in the middle."""
    for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 130), (signal.SIGKILL, -9)):
        before = finished(tmp_path)
        with start(tmp_path) as process:
            while finished(tmp_path) < before + 3:
                assert process.poll() is None
                time.sleep(0.01)
            process.send_signal(number)
            errors = process.communicate()[1]
        assert process.returncode == code, errors
        if code == 130:
            assert last_line(errors) == STOPPED
    kept = finished(tmp_path)
    assert 9 <= kept < TASKS
    # What carried the lock of the killed one.
    assert (tmp_path / '.basins_lock').exists()
    with start(tmp_path) as process:
        output, errors = process.communicate()
    assert process.returncode == 0, errors
    assert f'\n{kept} of {TASKS} tasks had been finished before.\n' in output
    assert output.startswith(whole.text)
    with np.load(tmp_path / 'basins.npz') as stored:
        for name, array in whole.arrays.items():
            np.testing.assert_array_equal(stored[name], array, name)
    names = sorted(path.name for path in tmp_path.iterdir())
    tables = ['basins_attractors.csv', 'basins_convergence.csv', 'basins_points.csv']
    assert names == ['basins.csv', 'basins.npz', 'basins.png', 'basins.txt', *tables]


def test_a_second_study_in_the_folder_is_refused_and_the_first_goes_on(whole, tmp_path):
    """With the same arguments, and with others."""
    with start(tmp_path) as first:
        while finished(tmp_path) < 1:
            assert first.poll() is None
            time.sleep(0.01)
        for others in ([], ['--transient', '3']):
            with start(tmp_path, *others) as second:
                errors = second.communicate()[1]
            assert second.returncode == 2
            assert errors == (
                f'study: {tmp_path}: another study basins is at work there: wait for its end, or '
                'name another directory with --output\n'
            )
        assert first.poll() is None
        output, errors = first.communicate()
    assert first.returncode == 0, errors
    assert output.startswith(whole.text)
    assert not list(tmp_path.glob('.*'))


def test_a_full_disk_leaves_no_half_of_a_result_and_loses_nothing(whole, tmp_path):
    def small_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (25_000, 25_000))

    with start(tmp_path, preexec_fn=small_files) as process:
        errors = process.communicate()[1]
    assert process.returncode == 2
    assert re.fullmatch(
        r'study: \S+: File too large: make room, and the same command goes on .*', last_line(errors)
    )
    assert [path.name for path in tmp_path.iterdir()] == ['.basins_parts']
    with start(tmp_path) as process:
        output = process.communicate()[0]
    assert process.returncode == 0
    assert f'\n{TASKS} of {TASKS} tasks had been finished before.\n' in output


def test_first_compilation_is_announced_and_ends_at_a_signal(tmp_path):
    environment = {**os.environ, 'NUMBA_CACHE_DIR': str(tmp_path / 'cache')}
    with start(tmp_path, env=environment) as process:
        line = process.stderr.readline()
        process.send_signal(signal.SIGTERM)
        errors = process.communicate()[1]
    assert line.startswith('study: compiling the model for this machine; only a first start')
    assert process.returncode == 130
    assert last_line(errors) == STOPPED


@pytest.mark.parametrize(
    'file', ['attractor.npz', 'attractor.csv', 'attractor.png', 'attractor_exponents.csv']
)
def test_a_result_that_exists_is_not_overwritten(tmp_path, capsys, file):
    (tmp_path / file).write_bytes(b'precious')
    assert main(['attractor', '--output', str(tmp_path)]) == 2
    assert capsys.readouterr().err == (
        f'study: {tmp_path}/{file} exists: move it, or name another directory with --output\n'
    )
    assert (tmp_path / file).read_bytes() == b'precious'
    assert [path.name for path in tmp_path.iterdir()] == [file]


@pytest.mark.parametrize(
    'arguments',
    [
        'lyapunov --frictions -0.1',
        'bifurcation --parameter foo --begin 0 --end 1',
        'spectrum --fastest 6000',
        'response --begin -1',
    ],
)
def test_a_wrong_value_is_refused_before_anything_is_compiled(tmp_path, arguments):
    cache = tmp_path / 'cache'
    command = [sys.executable, '-m', 'gear_dynamics', 'study', *arguments.split()]
    done = subprocess.run(
        [*command, '--output', str(tmp_path / 'results')],
        env={**os.environ, 'NUMBA_CACHE_DIR': str(cache)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert re.fullmatch(r'study: .*\n', done.stderr), done.stderr
    assert not list(cache.rglob('*.nb*'))


def test_help_shows_the_defaults_of_the_functions():
    shown = defaults('bifurcation')
    # Those that are None in the function depend on what is swept.
    assert shown == {
        'frictions': (0.0, 0.03), 'parameter': 'w', 'begin': 0.4, 'end': 2.0, 'count': 600,
        'transient': 300, 'cycles': 150,
    }  # fmt: skip
    for name in study_names():
        taken = inspect.signature(getattr(study, name)).parameters
        assert set(defaults(name)) == set(taken) - {'point', 'runner'}


def test_help_loads_neither_compiler_nor_scipy_nor_matplotlib():
    """A study is one module; all are imported for the help."""
    code = (
        'import sys\n'
        'from gear_dynamics.study.command import main\n'
        'try: main(["--help"])\n'
        'except SystemExit: pass\n'
        'print(sorted({"numba", "matplotlib", "scipy"} & set(sys.modules)))'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith('[]\n')
    assert all(f'\n    {name}' in done.stdout for name in study_names())


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ('basins --size 1', '--size is 1: it must be an integer, 2 or more'),
        ('basins --reach nan 1', '--reach is nan: it must be a finite number'),
        ('basins --reach 0 0', 'reach is 0 0: both must be above 0'),
        ('basins --reach 2 -1', 'reach is 2 -1: both must be above 0'),
        ('bifurcation --transient -1', '--transient is -1: it must be an integer, 0 or more'),
        ('bifurcation --begin 2 --end 1', 'begin 2 is not below end 1: exchange them'),
        ('response --begin 2', 'begin 2 is not below end 1.5: exchange them'),
        ('spectrum --slowest 2000', 'slowest 2000 is not below fastest 1200: exchange them'),
        (
            'bifurcation --parameter load_torque --begin 100',
            'load_torque has no range of its own: give begin and end; its value is 455.515 N m',
        ),
        ('bifurcation --parameter foo', 'foo cannot be varied; known are w, speed'),
        (
            'bifurcation --parameter friction_coefficient --begin 0 --end 0.1 --frictions 0',
            'frictions would have no effect, as friction_coefficient is swept: leave them out',
        ),
        (
            'bifurcation --parameter load_torque --begin 1 --end 2 --set load_torque=5',
            'as bifurcation sweeps load_torque: give --begin and --end',
        ),
        (
            'bifurcation --parameter friction_coefficient --set friction_coefficient=0.1',
            'as bifurcation sweeps friction_coefficient: give --begin and --end',
        ),
        ('bifurcation --set w=1', '--set w=1 would have no effect, as bifurcation sweeps w'),
        ('bifurcation --parameter speed --set w=1', 'as bifurcation sweeps speed'),
        ('response --set speed=100', '--set speed=100 would have no effect, as response sweeps w'),
        ('response --set w=1', 'as response sweeps w: give --begin and --end'),
        ('response --end inf', '--end is inf: it must be a finite number'),
        ('attractor --set w=nan', 'w is nan: speed is nan: it must be a finite number from 0'),
        ('lyapunov --set w=0', 'w is 0: speed is 0: it must be positive'),
        ('lyapunov --frictions 0 -1', 'friction_coefficient is -1.0: it must be a finite number'),
        ('lyapunov --frictions 0 0', 'friction_coefficient 0 is given 2 times: give it once'),
        ('attractor --frictions 0 0.1 0.1', 'friction_coefficient 0.1 is given 2 times'),
        ('spectrum --frictions 0.03 0.03', 'friction_coefficient 0.03 is given 2 times'),
        ('bifurcation --frictions 0 0', 'friction_coefficient 0 is given 2 times'),
        ('attractor --set friction_coefficient=0.1', 'have no effect: give attractor --frictions'),
        ('spectrum --set load_torque=nan', 'load_torque is nan: it must be a finite number'),
        ('spectrum --params {}', 'speed is 0: it must be positive, as a study counts mesh cycles'),
        ('basins --output {}', 'Not a directory: name another directory with --output'),
    ],
)
def test_wrong_input_is_refused_in_one_line(tmp_path, capsys, arguments, words):
    file = tmp_path / 'standing.yaml'
    file.write_text('/**: {ros__parameters: {speed: 0.0, load_torque: 150.0}}')
    output = [] if '--output' in arguments else ['--output', str(tmp_path)]
    assert main([*arguments.format(file).split(), *output]) == 2
    (error,) = capsys.readouterr().err.splitlines()
    assert error.startswith('study: ')
    assert words in error
    assert [path.name for path in tmp_path.iterdir()] == ['standing.yaml']


def operation_of(tmp_path, monkeypatch, arguments):
    """Return what `study basins` is asked to study, given a file that `to_yaml` wrote."""
    asked = []

    @functools.wraps(study_module('basins').basins)
    def basins(point, **options):
        asked.append(point)
        raise ValueError('enough')

    monkeypatch.setattr(study_module('basins'), 'basins', basins)
    path = tmp_path / 'pair.yaml'
    GearPair(friction_coefficient=0.01).to_yaml(path)
    command = ['basins', '--params', str(path), '--output', str(tmp_path / 'out')]
    assert main([*command, *arguments.split()]) == 2
    return asked[0] if asked else None


def test_parameter_file_without_speed_and_torque_wants_them(tmp_path, monkeypatch, capsys):
    """One that `to_yaml` wrote has neither: the defaults must not be taken in silence."""
    assert operation_of(tmp_path, monkeypatch, '') is None
    assert 'pair.yaml has no speed: give it, such as --set speed=104.72' in capsys.readouterr().err
    assert operation_of(tmp_path, monkeypatch, '--set speed=120') is None
    assert 'has no load_torque: give it, such as --set load_torque=150' in capsys.readouterr().err
    given = operation_of(tmp_path, monkeypatch, '--set speed=120 --set load_torque=70.5')
    assert (given.speed, given.load_torque) == (120.0, 70.5)
    assert given.pair.friction_coefficient == 0.01
    given = operation_of(tmp_path, monkeypatch, '--set w=0.5 --set load_torque=70.5')
    assert given.frequency_ratio == pytest.approx(0.5)


def test_any_parameter_of_the_pair_can_be_set(tmp_path, monkeypatch):
    arguments = '--set speed=120 --set load_torque=70 --set mesh_stiffness=constant'
    further = ' --set damping_in_gap=true --set pinion_teeth=33 --set half_backlash=1e-4'
    pair = operation_of(tmp_path, monkeypatch, arguments + further).pair
    assert (pair.mesh_stiffness, pair.damping_in_gap) == ('constant', True)
    assert (pair.pinion_teeth, pair.half_backlash) == (33, 1e-4)
