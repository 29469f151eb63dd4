"""Put defects into the code, one at a time, and count those that the tests notice.

Usage: mutants.py [--count 200] [--seed 1] [--minutes 0] [--rooms model,signal,...]

A random sample of mutants: a comparison, an operator, a number or a condition is changed, or a
statement left out. Each runs in a copy of the tree with those tests alone that reach its line, as
a first run with coverage has shown. The integrator runs as plain Python (NUMBA_DISABLE_JIT), since
each of its mutants would otherwise be compiled for half a minute. Coverage does not see compiled
lines of other rooms: there, all tests of the file are tried.
"""

from __future__ import annotations

import argparse
import ast
import dataclasses
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import coverage

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = 'gear_dynamics'
KERNEL_ROOMS = ('integrator',)
"""Rooms whose code is mostly compiled."""

GENERATORS = ('vector.py', 'lanes.py', 'polynomials.py')
"""Files of the integrator that generate vector instructions, which plain Python does not run."""

TESTS = {
    'model': ['test/model'],
    'integrator': ['test/integrator/test_ports_reference.py'],
    'dynamics': ['test/dynamics'],
    'signal': ['test/signal'],
    'monitoring': ['test/monitoring', 'test/signal'],
    'study': ['test/study'],
}
"""Rooms that are mutated, and the tests that may notice."""

LONGEST = 60.0
"""Time that the tests of one mutant may take [s]; longer counts as noticed, as a hang would be."""

SWAPS: dict[type, type] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.And: ast.Or,
    ast.Or: ast.And,
}


@dataclasses.dataclass(frozen=True)
class Mutant:
    """A change of one place in one file."""

    file: Path
    node: ast.expr | ast.stmt
    text: str

    @property
    def line(self) -> int:
        """First line of the place."""
        return self.node.lineno

    def apply(self, source: str) -> str:
        """Return the source with the change made."""
        lines = source.encode().splitlines(keepends=True)
        before = sum(map(len, lines[: self.node.lineno - 1])) + self.node.col_offset
        end_line = self.node.end_lineno or self.node.lineno
        after = sum(map(len, lines[: end_line - 1])) + (self.node.end_col_offset or 0)
        data = source.encode()
        return (data[:before] + self.text.encode() + data[after:]).decode()


def mutants(file: Path) -> Iterator[Mutant]:
    """Yield the mutants of a file."""
    tree = ast.parse(file.read_text(encoding='utf-8'))
    for node in _code(tree):
        for text in _changes(node):
            yield Mutant(file, node, text)  # type: ignore[arg-type]


