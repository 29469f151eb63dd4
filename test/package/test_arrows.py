"""The direction of imports: each room knows only the rooms above it in docs/architecture.md."""

import ast
import graphlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2] / 'gear_dynamics'
FILES = sorted(ROOT.rglob('*.py'))
ROOMS = (
    'parameters machine model integrator simulation dynamics signal monitoring wire bag recordings '
    'study web nodes'
).split()
"""From the top, which imports nothing of the package, to the bottom."""


def imports(path):
    """Yield the package's modules that a file imports, as tuples of names below the package."""
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names = [f'{node.module}.{alias.name}' for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            if name.startswith('gear_dynamics.'):
                yield tuple(name.split('.')[1:])


@pytest.mark.parametrize('room', ROOMS)
def test_a_room_imports_only_from_rooms_above_it(room):
    below = set(ROOMS[ROOMS.index(room) + 1 :])
    wrong = [
        f'{path.relative_to(ROOT)} imports {".".join(name)}'
        for path in (ROOT / room).rglob('*.py')
        for name in imports(path)
        if name[0] in below
    ]
    assert not wrong


ROS = ('rclpy', 'launch', 'launch_ros', 'rcl_interfaces', 'ament_index_python', 'sensor_msgs_py')


def packages(path):
    """Yield the packages that a file imports, anywhere in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.module.split('.')[0]
        elif isinstance(node, ast.Import):
            yield from (alias.name.split('.')[0] for alias in node.names)


def test_only_the_nodes_import_ros():
    wrong = [
        f'{path.relative_to(ROOT)} imports {name}'
        for path in FILES
        if path.relative_to(ROOT).parts[0] != 'nodes'
        for name in packages(path)
        if name in ROS or name.endswith(('_msgs', '_srvs'))
    ]
    assert not wrong


def first_imports(body):
    """Yield the import statements that run when a module is imported."""
    for node in body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif isinstance(node, ast.Try | ast.With):
            yield from first_imports(node.body)


def test_no_modules_import_each_other_in_a_circle():
    modules = {
        '.'.join(path.relative_to(ROOT.parent).with_suffix('').parts): path for path in FILES
    }
    graph = {
        name: {
            found
            for node in first_imports(ast.parse(path.read_text(encoding='utf-8')).body)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
            for found in [imported(modules, str(node.module), alias.name)]
            if found in modules
        }
        for name, path in modules.items()
    }
    assert sum(len(found) for found in graph.values()) > len(graph)
    # Raises a CycleError that names the circle.
    graphlib.TopologicalSorter(graph).prepare()


def imported(modules, package, name):
    """Return the module that `from package import name` needs."""
    places = (f'{package}.{name}', f'{package}.{name}.__init__', package, f'{package}.__init__')
    return next((place for place in places if place in modules), None)
