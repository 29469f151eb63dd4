"""MATLAB files of version 4 to 7.2; those of version 7.3 are HDF5."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy import io

from gear_dynamics.recordings.table import ArrayTable, RecordingError, flatten

_DEEPEST = 8


def read_matlab(path: Path) -> ArrayTable:
    """Return the numeric arrays of a MATLAB file, those in structs and cells by path.

    A field is `struct.field`, an element of an array of structs or of a cell `name[2]`, a column
    of a matrix `name[2]`, all counted from 1. Of two variables of a name the later one counts, as
    in MATLAB.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter('always')
        try:
            content = io.loadmat(path)
        except Exception as error:  # a damaged file raises anything
            reason = ' '.join(str(error).split())[:200]
            raise RecordingError(f'{path.name} cannot be read: {reason}') from None
    arrays: dict[str, np.ndarray] = {}
    for name, value in content.items():
        if not name.startswith('__'):
            arrays.update(_walk(name, value, 0))
    table = ArrayTable(path.name, arrays)
    for warning in caught:
        words = str(warning.message).split('"')
        if 'Duplicate' in words[0] and len(words) > 1 and words[1] in arrays:
            table.notes[words[1]] = f'{path.name} holds {words[1]!r} twice: the later one is used'
    return table


def _walk(name: str, value: Any, depth: int) -> Iterator[tuple[str, np.ndarray]]:
    if not isinstance(value, np.ndarray) or depth > _DEEPEST or value.size == 0:
        return
    if value.dtype.names:
        for index, element in enumerate(value.ravel()):
            prefix = name if value.size == 1 else f'{name}[{index + 1}]'
            for field in value.dtype.names:
                yield from _walk(f'{prefix}.{field}', element[field], depth + 1)
    elif value.dtype.kind == 'O':
        for index, element in enumerate(value.ravel()):
            yield from _walk(f'{name}[{index + 1}]', element, depth + 1)
    else:
        yield from flatten(name, value)
