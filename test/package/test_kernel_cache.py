import ast
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from gear_dynamics import digest

INNER = """
from gear_dynamics.kernels import kernel

@kernel
def inner(x):
    return x + 1
"""

OUTER = """
from gear_dynamics.integrator import inner
from gear_dynamics.kernels import kernel

@kernel
def outer(x):
    return 10 * inner.inner(x)
"""

PROGRAM = """
import numba
from gear_dynamics.integrator.outer import outer

result, hits = outer(1), sum(outer.stats.cache_hits.values())
print(result, hits, numba.config.CACHE_DIR)
"""


@pytest.fixture
def copy(tmp_path):
    """Return a folder with a copy of the package that has two small kernels more."""
    (tmp_path / 'copy' / digest.ROOT.name / 'integrator').mkdir(parents=True)
    package = tmp_path / 'copy' / digest.ROOT.name
    for name in ('__init__.py', 'digest.py', 'kernels.py', 'linking.py'):
        shutil.copy(digest.ROOT / name, package)
    (package / 'integrator' / '__init__.py').touch()
    (package / 'integrator' / 'inner.py').write_text(INNER)
    (package / 'integrator' / 'outer.py').write_text(OUTER)
    return package


def run(package, cache):
    """Run the two kernels in a process of their own; return the result, cache hits and stderr."""
    ended = subprocess.run(
        [sys.executable, '-c', PROGRAM],
        cwd=package.parent,
        env=dict(os.environ, NUMBA_CACHE_DIR=str(cache)),
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 0, ended.stderr
    result, hits, folder = ended.stdout.split(maxsplit=2)
    assert Path(folder.strip()) == cache  # Numba's own setting is as the user left it
    return int(result), int(hits), ended.stderr


def test_a_kernel_whose_callee_in_another_file_was_edited_is_compiled_again(copy, tmp_path):
    cache = tmp_path / 'cache'
    assert run(copy, cache) == (20, 0, '')
    assert run(copy, cache) == (20, 1, '')
    inner = copy / 'integrator' / 'inner.py'
    inner.write_text(INNER.replace('x + 1', 'x + 2'))
    assert run(copy, cache) == (30, 0, '')
    inner.write_text(INNER)
    assert run(copy, cache) == (20, 1, '')


def test_kernels_are_removed_by_age_alone_and_damaged_ones_are_compiled_again(copy, tmp_path):
    cache = tmp_path / 'cache'
    run(copy, cache)
    recent, old = (cache / digest.ROOT.name / name for name in ('recent', 'old'))
    for folder, days in ((recent, 29), (old, 31)):
        folder.mkdir()
        (folder / 'kernel.nbc').touch()
        os.utime(folder, (time.time() - days * 86400,) * 2)
    run(copy, cache)
    assert old.exists()  # what compiles nothing removes nothing
    for path in cache.rglob('*.nbi'):
        path.write_bytes(path.read_bytes()[:20])
    assert run(copy, cache) == (20, 0, '')
    assert recent.exists()
    assert not old.exists()
    assert not list(copy.rglob('*.nbc'))


def test_without_a_folder_to_write_kernels_are_compiled_and_one_line_says_so(copy, tmp_path):
    cache = tmp_path / 'cache'
    cache.touch()  # no folder can be made here, whoever runs the tests
    result, hits, errors = run(copy, cache)
    assert (result, hits) == (20, 0)
    assert errors.count('set NUMBA_CACHE_DIR to a folder of your own') == 1


def imports(path):
    """Return the files of the package that a file imports, by Python's own parser."""

    def files(module):
        place = digest.ROOT.parent.joinpath(*module.split('.'))
        if place.with_suffix('.py').is_file():
            return {place.with_suffix('.py')}
        return set((place if place.is_dir() else place.parent).rglob('*.py'))

    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, 'the package imports by full names'
            place = digest.ROOT.parent.joinpath(*node.module.split('.'))
            one = place.with_suffix('.py').is_file()
            names = [node.module if one else f'{node.module}.{each.name}' for each in node.names]
        else:
            continue
        for name in names:
            if name.split('.')[0] == digest.ROOT.name:
                found |= files(name)
    return found


def test_the_digest_of_a_module_knows_all_that_the_module_imports():
    assert [p for p in digest.ROOT.rglob('*.py') if digest._read(p)[1] != imports(p)] == []


def test_the_digest_of_all_code_covers_every_folder_but_those_that_give_no_results(
    tmp_path, monkeypatch
):
    root = tmp_path / digest.ROOT.name
    shutil.copytree(digest.ROOT, root, ignore=shutil.ignore_patterns('__pycache__'))
    monkeypatch.setattr(digest, 'ROOT', root)
    before = digest.code_digest()
    (root / 'nodes' / 'new.py').touch()
    assert digest.code_digest() == before
    for path in ('new_room/new.py', 'model/mesh/new.py', 'new.py'):
        (root / path).parent.mkdir(exist_ok=True)
        (root / path).touch()
        assert digest.code_digest() != before
        before = digest.code_digest()
