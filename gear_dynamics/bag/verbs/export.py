"""Write topics of a log to NPZ or CSV files, one file a topic."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from gear_dynamics.bag.export import FORMATS, export
from gear_dynamics.bag.verbs.output import beside


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the verb takes."""
    parser.add_argument('log', nargs='+', help='bag folders or MCAP files')
    parser.add_argument(
        '--topic', action='append', help='a topic; may be given again (default: all topics)'
    )
    parser.add_argument('--format', choices=FORMATS, default='npz', help='default: %(default)s')
    parser.add_argument(
        '--output', type=Path, help='folder (default: beside the log, its name and _export)'
    )


def run(arguments: argparse.Namespace) -> int:
    """Export, and print the files."""
    folder = arguments.output or beside(arguments.log[0], '_export')
    files = export(arguments.log, folder, arguments.topic, arguments.format, _progress)
    for file in files:
        print(file)
    return 0


def _progress(topic: str) -> None:
    print(f'exporting {topic}', file=sys.stderr)
