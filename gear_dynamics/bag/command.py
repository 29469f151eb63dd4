"""The `log` executable: tells about, recovers, exports and plots logs."""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Sequence

from gear_dynamics.bag.source import LogError
from gear_dynamics.bag.verbs import export, info, plot, recover

VERBS = {'info': info, 'recover': recover, 'export': export, 'plot': plot}


def main(argv: Sequence[str] | None = None) -> int:
    """Run a verb and return the exit code: 0, or 2 with one line that says what is wrong."""
    parser = argparse.ArgumentParser(
        prog='log', description='Tell about, recover, export and plot logs of a gear pair.'
    )
    verbs = parser.add_subparsers(dest='verb', metavar='VERB', required=True)
    for name, verb in VERBS.items():
        summary = (verb.__doc__ or '').splitlines()[0]
        verb.add_arguments(verbs.add_parser(name, help=summary, description=summary))
    arguments = parser.parse_args(argv)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _one_line
            return VERBS[arguments.verb].run(arguments)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        print(f'log: {error.filename or "disk"}: {error.strerror}', file=sys.stderr)
    except LogError as error:
        print(f'log: {error}', file=sys.stderr)
    return 2


def _one_line(message: Warning | str, *_: object, **__: object) -> None:
    print(f'log: {message}', file=sys.stderr)


if __name__ == '__main__':
    sys.exit(main())
