"""The `study` executable: experiments off line, each a sub-command with data and a figure."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

PRESET = 'config/friction_chaos.yaml'
DEFAULT = 'the default pair'


class Study(NamedTuple):
    """What the command line knows of a study.

    Attributes
    ----------
    summary : str
    operation : str
        Function of `gear_dynamics.study` that gives what is studied without --params.
    options : dict of str to (default, help)
        Options and the function's arguments of the same names; the default's type is the
        option's. A tuple takes as many values, a list one or more.
    """

    summary: str
    operation: str
    options: dict[str, tuple[Any, str]]


_FRICTIONS = 'friction coefficients to compare'
_TRANSIENT = 'mesh cycles before each record'
_COUNT = 'values in the range'

STUDIES = {
    'spectrum': Study(
        'RMS and mesh harmonics with and without friction, and a map over phase and speed',
        'default_operation',
        {
            'frictions': ((0.0, 0.03), 'two friction coefficients to compare'),
            'phases': (24, 'phases of the transmission error in the map; 0 for no map'),
            'speeds': (40, 'speeds in the map'),
            'slowest': (20.0, 'lowest speed of the map [rad/s]'),
            'fastest': (1200.0, 'highest speed of the map [rad/s]'),
            'transient': (300, _TRANSIENT),
        },
    ),
    'lyapunov': Study(
        'all Lyapunov exponents with standard errors, from several initial states',
        'friction_chaos',
        {
            'frictions': ([0.0, 0.03, 0.05], _FRICTIONS),
            'initial_states': (6, 'initial states for each friction coefficient'),
            'transient': (500, _TRANSIENT),
            'cycles': (10000, 'mesh cycles in each record'),
        },
    ),
    'bifurcation': Study(
        'orbit diagrams and largest exponents along a parameter, swept up and down',
        'friction_chaos',
        {
            'frictions': ([0.0, 0.03], _FRICTIONS),
            'parameter': ('w', 'what is swept: w, speed, load_torque or a parameter of the pair'),
            'begin': (0.4, 'beginning of the range'),
            'end': (2.0, 'end of the range'),
            'count': (600, _COUNT),
            'transient': (300, _TRANSIENT),
            'cycles': (150, 'mesh cycles in each record'),
        },
    ),
    'attractor': Study(
        'history, spectrum, phase portrait, section and exponents of one motion',
        'friction_chaos',
        {
            'frictions': ([0.0, 0.03, 0.05], _FRICTIONS),
            'transient': (1000, _TRANSIENT),
            'cycles': (4000, 'mesh cycles in the record'),
        },
    ),
    'basins': Study(
        'which attractor each initial state reaches',
        'friction_chaos',
        {
            'size': (80, 'initial states along each side of the picture'),
            'reach': ((2.0, 1.0), 'greatest delta / b and delta_dot / (b wn)'),
            'transient': (400, _TRANSIENT),
        },
    ),
    'response': Study(
        'RMS and peaks against speed, swept up and down, with the jumps',
        'default_operation',
        {
            'begin': (0.05, 'lowest mesh frequency over wn'),
            'end': (1.5, 'highest mesh frequency over wn'),
            'count': (300, _COUNT),
            'transient': (300, _TRANSIENT),
        },
    ),
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run a study and return the exit code: 0, or 2 with one line that says what is wrong."""
    arguments = _parser().parse_args(argv)
    from gear_dynamics.model.simulator import IntegrationError
    from gear_dynamics.study.cluster import ClusterError

    try:
        _run(arguments)
    except KeyboardInterrupt:
        print('study: stopped; the same command goes on from here', file=sys.stderr)
        return 130
    except OSError as error:
        print(f'study: {error.filename or "disk"}: {error.strerror or error}', file=sys.stderr)
    except (ValueError, IntegrationError, ClusterError) as error:
        print(f'study: {error}', file=sys.stderr)
    else:
        return 0
    return 2


def _run(arguments: argparse.Namespace) -> None:
    from gear_dynamics import study
    from gear_dynamics.study.figures.style import save_figure
    from gear_dynamics.study.outcome import write_outcome

    about = STUDIES[arguments.study]
    if arguments.params:
        operation = study.read_operation(arguments.params)
    else:
        operation = getattr(study, about.operation)()
    for name, value in arguments.set:
        operation = operation.with_value(name, value)
    values = {name: getattr(arguments, name) for name in about.options}
    parts = arguments.output / f'.{arguments.study}_parts'
    runner = study.Runner(parts, arguments.cluster, progress=not arguments.quiet)
    try:
        outcome = getattr(study, arguments.study)(operation, runner=runner, **values)
    finally:
        runner.close()
    files = write_outcome(outcome, arguments.output)
    figure = arguments.output / f'{outcome.name}.png'
    draw = importlib.import_module(f'gear_dynamics.study.figures.{arguments.study}').draw
    save_figure(draw, outcome.arrays, figure)
    runner.forget()
    print(outcome.text)
    print(f'\n{", ".join(str(path) for path in [figure, *files])}')


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='study',
        description='Experiments on the gear pair, off line. Each writes a PNG, the data as NPZ '
        'and CSV, and its result as text. A study that was stopped goes on when the same command '
        'is given again.',
    )
    studies = parser.add_subparsers(dest='study', metavar='STUDY', required=True)
    for name, about in STUDIES.items():
        one = studies.add_parser(name, help=about.summary, description=about.summary)
        _add_common(one, about)
        for option, (default, text) in about.options.items():
            _add_option(one, option, default, text)
    return parser


def _add_common(parser: argparse.ArgumentParser, about: Study) -> None:
    preset = PRESET if about.operation == 'friction_chaos' else DEFAULT
    parser.add_argument(
        '--params',
        type=Path,
        metavar='FILE',
        help=f'ROS parameter file with pair, speed and load_torque; by default {preset}',
    )
    parser.add_argument(
        '--set',
        type=_setting,
        action='append',
        metavar='NAME=VALUE',
        default=[],
        help='change w, speed, load_torque or a parameter of the pair; may be given again',
    )
    parser.add_argument(
        '--output',
        type=Path,
        metavar='DIRECTORY',
        default=Path('study_results'),
        help='for the files; by default ./study_results',
    )
    parser.add_argument(
        '--cluster',
        metavar='ADDRESS',
        help='Dask scheduler to send the work to, or "local" to start one here',
    )
    parser.add_argument('--quiet', action='store_true', help='no progress bar')


def _add_option(parser: argparse.ArgumentParser, name: str, default: Any, text: str) -> None:
    several = isinstance(default, tuple | list)
    kind: type = type(default[0]) if several else type(default)
    shown = ' '.join(f'{each:g}' for each in default) if several else default
    parser.add_argument(
        f'--{name.replace("_", "-")}',
        type=kind,
        nargs='+' if isinstance(default, list) else len(default) if several else None,
        default=default,
        metavar=kind.__name__.upper(),
        help=f'{text}; by default {shown}',
    )


def _setting(text: str) -> tuple[str, float]:
    name, equals, value = text.partition('=')
    try:
        if not equals:
            raise ValueError
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f'{text!r} is not NAME=VALUE with a number') from None


if __name__ == '__main__':
    sys.exit(main())
