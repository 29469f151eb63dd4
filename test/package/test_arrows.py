"""The direction of imports: each room knows only the rooms above it in docs/architecture.md."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2] / 'gear_dynamics'
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


def test_only_the_nodes_import_ros():
    wrong = [
        str(path.relative_to(ROOT))
        for path in ROOT.rglob('*.py')
        if path.relative_to(ROOT).parts[0] != 'nodes' and 'import rclpy' in path.read_text()
    ]
    assert not wrong
