"""The package as colcon, pip and ros2 run see it."""

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from ros_support import ROOT

from gear_dynamics.__main__ import EXECUTABLES

SOURCES = (
    'package.xml',
    'setup.py',
    'setup.cfg',
    'pyproject.toml',
    'README.md',
    'LICENSE',
    'resource',
    'config',
    'launch',
    'launchers',
    'urdf',
    'gear_dynamics',
)


def run(*command, **options):
    done = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, timeout=280, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope='module')
def source(tmp_path_factory):
    """Return a copy of the package, so that nothing is built in the tree."""
    copy = tmp_path_factory.mktemp('workspace') / 'src' / 'gear_dynamics'
    copy.mkdir(parents=True)
    for name in SOURCES:
        if (ROOT / name).is_dir():
            ignored = shutil.ignore_patterns('__pycache__')
            shutil.copytree(ROOT / name, copy / name, symlinks=True, ignore=ignored)
        else:
            shutil.copy(ROOT / name, copy / name)
    return copy


def test_launchers_are_one_script_under_the_name_of_each_executable():
    launchers = list((ROOT / 'launchers').iterdir())
    assert {path.name for path in launchers} == set(EXECUTABLES)
    assert len({path.read_bytes() for path in launchers}) == 1


def assert_installed(prefix):
    """What `ros2 run` and `ros2 launch` look for is below the prefix."""
    for name in EXECUTABLES:
        assert os.access(prefix / 'lib' / 'gear_dynamics' / name, os.X_OK)
    share = prefix / 'share'
    marker = share / 'ament_index' / 'resource_index' / 'packages' / 'gear_dynamics'
    assert marker.is_file()
    for name in (
        'package.xml',
        'config/default.yaml',
        'config/fastdds.xml',
        'launch/rig.launch.py',
        'urdf/gear_pair.urdf',
    ):
        assert (share / 'gear_dynamics' / name).is_file()


def outside(prefix):
    """Return an environment in which this source tree and this virtual environment are unknown."""
    kept = {name: os.environ[name] for name in ('HOME', 'LANG') if name in os.environ}
    return {**kept, 'PATH': f'{Path(sys.executable).parent}:/usr/bin:/bin', **prefix}


def test_manifest_keeps_the_rules_of_its_format():
    package = pytest.importorskip('catkin_pkg.package', reason='catkin_pkg is not installed')
    warnings = []
    parsed = package.parse_package(str(ROOT / 'package.xml'), warnings=warnings)
    parsed.validate(warnings)
    assert not warnings
    assert parsed.package_format == 3
    assert parsed.get_build_type() == 'ament_python'


def test_colcon_takes_it_for_an_ament_python_package(source):
    pytest.importorskip('colcon_ros', reason='colcon is not installed')
    colcon = [sys.executable, '-m', 'colcon', '--log-base', '/dev/null']
    listed = run(*colcon, 'list', '--base-paths', source)
    assert listed.split('\t')[0] == 'gear_dynamics'
    assert listed.strip().endswith('(ros.ament_python)')


@pytest.mark.parametrize('option', [[], ['--symlink-install']])
def test_colcon_build_installs_executables_that_run(source, tmp_path, option):
    pytest.importorskip('colcon_ros', reason='colcon is not installed')
    colcon = [sys.executable, '-m', 'colcon', '--log-base', tmp_path / 'log']
    folders = ['--build-base', tmp_path / 'build', '--install-base', tmp_path / 'install']
    run(*colcon, 'build', '--base-paths', source, *folders, *option, cwd=tmp_path)
    prefix = tmp_path / 'install' / 'gear_dynamics'
    assert_installed(prefix)
    site = next(prefix.glob('lib/python*/site-packages'))
    develop = source if option else site
    environment = outside({'PYTHONPATH': f'{develop}:{site}'})
    told = run(prefix / 'lib/gear_dynamics/log', '--help', env=environment, cwd=tmp_path)
    assert 'usage' in told


@pytest.fixture(scope='module')
def pip_prefix(source, tmp_path_factory):
    """Install with pip in an environment of its own, which borrows the libraries of this one."""
    prefix = tmp_path_factory.mktemp('pip') / 'environment'
    venv.create(prefix, with_pip=True)
    python = prefix / 'bin' / 'python3'
    run(python, '-m', 'pip', 'install', '--quiet', '--no-deps', source)
    site = next(prefix.glob('lib/python*/site-packages'))
    libraries = Path(yaml.__file__).parents[1]
    (site / 'borrowed.pth').write_text(f'{libraries}\n')
    return prefix


def test_pip_installs_executables_that_find_their_own_python(pip_prefix, tmp_path):
    assert_installed(pip_prefix)
    told = run(pip_prefix / 'lib/gear_dynamics/log', '--help', env=outside({}), cwd=tmp_path)
    assert 'usage' in told


def test_pip_puts_one_command_in_bin(pip_prefix, tmp_path):
    ours = [path.name for path in (pip_prefix / 'bin').iterdir() if path.name in EXECUTABLES]
    assert not ours
    told = run(pip_prefix / 'bin/gear-dynamics', 'log', '--help', env=outside({}), cwd=tmp_path)
    assert 'usage' in told
    version = ElementTree.parse(ROOT / 'package.xml').findtext('version')
    assert list(pip_prefix.glob(f'lib/python*/site-packages/gear_dynamics-{version}.dist-info'))


WITHOUT_ROS = """
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        package = name.split('.')[0]
        if package in ('rclpy', 'rcl_interfaces', 'std_srvs') or package.endswith('_msgs'):
            raise ModuleNotFoundError(f'No module named {package!r}', name=package)
sys.meta_path.insert(0, Missing())
"""


def python(code, **options):
    return subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, cwd=ROOT, **options
    )


def test_api_imports_without_ros():
    done = python(WITHOUT_ROS + 'import gear_dynamics as gd; print(gd.GearPair().pinion_teeth)')
    assert (done.stdout, done.stderr) == ('34\n', '')


@pytest.mark.parametrize('name', ['sim', 'analyzer', 'replay'])
def test_node_without_ros_says_in_one_line_what_to_install(name):
    code = f'from gear_dynamics.__main__ import main; sys.exit(main([{name!r}]))'
    done = python(WITHOUT_ROS + code)
    assert done.returncode == 2
    assert done.stderr.count('\n') == 1
    assert 'pip install "gear_dynamics[ros]"' in done.stderr


def test_help_names_every_executable_and_imports_none():
    code = (
        'import sys; from gear_dynamics.__main__ import main\n'
        'try: main(["--help"])\n'
        'finally: print(*({"numpy", "yaml", "rclpy"} & {*sys.modules}))'
    )
    lines = python(code).stdout.splitlines()
    assert lines[-1] == ''
    for name in EXECUTABLES:
        assert any(line.split()[:1] == [name] and len(line.split()) > 3 for line in lines)


def test_unknown_executable_is_refused_with_the_nearest_name():
    done = python('import sys; from gear_dynamics.__main__ import main; sys.exit(main(["smi"]))')
    assert done.returncode == 2
    assert done.stderr == "gear-dynamics: there is no 'smi'; did you mean 'sim'?\n"


def test_changelog_has_the_form_of_rep_132():
    changelog = pytest.importorskip('catkin_pkg.changelog', reason='catkin_pkg is not installed')
    read = changelog.get_changelog_from_path(str(ROOT / 'CHANGELOG.rst'))
    assert 'Forthcoming' in read.rst
    assert 'Changelog for package gear_dynamics' in (ROOT / 'CHANGELOG.rst').read_text()
