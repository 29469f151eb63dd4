"""Text with numbers in columns: any separator, decimal comma, BOM, header and unit lines."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gear_dynamics.machine.units import unit as known_unit
from gear_dynamics.recordings.table import RecordingError, RowTable

_HEAD = 1 << 16
_CHUNK = 1 << 22
_LINES = 40
_COMMENT = ('#', '%', '//')
_FORMS = tuple((s, d) for s in (';', '\t', '|', ',', None) for d in ('.', ',') if s != d)
"""Separators (None: white space) and decimal signs that are tried, in this order."""


class _Form(NamedTuple):
    separator: str | None
    decimal: str
    width: int
    numeric: float


class CsvTable(RowTable):
    """A text file.

    The form is found from the first 64 kB. Rows with fewer fields, or with text in place of a
    number, come out as NaN.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._path = path
        head, self._encoding = _head(path)
        lines = head.splitlines()
        if len(head) >= _HEAD // 4:
            lines = lines[:-1]
        filled = [line for line in lines if line.strip() and not line.startswith(_COMMENT)]
        if not filled:
            raise RecordingError(f'{path.name} holds no rows')
        self._form = _form(filled)
        if not self._form.numeric:
            raise RecordingError(f'{path.name} holds no columns of numbers')
        first = self._first_row(lines)
        self._units: dict[str, str] = {}
        self._skipped = first
        self.columns = self._names(lines[:first])

    def unit(self, column: str) -> str | None:
        """Return the unit of the unit line, or in brackets behind the name."""
        if column in self._units:
            return self._units[column]
        found = re.search(r'[\[(]([^\[\]()]*)[\])]\s*$', column)
        return found.group(1) if found and _is_unit(found.group(1)) else None

    def rows(self, columns: Sequence[str]) -> Iterator[np.ndarray]:
        """Yield blocks of rows."""
        wanted = [list(self.columns).index(column) for column in columns]
        with self._path.open(encoding=self._encoding, errors='replace') as stream:
            for _ in range(self._skipped):
                stream.readline()
            rest = ''
            while chunk := stream.read(_CHUNK):
                text = rest + chunk
                end = text.rfind('\n') + 1
                rest = text[end:]
                if end:
                    yield self._parse(text[:end], wanted)
            if rest.strip():
                yield self._parse(rest, wanted)

    def _parse(self, text: str, wanted: list[int]) -> np.ndarray:
        if self._form.decimal == ',':
            text = text.replace(',', '.')
        if text.isspace():
            return np.empty((0, len(wanted)))
        try:
            return np.loadtxt(
                io.StringIO(text),
                delimiter=self._form.separator,
                usecols=wanted,
                comments=None,
                quotechar='"',
                ndmin=2,
            )
        except ValueError:
            return self._parse_slowly(text, wanted)

    def _parse_slowly(self, text: str, wanted: list[int]) -> np.ndarray:
        rows = []
        for line in text.splitlines():
            if line.strip() and not line.startswith(_COMMENT):
                fields = _split(line, self._form.separator)
                rows.append([_number(fields[i]) if i < len(fields) else np.nan for i in wanted])
        return np.array(rows, dtype=float).reshape(-1, len(wanted))

    def _first_row(self, lines: list[str]) -> int:
        """Return the number of lines above the first row of numbers."""
        separator, decimal, width, _ = self._form
        for index, line in enumerate(lines):
            if line.startswith(_COMMENT):
                continue
            fields = _split(line, separator)
            numbers = sum(_is_number(each, decimal) for each in fields)
            if len(fields) == width and numbers >= max(1, self._form.numeric * width - 0.5):
                return index
        return 0

    def _names(self, above: list[str]) -> tuple[str, ...]:
        """Return the names of the columns from the lines above the rows; numbers by default."""
        separator, decimal, width, _ = self._form
        headers = []
        for line in above:
            fields = _split(line.lstrip('#% '), separator)
            if len(fields) == width and (width > 1 or fields[0]):
                headers.append(fields)
            if len(fields) == 1 and separator != ':':
                fields = _split(fields[0], ':')
            if len(fields) == 2 and _is_number(fields[1], decimal):
                self.constants[fields[0]] = _number(fields[1].replace(decimal, '.'))
        if not headers:
            return tuple(str(number) for number in range(1, width + 1))
        names, units = headers[-1], None
        if len(headers) > 1 and all(_is_unit(each.strip('[]()')) for each in headers[-1]):
            names, units = headers[-2], headers[-1]
        unique = _unique(names)
        if units:
            self._units = {
                name: text.strip('[]()')
                for name, text in zip(unique, units, strict=True)
                if text.strip('[]()')
            }
        return unique


def _head(path: Path) -> tuple[str, str]:
    """Return the beginning of a text file, and its encoding."""
    with path.open('rb') as stream:
        data = stream.read(_HEAD)
    if data[:2] in (b'\xff\xfe', b'\xfe\xff'):
        return data[: len(data) // 2 * 2].decode('utf-16', 'replace'), 'utf-16'
    try:
        # A character may be cut at the end of what was read.
        return data.decode('utf-8-sig'), 'utf-8-sig'
    except UnicodeDecodeError as error:
        if error.start >= len(data) - 4:
            return data[: error.start].decode('utf-8-sig'), 'utf-8-sig'
    return data.decode('latin-1'), 'latin-1'


def _form(lines: list[str]) -> _Form:
    """Return the separator and decimal sign by which most fields of the last lines are numbers."""
    best = _Form(',', '.', 1, 0.0)
    for separator, decimal in _FORMS:
        rows = [_split(line, separator) for line in lines[-_LINES:]]
        widths = [len(row) for row in rows]
        width = max(set(widths), key=widths.count)
        rows = [row for row in rows if len(row) == width]
        share = sum(_is_number(f, decimal) for row in rows for f in row) / (width * len(rows))
        share *= len(rows) / len(widths)
        better = share > best.numeric + 1e-9 or (share > best.numeric - 1e-9 and width > best.width)
        if better:
            best = _Form(separator, decimal, width, share)
    return best


def _split(line: str, separator: str | None) -> list[str]:
    fields = line.split(separator) if separator else line.split()
    return [field.strip().strip('"').strip() for field in fields]


def _is_number(field: str, decimal: str) -> bool:
    if decimal == ',' and '.' in field:
        return False
    try:
        float(field.replace(decimal, '.'))
    except ValueError:
        return False
    return '_' not in field


def _number(field: str) -> float:
    try:
        return float(field)
    except ValueError:
        return float('nan')


def _is_unit(text: str) -> bool:
    if text in ('', '-'):
        return True
    try:
        known_unit(text)
    except ValueError:
        return False
    return True


def _unique(names: list[str]) -> tuple[str, ...]:
    """Number the second and later columns of a name, and those without one."""
    seen: dict[str, int] = {}
    result = []
    for index, name in enumerate(names):
        name = name or str(index + 1)
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f'{name}#{seen[name]}')
    return tuple(result)
