"""The `log` executable: inspects, recovers, exports and plots logs."""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.chunk_builder import COMPRESSIONS
from gear_dynamics.bag.export import FORMATS, export
from gear_dynamics.bag.info import log_info
from gear_dynamics.bag.info_text import info_lines
from gear_dynamics.bag.log import printable
from gear_dynamics.bag.recover import recover
from gear_dynamics.machine.columns import CHANNELS

OPTION_DEFAULT = 'default: %(default)s'


def main(argv: Sequence[str] | None = None) -> int:
    """Run a verb and return the exit code.

    0; 1 if a recovered log may lack messages; 2, with one line on standard error, if the verb
    could not be carried out.
    """
    arguments = _parser().parse_args(argv)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('always')
            warnings.showwarning = _one_line
            return int(arguments.run(arguments))
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        _complain(f'{error.filename or "disk"}: {error.strerror}')
    except LogError as error:
        _complain(str(error))
    return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='log', description='Inspect, recover, export and plot logs of a gear pair.'
    )
    verbs = parser.add_subparsers(dest='verb', metavar='VERB', required=True)

    def verb(run: Callable[[argparse.Namespace], int]) -> argparse.ArgumentParser:
        about = (run.__doc__ or '').splitlines()[0]
        added = verbs.add_parser(run.__name__.strip('_'), help=about, description=about)
        added.set_defaults(run=run)
        added.add_argument('log', nargs='+', help='bag folders or MCAP files')
        return added

    verb(_info).add_argument(
        '--quick', action='store_true', help='believe the index instead of reading all messages'
    )
    added = verb(_recover)
    added.add_argument(
        '--output', type=Path, help='new bag folder (default: that of the log and _recovered)'
    )
    added.add_argument('--compression', choices=COMPRESSIONS, default='zstd', help=OPTION_DEFAULT)
    added = verb(_export)
    added.add_argument(
        '--topic', action='append', help='a topic; may be given again (default: all topics)'
    )
    added.add_argument('--format', choices=FORMATS, default='npz', help=OPTION_DEFAULT)
    added.add_argument(
        '--output', type=Path, help='folder (default: beside the log, its name and _export)'
    )
    added = verb(_plot)
    added.add_argument('--channel', choices=CHANNELS, default='gear_ay', help=OPTION_DEFAULT)
    added.add_argument(
        '--output', type=Path, help='PNG file (default: beside the log, its name and .png)'
    )
    return parser


def _info(arguments: argparse.Namespace) -> int:
    """Print what a log holds: topics, types, counts, rates, gaps, configuration, damage."""
    info = log_info(arguments.log, check=not arguments.quick)
    for line in info_lines(info):
        print(line)
    if not (info.whole or info.messages or info.configurations):
        raise LogError('nothing in the log can be read')
    return 0


def _recover(arguments: argparse.Namespace) -> int:
    """Copy what can be read of a cut or damaged log into a new one; exit code 1 if not all."""
    folder = arguments.output or _beside(arguments.log[0], '_recovered')
    recovery = recover(arguments.log, folder, arguments.compression)
    for damage in recovery.damage:
        print(f'{"lost" if damage.loss else "note"}: {printable(str(damage), 1000)}')
    print(f'{recovery.messages} messages are in {recovery.folder}')
    return 1 if recovery.lost else 0


def _export(arguments: argparse.Namespace) -> int:
    """Write topics of a log to NPZ or CSV files, one file a topic."""

    def progress(topic: str) -> None:
        print(f'exporting {topic}', file=sys.stderr)

    folder = arguments.output or _beside(arguments.log[0], '_export')
    for file in export(arguments.log, folder, arguments.topic, arguments.format, progress):
        print(file)
    return 0


def _plot(arguments: argparse.Namespace) -> int:
    """Draw a report of a log: waveform, spectrum, waterfall, Poincaré section, indicators."""
    from gear_dynamics.bag.plot import plot  # Matplotlib is slow to load

    file = arguments.output or _beside(arguments.log[0], '.png')
    plot(arguments.log, file, arguments.channel)
    print(file)
    return 0


def _beside(log: str, ending: str) -> Path:
    """Return a path beside a log, named after it."""
    path = Path(log).resolve()
    return path.with_name(path.name.removesuffix('.zstd').removesuffix('.mcap') + ending)


def _one_line(message: Warning | str, *_: object, **__: object) -> None:
    _complain(str(message))


def _complain(text: str) -> None:
    print(f'log: {printable(text, 1000)}', file=sys.stderr)


if __name__ == '__main__':
    sys.exit(main())
