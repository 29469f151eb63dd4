"""Digests of the package's own sources: which code a result or a compiled kernel came from."""

from __future__ import annotations

import functools
import hashlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent
"""The folder of the package."""

WITHOUT_RESULTS = ('nodes', 'web')
"""Rooms that nothing else may import: their code cannot change what is computed."""

_IMPORT = re.compile(
    rf'^[ \t]*(?:from[ \t]+({ROOT.name}[\w.]*)[ \t]+import[ \t]*(\([^)]*\)|[^\n#]*)'
    rf'|import[ \t]+({ROOT.name}[\w.]*))',
    re.MULTILINE,
)
_LENGTH = 16


def code_digest() -> str:
    """Return the digest of all code of the package that can change a result."""
    return digest(
        path
        for path in ROOT.rglob('*.py')
        if path.relative_to(ROOT).parts[0] not in WITHOUT_RESULTS
    )


def module_digest(path: Path) -> str:
    """Return the digest of a module and of every module that it imports, at any remove.

    Parameters
    ----------
    path : Path
        A file of the package.
    """
    found, new = set(), {path.resolve()}
    while new:
        found |= new
        new = {imported for each in new for imported in _read(each)[1]} - found
    return digest(found)


def digest(paths: Iterable[Path]) -> str:
    """Return the digest of files by their place in the package and their content."""
    total = hashlib.sha256()
    for path in sorted(paths):
        total.update(f'{path.relative_to(ROOT).as_posix()}\0'.encode())
        total.update(_read(path)[0])
    return total.hexdigest()[:_LENGTH]


def _read(path: Path) -> tuple[bytes, frozenset[Path]]:
    """Return the digest of a file, and the files of the package that it imports."""
    return _read_as_of(path, path.stat().st_mtime_ns)


@functools.cache
def _read_as_of(path: Path, modified: int) -> tuple[bytes, frozenset[Path]]:
    content = path.read_bytes()
    imports = frozenset(
        file
        for module, names, plain in _IMPORT.findall(content.decode())
        for file in (_resolved(module, names) if module else _files(plain))
    )
    return hashlib.sha256(content).digest(), imports


def _resolved(module: str, names: str) -> Iterator[Path]:
    """Yield the files behind `from module import names`."""
    if _file(module):
        yield from _files(module)
        return
    for line in names.strip('()').splitlines():
        for name in line.partition('#')[0].split(','):
            if name.strip():
                yield from _files(f'{module}.{name.split()[0]}')


def _files(module: str) -> Iterable[Path]:
    """Return a module's file; for a package, or a name of one, all the files below it."""
    file = _file(module)
    if file:
        return [file]
    folder = ROOT.parent.joinpath(*module.split('.'))
    return (folder if folder.is_dir() else folder.parent).rglob('*.py')


def _file(module: str) -> Path | None:
    file = ROOT.parent.joinpath(*module.split('.')).with_suffix('.py')
    return file if file.is_file() else None
