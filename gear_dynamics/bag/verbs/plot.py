"""Draw a report of a log: waveform, spectrum, waterfall, Poincaré section, indicators."""

from __future__ import annotations

import argparse
from pathlib import Path

from gear_dynamics.bag.verbs.output import beside
from gear_dynamics.machine.columns import CHANNELS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the verb takes."""
    parser.add_argument('log', nargs='+', help='bag folders or MCAP files')
    parser.add_argument(
        '--channel', choices=CHANNELS, default='gear_ay', help='default: %(default)s'
    )
    parser.add_argument(
        '--output', type=Path, help='PNG file (default: beside the log, its name and .png)'
    )


def run(arguments: argparse.Namespace) -> int:
    """Draw, and print the file."""
    from gear_dynamics.bag.plot import plot  # Matplotlib is slow to load

    file = arguments.output or beside(arguments.log[0], '.png')
    plot(arguments.log, file, arguments.channel)
    print(file)
    return 0
