"""The `study` executable: experiments off line, each a sub-command with data and a figure."""

from __future__ import annotations

import argparse
import contextlib
import errno
import os
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gear_dynamics.study.declaration import (
    PRESETS,
    Option,
    Study,
    defaults,
    study_module,
    study_names,
)

if TYPE_CHECKING:
    from gear_dynamics.study.operating_point import OperatingPoint
    from gear_dynamics.study.outcome import Outcome

ENDINGS = ('.npz', '.csv', '.txt', '.png', '_*.csv')
"""Of the files of a study."""

RANGE_OPTIONS = ('--begin and --end', '--across-begin and --across-end')
"""Of what a study sweeps, and of what it varies across."""

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)

STOPPED = 130
"""Exit code after SIGINT, as shells have it, and after SIGTERM."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a study and return the exit code: 0, or 2 with one line that says what is wrong."""
    arguments = _parser().parse_args(argv)
    from gear_dynamics.compiling import Interrupted
    from gear_dynamics.simulation.stepping import IntegrationError
    from gear_dynamics.study.cluster import ClusterError

    try:
        with _sigterm_as_sigint():
            _run(arguments)
    except (KeyboardInterrupt, Interrupted):
        print('study: stopped; the same command goes on from what is finished', file=sys.stderr)
        return STOPPED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        print(f'study: {_disk_words(error, arguments.output)}', file=sys.stderr)
    except MemoryError:
        print('study: too little memory: ask for less at once', file=sys.stderr)
    except (ValueError, IntegrationError, ClusterError) as error:
        print(f'study: {error}', file=sys.stderr)
    else:
        return 0
    return 2


@contextlib.contextmanager
def _sigterm_as_sigint() -> Iterator[None]:
    """Let SIGTERM end a study as Ctrl-C does."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _disk_words(error: OSError, output: Path) -> str:
    """Return what is wrong with the output directory, and the remedy."""
    remedy = 'name another directory with --output'
    if error.errno in FULL:
        remedy = 'make room, and the same command goes on from what is finished'
    return f'{error.filename or output}: {error.strerror or error}: {remedy}'


def _run(arguments: argparse.Namespace) -> None:
    from gear_dynamics.study.cache import alone
    from gear_dynamics.study.warm_up import CompilingRunner

    values = _checked_values(arguments)
    point = _operation(arguments)
    with alone(arguments.output, arguments.study):
        _refuse_existing(arguments)
        parts = arguments.output / f'.{arguments.study}_parts'
        compile_ = _compile if arguments.cluster in (None, 'local') else None
        with contextlib.closing(
            CompilingRunner(compile_, parts, arguments.cluster, progress=not arguments.quiet)
        ) as runner:
            run = getattr(study_module(arguments.study), arguments.study)
            outcome = run(point, runner=runner, **values)
            outcome = outcome._replace(text=outcome.text + _faults_told(point))
        paths = _write(arguments, outcome)
        runner.forget()
    print(outcome.text)
    if runner.taken:
        count = runner.taken + runner.computed
        print(f'\n{runner.taken} of {count} tasks had been finished before.')
    print(f'\n{", ".join(str(path) for path in paths)}')


def _checked_values(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the options of the study that were given, by name.

    Raises
    ------
    ValueError
        If one is out of its range.
    """
    options = _about(arguments).options
    given = {name: getattr(arguments, name) for name in options}
    values = {name: value for name, value in given.items() if value is not None}
    for name, value in values.items():
        for each in value if isinstance(value, list | tuple) else [value]:
            options[name].check(name, each)
    return values


def _operation(arguments: argparse.Namespace) -> OperatingPoint:
    from gear_dynamics.study.operating_point import read_operating_point

    swept = _swept(arguments)
    if arguments.params:
        point = read_operating_point(arguments.params, **_replaced(arguments.set, swept))
    else:
        point = _about(arguments).preset()
    if arguments.faults:
        from gear_dynamics.model.faults import faulty
        from gear_dynamics.simulation.faults import read_faults

        point = point._replace(pair=faulty(point.pair, read_faults(arguments.faults)))
    for name, value in arguments.set:
        shown = f'{value:g}' if isinstance(value, float) else value
        for each, ends in zip(swept, RANGE_OPTIONS, strict=False):
            if name == each or {name, each} == {'w', 'speed'}:
                raise ValueError(
                    f'--set {name}={shown} would have no effect, as {arguments.study} sweeps '
                    f'{each}: give {ends}'
                )
        if name == 'friction_coefficient' and 'frictions' in _about(arguments).options:
            raise ValueError(
                f'--set {name}={shown} would have no effect: give {arguments.study} --frictions'
            )
        point = point.with_value(name, value)
    return point


