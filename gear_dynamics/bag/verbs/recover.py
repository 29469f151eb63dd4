"""Copy what is sound of a cut or damaged log into a new one, and say what was lost."""

from __future__ import annotations

import argparse
from pathlib import Path

from gear_dynamics.bag.chunk_builder import COMPRESSIONS
from gear_dynamics.bag.recover import recover
from gear_dynamics.bag.verbs.output import beside


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the verb takes."""
    parser.add_argument('log', nargs='+', help='bag folders or MCAP files; they are not changed')
    parser.add_argument(
        '--output', type=Path, help='new bag folder (default: that of the log and _recovered)'
    )
    parser.add_argument(
        '--compression', choices=COMPRESSIONS, default='zstd', help='default: %(default)s'
    )


def run(arguments: argparse.Namespace) -> int:
    """Recover, and print what came of it."""
    folder = arguments.output or beside(arguments.log[0], '_recovered')
    recovery = recover(arguments.log, folder, arguments.compression)
    for damage in recovery.lost:
        print(f'lost: {damage}')
    print(f'{recovery.messages} messages are in {recovery.folder}')
    return 0
