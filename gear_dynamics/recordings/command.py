"""The `analyse` executable: recordings and a machine file in, a table, a report and words out."""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring.spans.findings import findings
from gear_dynamics.recordings.analyse import Analysis, analyse_recordings
from gear_dynamics.recordings.optional import optional_module
from gear_dynamics.recordings.report import write_report
from gear_dynamics.recordings.table import RecordingError


def main(argv: Sequence[str] | None = None) -> int:
    """Run `analyse` and return the exit code.

    0 if any channel could be analysed; 2, with one line on standard error, if none could.
    """
    arguments = _parser().parse_args(argv)
    try:
        machine = Machine.from_yaml(arguments.machine)
        progress = _Progress(arguments.quiet)
        analysis = analyse_recordings(arguments.recordings, machine, progress.show)
        progress.end()
        folder = Path(arguments.output)
        folder.mkdir(parents=True, exist_ok=True)
        _write_tables(folder, analysis)
        found = findings(analysis.summary, analysis.rows)
        write_report(folder / 'report.html', analysis, found)
    except ValueError as error:
        return _refuse(str(error))
    except OSError as error:
        return _refuse(f'{error.filename or "disk"}: {error.strerror}')
    for name, reason in analysis.failures.items():
        print(f'not analysed: {name}: {reason}', file=sys.stderr)
    for note in analysis.notes:
        print(f'note: {note}', file=sys.stderr)
    for finding in found:
        print(('! ' if finding.alarming else '  ') + finding.text)
    rows = len(analysis.rows)
    print(f'{rows} {"row" if rows == 1 else "rows"} and report.html are in {folder}')
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='gear-dynamics analyse',
        description='Analyses recordings of a machine: levels, orders, gears and bearings.',
        epilog='docs/machines.md describes machine files, the forms of recordings, and the output.',
    )
    parser.add_argument(
        'recordings',
        nargs='+',
        metavar='RECORDING',
        help='CSV, WAV, .mat, .npz, .npy, Parquet, HDF5, TDMS, UFF58 or MCAP; or a folder of them',
    )
    parser.add_argument('--machine', required=True, metavar='FILE', help='machine file (YAML)')
    parser.add_argument(
        '--output',
        default='analysis',
        metavar='FOLDER',
        help='where indicators.csv, units.csv and report.html go (default: %(default)s)',
    )
    parser.add_argument('--quiet', action='store_true', help='show no progress')
    return parser


def _refuse(reason: str) -> int:
    print(f'gear-dynamics analyse: {" ".join(reason.split())}', file=sys.stderr)
    return 2


class _Progress:
    """Shows the seconds analysed, on a terminal only."""

    def __init__(self, quiet: bool) -> None:
        self._shown = not quiet and sys.stderr.isatty()

    def show(self, seconds: float) -> None:
        """Tell how far the analysis is."""
        if self._shown:
            print(f'\r{seconds:.1f} s analysed', end='', file=sys.stderr, flush=True)

    def end(self) -> None:
        """Leave a clean line."""
        if self._shown:
            print(file=sys.stderr)


def _write_tables(folder: Path, analysis: Analysis) -> None:
    """Write indicators.csv and units.csv, and indicators.parquet where pyarrow is installed."""
    columns = list(analysis.units)
    with (folder / 'indicators.csv').open('w', newline='', encoding='utf-8') as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        for row in analysis.rows:
            writer.writerow([_cell(row.get(column)) for column in columns])
    with (folder / 'units.csv').open('w', newline='', encoding='utf-8') as stream:
        writer = csv.writer(stream)
        writer.writerow(['column', 'unit'])
        writer.writerows(analysis.units.items())
    try:
        optional_module('pyarrow', 'pyarrow', 'indicators.parquet')
        analysis.table().to_parquet(folder / 'indicators.parquet')
    except RecordingError as error:
        print(f'note: {error}', file=sys.stderr)


def _cell(value: Any) -> Any:
    """Return a cell of the CSV: nothing for what is unknown."""
    return '' if value is None or value != value else value
