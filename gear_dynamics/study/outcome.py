"""What a study found, and its files: NPZ, CSV, text."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

Arrays = dict[str, np.ndarray]


class Outcome(NamedTuple):
    """What a study found.

    Attributes
    ----------
    name : str
        Of the files, without ending.
    text : str
        The result in a few lines.
    table : dict of str to (n,) array
        What the CSV holds: columns, each name with its unit in brackets.
    arrays : dict of str to array
        What the NPZ holds: the data of the figure.
    units : dict of str to str
        Unit of each array, 1 for a pure number and - for words; the NPZ holds them as rows of name
        and unit under `units`.
    further : dict of str to table
        Further tables, by what is added to the name of their files.
    """

    name: str
    text: str
    table: dict[str, np.ndarray]
    arrays: dict[str, np.ndarray]
    units: dict[str, str]
    further: Mapping[str, dict[str, np.ndarray]] = MappingProxyType({})


def write_outcome(outcome: Outcome, directory: Path) -> list[Path]:
    """Write the data and the text of an outcome; return the paths of the files.

    Raises
    ------
    OSError
        If they cannot be written.
    """
    directory.mkdir(parents=True, exist_ok=True)
    base = directory / outcome.name
    arrays: dict[str, Any] = outcome.arrays
    units = np.array([(name, outcome.units[name]) for name in outcome.arrays])
    np.savez_compressed(base.with_suffix('.npz'), units=units, **arrays)
    base.with_suffix('.txt').write_text(outcome.text + '\n', encoding='utf-8')
    paths = [base.with_suffix('.npz'), base.with_suffix('.txt')]
    for ending, table in {'': outcome.table, **outcome.further}.items():
        paths.append(directory / f'{outcome.name}{ending}.csv')
        paths[-1].write_text(csv_text(table), encoding='utf-8')
    return paths


def csv_text(table: dict[str, np.ndarray]) -> str:
    """Return a table as CSV, with the units in its header."""
    columns = [np.asarray(column) for column in table.values()]
    lines = [','.join(table)]
    lines += [','.join(_cell(value) for value in row) for row in zip(*columns, strict=True)]
    return '\n'.join(lines) + '\n'


def _cell(value: object) -> str:
    if isinstance(value, float | np.floating):
        return f'{value:.9g}'
    return str(value)