def _swept(arguments: argparse.Namespace) -> list[str]:
    """Return what the study sweeps: its parameter, and that across it in a map."""
    first = getattr(arguments, 'parameter', None) or _about(arguments).sweeps
    second = ''
    if 'across' in _about(arguments).options:
        second = arguments.across or defaults(arguments.study)['across']
    return [name for name in (first, second) if name]


def _faults_told(point: OperatingPoint) -> str:
    """Return a line for each fault of the pair, to stand below the result."""
    return ''.join(f'\nwith {fault}' for fault in getattr(point.pair, 'faults', ()))


def _replaced(settings: Sequence[tuple[str, Any]], swept: Sequence[str]) -> dict[str, float]:
    """Return default speed and torque where those of a parameter file would have no effect."""
    from gear_dynamics.parameters.run_settings import RunSettings

    run, names = RunSettings(), {name for name, _ in settings} | {*swept}
    names |= {'speed'} if 'w' in names else set()
    return {name: getattr(run, name) for name in ('speed', 'load_torque') if name in names}


def _refuse_existing(arguments: argparse.Namespace) -> None:
    for ending in ENDINGS:
        for path in sorted(arguments.output.glob(arguments.study + ending)):
            raise ValueError(f'{path} exists: move it, or name another directory with --output')


def _compile() -> None:
    # Where the help is asked for or an option is wrong, nothing must be loaded.
    from gear_dynamics.compiling import announced, interruptible
    from gear_dynamics.study.warm_up import warm_up

    def say(line: str) -> None:
        print(f'study: {line}', file=sys.stderr, flush=True)

    with announced('the model', say), interruptible():
        warm_up()


def _write(arguments: argparse.Namespace, outcome: Outcome) -> list[Path]:
    """Write data, text and figure; return the paths of the files.

    They come to their places when all are written, so that a full disk leaves no half of a result.
    """
    from gear_dynamics.study.drawing import save_figure
    from gear_dynamics.study.outcome import write_outcome

    draw = study_module(arguments.study).draw
    with tempfile.TemporaryDirectory(prefix='.unfinished_', dir=arguments.output) as folder:
        figure = Path(folder) / f'{outcome.name}.png'
        save_figure(draw, outcome.arrays, figure)
        # The NPZ last: where it is, all is.
        files = sorted([figure, *write_outcome(outcome, Path(folder))], key=_is_npz)
        return [path.replace(arguments.output / path.name) for path in files]


def _is_npz(path: Path) -> bool:
    return path.suffix == '.npz'


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='study',
        description='Experiments on the gear pair, off line. Each writes a PNG, the data as NPZ '
        'and CSV, and its result as text. A study that was stopped goes on when the same command '
        'is given again.',
    )
    studies = parser.add_subparsers(dest='study', metavar='STUDY', required=True)
    for name in study_names():
        about = study_module(name).STUDY
        one = studies.add_parser(name, help=about.summary, description=about.summary)
        _add_common(one, about)
        for option, default in defaults(name).items():
            _add_option(one, option, about.options[option], default)
    return parser


def _about(arguments: argparse.Namespace) -> Study:
    return study_module(arguments.study).STUDY


def _add_common(parser: argparse.ArgumentParser, about: Study) -> None:
    parser.add_argument(
        '--params',
        type=Path,
        metavar='FILE',
        help='ROS parameter file with pair, speed and load_torque; by default '
        f'{PRESETS[about.preset]}',
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
        '--faults',
        type=Path,
        metavar='FILE',
        help='YAML file with a list of faults of the pair, see docs/faults.md; the text of the '
        'result names them',
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


def _add_option(parser: argparse.ArgumentParser, name: str, option: Option, default: Any) -> None:
    several = isinstance(default, tuple | list)
    kind: type = type(default[0]) if several else type(default)
    shown = ' '.join(f'{each:g}' for each in default) if several else default
    parser.add_argument(
        f'--{name.replace("_", "-")}',
        type=kind,
        nargs='+' if option.several else len(default) if several else None,
        metavar=kind.__name__.upper(),
        help=f'{option.text}; by default {shown}',
    )


def _setting(text: str) -> tuple[str, float | str | bool]:
    name, equals, value = text.partition('=')
    if not (equals and value):
        raise argparse.ArgumentTypeError(f'{text!r} is not NAME=VALUE')
    try:
        return name, float(value)
    except ValueError:
        return name, {'true': True, 'false': False}.get(value, value)


if __name__ == '__main__':
    sys.exit(main())
