"""HDF5 files, and MATLAB files of version 7.3."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gear_dynamics.recordings.optional import optional_module
from gear_dynamics.recordings.table import RATE_NAMES, ArrayTable, RecordingError, plain


class Hdf5Table(ArrayTable):
    """An HDF5 file; a dataset is named by its path with dots, `group.dataset`.

    Attributes of a dataset or of a group above it may state the sample rate and the unit.
    """

    def __init__(self, path: Path) -> None:
        h5py = optional_module('h5py', 'h5py', path.name)
        try:
            self._file = h5py.File(path, 'r')
        except OSError as error:
            raise RecordingError(f'{path.name} cannot be read: {error}') from None
        self._rates: dict[str, float] = {}
        self._stated_units: dict[str, str] = {}
        arrays: dict[str, Any] = {}
        self._file.visititems(lambda name, item: self._visit(arrays, name, item))
        super().__init__(path.name, arrays)

    def rate(self, column: str) -> float | None:
        """Return the rate that an attribute or a constant states [Hz]."""
        return self._rates.get(column) or super().rate(column)

    def unit(self, column: str) -> str | None:
        """Return the unit that an attribute states."""
        return self._stated_units.get(column)

    def _visit(self, arrays: dict[str, Any], name: str, item: Any) -> None:
        if not hasattr(item, 'shape') or name.startswith('#refs#') or item.shape is None:
            return
        column = name.replace('/', '.')
        if item.dtype.kind not in 'fiub' or 'MATLAB_empty' in item.attrs:
            return
        columns = dict(_columns(column, item))
        arrays.update(columns)
        for attributes in (item.attrs, item.parent.attrs, self._file.attrs):
            for key, value in attributes.items():
                if plain(key) in RATE_NAMES and np.size(value) == 1:
                    for each in columns:
                        self._rates.setdefault(each, float(np.ravel(value)[0]))
        unit = next((item.attrs[key] for key in ('unit', 'units') if key in item.attrs), None)
        if unit is not None:
            text = unit.decode() if isinstance(unit, bytes) else str(unit)
            self._stated_units.update(dict.fromkeys(columns, text))


class _Slice:
    """One column of a dataset, read slice by slice."""

    def __init__(self, item: Any, axis: int, index: int, length: int) -> None:
        self._item, self._axis, self._index, self._length = item, axis, index, length

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, part: slice) -> np.ndarray:
        if self._item.ndim == 0:
            return np.atleast_1d(self._item[()])
        if self._item.ndim == 1:
            return self._item[part]
        key = (part, self._index) if self._axis == 0 else (self._index, part)
        return self._item[key]


def _columns(name: str, item: Any):  # type: ignore[no-untyped-def]
    if item.ndim < 2:
        yield name, _Slice(item, 0, 0, item.shape[0] if item.ndim else 1)
    elif item.ndim == 2:
        axis = 0 if item.shape[0] >= item.shape[1] else 1
        count = item.shape[1 - axis]
        for index in range(count):
            each = name if count == 1 else f'{name}[{index + 1}]'
            yield each, _Slice(item, axis, index, item.shape[axis])