def _code(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what runs: no annotations, no docstrings, no messages of errors, no f-strings."""
    for name, value in ast.iter_fields(node):
        if name in ('annotation', 'returns', 'decorator_list', 'bases'):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or isinstance(child, ast.JoinedStr | ast.Raise):
                continue
            yield child
            yield from _code(child)


def _changes(node: ast.AST) -> Iterator[str]:
    """Yield the texts that may stand in the place of a node."""
    if isinstance(node, ast.Compare) and type(node.ops[0]) in SWAPS:
        swapped = [SWAPS[type(node.ops[0])](), *node.ops[1:]]
        yield _text(ast.Compare(node.left, swapped, node.comparators))
    elif isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
        yield _text(ast.BinOp(node.left, SWAPS[type(node.op)](), node.right))
    elif isinstance(node, ast.BoolOp):
        yield _text(ast.BoolOp(SWAPS[type(node.op)](), node.values))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield _text(node.operand)
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield repr(node.value + 1)  # type: ignore[operator]
        if isinstance(node.value, float) and node.value:
            yield repr(node.value * 1.3)
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield repr(not node.value)
    elif isinstance(node, ast.AugAssign) or (
        isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    ):
        yield 'pass'
    elif isinstance(node, ast.IfExp):
        yield _text(node.orelse)


def _text(node: ast.expr) -> str:
    return f'({ast.unparse(ast.fix_missing_locations(node))})'


class Trial:
    """A copy of the tree in which mutants are tried."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / 'tree'
        names = shutil.ignore_patterns('.*', '__pycache__', 'build', 'install', 'log', 'output')
        shutil.copytree(ROOT, self.folder, ignore=names)

    def pytest(self, *arguments: str, jit: bool, timeout: float | None = None) -> int | None:
        """Run pytest; return its exit code, or None if it took too long."""
        command = [sys.executable, '-m', 'pytest', '-q', '-x', '-p', 'no:cacheprovider']
        environment = dict(os.environ, NUMBA_DISABLE_JIT='' if jit else '1')
        try:
            done = subprocess.run(
                [*command, *arguments],
                cwd=self.folder,
                env=environment,
                capture_output=True,
                timeout=timeout,
            )
        except subprocess.TimeoutExpired:
            return None
        return done.returncode

    def reach(self, room: str) -> dict[tuple[Path, int], set[str]]:
        """Return the tests that reach each line of a room."""
        tests = [path for path in TESTS[room] if (self.folder / path).exists()]
        if not tests:
            return {}
        (self.folder / '.coveragerc').write_text('[run]\ncore = ctrace\n')
        options = ['--cov', f'{PACKAGE}/{room}', '--cov-context', 'test', '--cov-report', '']
        options += ['--cov-config', '.coveragerc', '-m', 'not slow', '--maxfail', '1000']
        jit = room not in KERNEL_ROOMS
        code = self.pytest(*tests, *options, jit=jit)
        if code not in (0, 1):
            raise SystemExit(f'mutants: the tests of {room} do not run (exit code {code})')
        data = coverage.CoverageData(str(self.folder / '.coverage'))
        data.read()
        reached: dict[tuple[Path, int], set[str]] = {}
        for name in data.measured_files():
            file = Path(name).relative_to(self.folder)
            for line, contexts in data.contexts_by_lineno(name).items():
                found = {each.rpartition('|')[0] for each in contexts if '|' in each}
                reached[file, line] = found
        return reached

    def notices(self, mutant: Mutant, tests: set[str], jit: bool) -> bool:
        """Return whether one of the tests fails with a mutant in place."""
        file = self.folder / mutant.file.relative_to(ROOT)
        source = file.read_text(encoding='utf-8')
        file.write_text(mutant.apply(source), encoding='utf-8')
        try:
            # The shortest names are the simplest tests; a parametrized one counts by its cases.
            ordered = sorted(tests, key=lambda name: (len(name), name))[:40]
            return self.pytest(*ordered, jit=jit, timeout=LONGEST) != 0
        finally:
            file.write_text(source, encoding='utf-8')


def of_file(reached: dict[tuple[Path, int], set[str]], mutant: Mutant) -> set[str]:
    """Return the tests that reach any line of a mutant's file, if its own line says no tests.

    That is so of compiled lines, and of those that run once, when the module is imported.
    """
    file = mutant.file.relative_to(ROOT)
    every = set().union(*(each for (name, _), each in reached.items() if name == file))
    if (file, mutant.line) in reached:
        return every
    for node in ast.walk(ast.parse(mutant.file.read_text(encoding='utf-8'))):
        if not isinstance(node, ast.FunctionDef):
            continue
        inside = node.lineno <= mutant.line <= (node.end_lineno or 0)
        if inside and any('kernel' in ast.unparse(each) for each in node.decorator_list):
            return every
    return set()


def main() -> int:
    """Try a random sample of mutants; print the survivors and the score."""
    parser = argparse.ArgumentParser(description='Count the defects that the tests notice.')
    parser.add_argument('--count', type=int, default=200, help='mutants to try; default 200')
    parser.add_argument('--seed', type=int, default=1, help='of the sample; default 1')
    parser.add_argument('--minutes', type=float, default=0.0, help='stop after; default: never')
    parser.add_argument('--rooms', default=','.join(TESTS), help='rooms to mutate')
    options = parser.parse_args()
    rooms = options.rooms.split(',')
    chosen = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(Path(folder))
        reached = {room: trial.reach(room) for room in rooms}
        every = [
            (room, mutant)
            for room in rooms
            if reached[room]
            for file in sorted((ROOT / PACKAGE / room).rglob('*.py'))
            if file.name not in GENERATORS
            for mutant in mutants(file)
        ]
        sample = chosen.sample(every, min(options.count, len(every)))
        tried = noticed = 0
        end = time.monotonic() + (options.minutes * 60 or 1e9)
        for room, mutant in sample:
            if time.monotonic() > end:
                break
            tests = reached[room].get((mutant.file.relative_to(ROOT), mutant.line), set())
            tests = tests or of_file(reached[room], mutant)
            tried += 1
            jit = room not in KERNEL_ROOMS
            if tests and trial.notices(mutant, tests, jit):
                noticed += 1
                continue
            lines = mutant.file.read_text(encoding='utf-8').splitlines()
            where = f'{mutant.file.relative_to(ROOT)}:{mutant.line}'
            why = 'survives' if tests else 'no test reaches it'
            line = lines[mutant.line - 1].strip()
            print(f'{where}: {why}: {line}   ->   {mutant.text}', flush=True)
    print(f'{noticed} of {tried} mutants were noticed, of {len(every)} that can be made')
    return 0


if __name__ == '__main__':
    sys.exit(main())
