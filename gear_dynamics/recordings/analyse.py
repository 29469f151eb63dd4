"""Analyses recordings of a machine: `gd.analyse`, and what the command and the report rest on."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring.spans.analysis import SpanAnalysis, column_units
from gear_dynamics.monitoring.spans.summary import Summary
from gear_dynamics.recordings.constants import contradictions
from gear_dynamics.recordings.numpy_files import memory_table
from gear_dynamics.recordings.open import open_table
from gear_dynamics.recordings.optional import optional_module
from gear_dynamics.recordings.signals import Signals
from gear_dynamics.recordings.span_reader import Cuts, read_spans
from gear_dynamics.recordings.stamps import recording_time
from gear_dynamics.recordings.table import RecordingError, RecordingTable, matches

if TYPE_CHECKING:
    import pandas

Progress = Callable[[float], None]


@dataclasses.dataclass
class Analysis:
    """The analysis of one or several recordings.

    Attributes
    ----------
    machine : Machine
    rows : list of dict
        A row a span, by column.
    units : dict of str to str
        Unit of every column, in their order.
    summary : Summary
    failures : dict of str to str
        What could not be analysed, and why.
    notes : list of str
        What must be known of the recordings.
    cuts : Cuts
    files : list of str
    sources : dict of str to (str, float)
        Where each channel stands, and its rate [Hz].
    """

    machine: Machine
    rows: list[dict[str, Any]]
    units: dict[str, str]
    summary: Summary
    failures: dict[str, str]
    notes: list[str]
    cuts: Cuts
    files: list[str]
    sources: dict[str, tuple[str, float]] = dataclasses.field(default_factory=dict)

    def table(self) -> pandas.DataFrame:
        """Return the rows as a DataFrame; its `attrs` hold units, notes and failures."""
        pandas = optional_module('pandas', 'pandas', 'a table of indicators')
        frame = pandas.DataFrame(self.rows, columns=list(self.units))
        frame.attrs['units'] = dict(self.units)
        frame.attrs['notes'] = list(self.notes)
        frame.attrs['failures'] = dict(self.failures)
        return frame


def analyse(recording: Any, machine: Machine | str | Path | Mapping[str, Any]) -> pandas.DataFrame:
    """Analyse a recording of a machine.

    Parameters
    ----------
    recording : path, list of paths, structured array, mapping of columns, or DataFrame
    machine : Machine, path or mapping
        What the machine is; a path is that of a machine file.

    Returns
    -------
    DataFrame
        One row a span; docs/machines.md describes the columns. Its `attrs` hold the `units` of
        the columns, `notes`, and `failures`: what could not be analysed, and why.

    Raises
    ------
    ValueError
        If the machine file is wrong, or no channel can be analysed; the message is one line.
    """
    return analyse_recordings(recording, as_machine(machine)).table()


def as_machine(machine: Machine | str | Path | Mapping[str, Any]) -> Machine:
    """Return a machine given by itself, by its file, or by the content of a file."""
    if isinstance(machine, Machine):
        return machine
    if isinstance(machine, Mapping):
        return Machine.from_mapping(machine)
    return Machine.from_yaml(machine)


def analyse_recordings(
    recording: Any, machine: Machine, progress: Progress | None = None
) -> Analysis:
    """Analyse recordings; arguments as for `analyse`.

    Parameters
    ----------
    recording, machine
    progress : callable, optional
        Told the seconds analysed so far after each span.

    Raises
    ------
    RecordingError
        If no channel can be analysed.
    """
    tables = _tables(recording, machine)
    result = Analysis(machine, [], {}, Summary(machine), {}, [], Cuts(), [t.name for t in tables])
    engine = SpanAnalysis(machine)
    if machine.recording.files == 'series':
        _series(tables, engine, result, progress)
    else:
        _analyse_one(tables, engine, result, progress, 0.0)
    result.notes += result.cuts.words()
    result.notes += dict.fromkeys(contradictions(tables, result.summary))
    result.units = _units(result)
    if not result.rows:
        reasons = '; '.join(f'{name}: {why}' for name, why in result.failures.items())
        raise RecordingError(reasons or 'the recording holds no samples')
    return result


def _tables(recording: Any, machine: Machine) -> list[RecordingTable]:
    rows = machine.recording.rows
    if isinstance(recording, str | Path):
        recording = [recording]
    if isinstance(recording, Sequence) and not isinstance(recording, np.ndarray):
        if not recording:
            raise RecordingError('no recording is given')
        if all(isinstance(each, str | Path) for each in recording):
            return [open_table(path, rows) for each in recording for path in _files(Path(each))]
    return [memory_table(recording)]


def _files(path: Path) -> list[Path]:
    """Return the recordings of a folder by name, 2 before 10; an MCAP log is one recording."""
    if path.is_dir() and not any(path.glob('*.mcap')):
        files = [each for each in path.iterdir() if each.is_file() and each.name[0] != '.']
        files.sort(key=_natural)
        if not files:
            raise RecordingError(f'{path} is an empty folder')
        return files
    return [path]


def _natural(path: Path) -> list[tuple[int, str]]:
    parts = re.split(r'(\d+)', path.name)
    return [(int(part), '') if part.isdigit() else (-1, part) for part in parts]


def _series(
    tables: list[RecordingTable], engine: SpanAnalysis, result: Analysis, progress: Progress | None
) -> None:
    """Analyse recordings that follow each other with pauses, each with its own time."""
    origin = None
    end = 0.0
    for table in tables:
        if not _is_wanted(table, result.machine):
            continue
        time = recording_time(table, result.machine.recording.time)
        if time is None:
            start = end
            note = 'recordings state no time: they are taken to follow each other without pause'
            if note not in result.notes:
                result.notes.append(note)
        else:
            origin = time if origin is None else origin
            start = time - origin
            while start < end - 1e-3 and end - start < 400 * 86400 and time < 86400:
                start += 86400  # a time of day
        end = start + _analyse_one([table], engine, result, progress, start)
    if len(tables) > 1:
        result.rows.sort(key=lambda row: row['t'])


def _is_wanted(table: RecordingTable, machine: Machine) -> bool:
    """Return whether any channel may stand in a recording, by its name."""
    patterns = [channel.source.file for channel in machine.channels]
    return any(pattern is None or matches(table.name, pattern) for pattern in patterns)


def _analyse_one(
    tables: list[RecordingTable],
    engine: SpanAnalysis,
    result: Analysis,
    progress: Progress | None,
    offset: float,
) -> float:
    """Add the rows of a recording; return its duration [s]."""
    signals = Signals(result.machine, tables)
    result.failures |= signals.failures
    result.notes += [note for note in signals.notes if note not in result.notes]
    if not signals.channels:
        return 0.0
    for name, found in signals.channels.items():
        result.sources.setdefault(name, (found.origin, found.rate))
    end = 0.0
    for span in read_spans(signals, result.machine.recording.span, result.cuts):
        shown = engine.analyse(span)
        result.summary.add(span, shown)
        row: dict[str, Any] = dict(shown.values)
        row['t'] = span.start + offset
        if result.machine.recording.files == 'series':
            row['file'] = tables[0].name
        row['operating_bin'] = _operating_bin(shown.values, result.machine)
        row['notes'] = '; '.join(shown.notes)
        result.rows.append(row)
        end = span.start + span.duration
        if progress is not None:
            progress(offset + end)
    return end


def _operating_bin(values: Mapping[str, float], machine: Machine) -> str:
    """Return the speed of the first shaft, rounded to 5 %, by which spans are comparable."""
    for shaft in machine.shafts[:1]:
        speed = values.get(f'{shaft.name}/speed', math.nan)
        if speed > 0:
            rpm = speed * 30 / math.pi
            return f'{1.05 ** round(math.log(rpm, 1.05)):.4g} rpm'
    return ''


def _units(result: Analysis) -> dict[str, str]:
    units = column_units(result.machine)
    present = {column for row in result.rows for column in row}
    units = {column: unit for column, unit in units.items() if column in present}
    if 'file' in present:
        units = {'t': 's', 'file': ''} | units
    return units | {'operating_bin': '', 'notes': ''}
