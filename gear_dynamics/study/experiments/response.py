"""Frequency response: RMS and peaks against speed, swept up and down, with the jumps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.dynamics.regimes import LONGEST_STUDIED
from gear_dynamics.figure_style import COLOURS, FAINT
from gear_dynamics.study.assessment import assess, regime_shares
from gear_dynamics.study.declaration import COUNT_OPTION, TRANSIENT_OPTION, Option, Study
from gear_dynamics.study.drawing import band_handle, draw_band, new_figure
from gear_dynamics.study.exponent_tables import (
    EXPONENT_UNITS,
    convergence_table,
    exponent_columns,
    verdict,
)
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import (
    FREQUENCY_RATIO,
    OperatingPoint,
    default_operating_point,
    unzip,
)
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.sweep import by_value, chain_along, check_range, follow
from gear_dynamics.study.tasks import Runner, chunks

if TYPE_CHECKING:
    from matplotlib.figure import Figure


JUDGED = 128
"""Mesh cycles from which the kind of a motion is told."""

RECORD, SAMPLES = 32, 128
"""Mesh cycles in a record, and samples in one."""

PARTS = 20
"""Records of a motion without a period, whose RMS has a standard error from them."""

AT_ONCE = 60

JUMP = 0.5
"""Change of the RMS from one value to the next, over the greater of the two, that counts as a jump,
if it is FAR standard errors too."""

FAR = 4.0

UNITS = {
    'rms': 'b',
    'rms_error': 'b',
    'least': 'b',
    'greatest': 'b',
    'force_rms': 'N',
    'force_rms_error': 'N',
    'kind': '-',
    'period': 'cycles',
    **EXPONENT_UNITS,
    'w': '1',
    'speed': 'rad/s',
}

STUDY = Study(
    'RMS and peaks against speed, swept up and down, with the jumps',
    default_operating_point,
    {
        'begin': Option('lowest mesh frequency over wn'),
        'end': Option('highest mesh frequency over wn'),
        'count': COUNT_OPTION,
        'transient': TRANSIENT_OPTION,
    },
    sweeps=FREQUENCY_RATIO,
)


def response_task(points: list[OperatingPoint], states: np.ndarray) -> Arrays:
    """Return RMS, extremes, kind and all exponents of motions, by the names of UNITS.

    The RMS of a motion with a period is over as many whole periods as RECORD cycles hold, and has
    no error; that of another is over PARTS records. If it has a period after these, they were a
    transient, and the motion is taken as it is then.
    """
    assessed = assess(points, states, JUDGED)
    figures, ends = _figures(points, assessed)
    irregular = np.flatnonzero(assessed['period'] == 0).tolist()
    if irregular:
        later = assess([points[i] for i in irregular], ends[irregular], JUDGED)
        died = np.flatnonzero(later['period'] > 0)
        which = [irregular[i] for i in died]
        if which:
            last = {name: values[died] for name, values in later.items()}
            for name, values in _figures([points[i] for i in which], last)[0].items():
                figures[name][which] = values
    return figures


def _figures(points: list[OperatingPoint], assessed: Arrays) -> tuple[Arrays, np.ndarray]:
    """Return the figures of motions from where they were assessed, and the states at the end."""
    period = assessed['period']
    whole = np.where(period > 0, RECORD // np.maximum(period, 1) * period, RECORD)
    moments, ends = _moments(points, assessed['states'], whole)
    parts = np.repeat(moments[:, np.newaxis], PARTS, axis=1)
    irregular = np.flatnonzero(period == 0).tolist()
    rows = [points[i] for i in irregular]
    for part in range(1, PARTS if irregular else 1):
        parts[irregular, part], ends[irregular] = _moments(rows, ends[irregular], whole[irregular])
    rms, error = rms_of_parts(parts[..., 0], parts[..., 1])
    force_rms, force_error = rms_of_parts(parts[..., 2], parts[..., 3])
    figures = {
        'rms': rms,
        'rms_error': error,
        'least': parts[..., 4].min(axis=1),
        'greatest': parts[..., 5].max(axis=1),
        'force_rms': force_rms,
        'force_rms_error': force_error,
        'kind': assessed['kind'],
        'period': period,
        **{name: assessed[name] for name in EXPONENT_UNITS},
    }
    return figures, ends


def _moments(
    points: list[OperatingPoint], states: np.ndarray, whole: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return moments of the motions over the first `whole` of RECORD cycles, and the end states.

    (n, 6): mean and variance of delta / b and of the mesh force; least and greatest delta / b.
    """
    run = dynamics.run_cycles(*unzip(points), RECORD, states=states, samples_per_cycle=SAMPLES)
    rows = []
    for each, samples, cycles in zip(points, run.samples, whole, strict=True):
        delta = samples['delta'][: cycles * SAMPLES] / each.pair.half_backlash
        force = samples['mesh_force'][: cycles * SAMPLES]
        moments = [f(values) for values in (delta, force) for f in (np.mean, np.var)]
        rows.append([*moments, delta.min(), delta.max()])
    return np.array(rows), run.states


def rms_of_parts(mean: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the RMS about the mean and its standard error, from (n, PARTS) moments of parts."""
    # About the mean of each part: mean squares minus squared means would cancel.
    squares = variance + (mean - mean.mean(axis=1, keepdims=True)) ** 2
    rms = np.sqrt(squares.mean(axis=1))
    spread = squares.std(axis=1, ddof=1) / math.sqrt(PARTS)
    return rms, spread / (2 * np.where(rms > 0, rms, 1.0))


def response(
    point: OperatingPoint,
    *,
    begin: float = 0.05,
    end: float = 1.5,
    count: int = 300,
    transient: int = 1000,
    runner: Runner | None = None,
) -> Outcome:
    """Return the response to the mesh along w, each value continued from the last.

    Parameters
    ----------
    point : OperatingPoint
    begin, end : float
        Range of the ratio of the mesh frequency to wn; both ends belong to it.
    count : int
        Values.
    transient : int
        Mesh cycles before the record at each value; chaos may be a transient of many hundreds.
    runner : Runner, optional

    Raises
    ------
    ParameterError
        If a value is out of its range, or begin is not below end.
    """
    check_range(begin=begin, end=end)
    runner = runner or Runner()
    values = np.linspace(begin, end, count)
    chain = chain_along(point, FREQUENCY_RATIO, values)
    chains = [chain, chain[::-1]]
    begun = np.concatenate([scattered_states(each[0], 1) for each in chains])
    states = follow(chains, begun, transient, runner)
    arguments = [
        {'points': each[part], 'states': start[part]}
        for each, start in zip(chains, states, strict=True)
        for part in chunks(count, AT_ONCE)
    ]
    results = runner.run(response_task, arguments, 'response')
    joined = {name: np.concatenate([each[name] for each in results]) for name in results[0]}
    arrays = {
        name: by_value(each.reshape(2, count, *each.shape[1:]))[0] for name, each in joined.items()
    }
    arrays |= {'w': values, 'speed': np.array([each.speed for each in chain])}
    motions = _motions(arrays)
    further = {'_convergence': convergence_table(motions, arrays)}
    table = _table(motions, arrays)
    return Outcome('response', _text(point, arrays), table, arrays, UNITS, further)


def jumps(
    values: np.ndarray, rms: np.ndarray, error: np.ndarray, period: np.ndarray
) -> list[tuple[float, float, float]]:
    """Return where the RMS jumps along increasing values: the value and RMS before and after.

    From or to a motion with a period: between two others chance alone makes differences.
    """
    least = JUMP * np.maximum(rms[1:], rms[:-1])
    far = np.abs(np.diff(rms)) > np.maximum(least, FAR * np.hypot(error[1:], error[:-1]))
    steps = far & ((period[1:] > 0) | (period[:-1] > 0))
    return [
        (float((values[i] + values[i + 1]) / 2), float(rms[i]), float(rms[i + 1]))
        for i in np.flatnonzero(steps)
    ]


def contact_is_lost(least: np.ndarray, greatest: np.ndarray) -> np.ndarray:
    """Return where motions between these values of delta / b do not stay on one flank."""
    return (least < 1) & (greatest > -1)


def _text(point: OperatingPoint, arrays: dict[str, np.ndarray]) -> str:
    mu = point.pair.friction_coefficient
    lines = [
        f'mu = {mu:g}, load torque {point.load_torque:g} N m, RMS of delta over b; it jumps '
        f'where it changes by more than {JUMP:.0%} of the greater from one value to the next, from '
        'or to a period'
    ]
    for i, direction in enumerate(('up', 'down')):
        rms, error, period = (arrays[name][i] for name in ('rms', 'rms_error', 'period'))
        top = int(rms.argmax())
        spread = f' +- {error[top]:.4f}' if period[top] == 0 else ''
        lines.append(
            f'swept {direction}: greatest RMS {rms[top]:.4f}{spread} at w = {arrays["w"][top]:.3f} '
            f'({arrays["speed"][top] * 30 / math.pi:.0f} rpm)'
        )
        found = [
            f'{w:.3f} ({a:.3f} to {b:.3f})' for w, a, b in jumps(arrays['w'], rms, error, period)
        ]
        lines.append(f'  jumps at w = {", ".join(found)}' if found else '  no jump')
        lines.append(f'  {regime_shares(arrays["kind"][i])}')
        irregular = arrays['w'][period == 0]
        if irregular.size:
            lines.append(
                f'  first without a period up to {LONGEST_STUDIED} at w = {irregular[0]:.3f}'
            )
        lost = arrays['w'][contact_is_lost(arrays['least'][i], arrays['greatest'][i])]
        # Along the sweep upwards the lowest is where contact is first lost, downwards the last.
        place = f'{("first", "last")[i]} lost at w = {lost[0]:.3f}' if lost.size else 'never lost'
        lines.append(f'  contact is {place}')
    lines.append(verdict(arrays['settled'], arrays['sum_error']))
    return '\n'.join(lines)


def _motions(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    count = len(arrays['w'])
    return {
        'swept [-]': np.repeat(['up', 'down'], count),
        'w [1]': np.tile(arrays['w'], 2),
        'speed [rad/s]': np.tile(arrays['speed'], 2),
    }


def _table(motions: dict[str, np.ndarray], arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    found = {
        'rms_delta [b]': arrays['rms'],
        'rms_delta_error [b]': arrays['rms_error'],
        'least_delta [b]': arrays['least'],
        'greatest_delta [b]': arrays['greatest'],
        'rms_mesh_force [N]': arrays['force_rms'],
        'rms_mesh_force_error [N]': arrays['force_rms_error'],
        'kind [-]': arrays['kind'],
        'period [cycles]': arrays['period'],
        'settled [1]': arrays['settled'].all(axis=-1).astype(int),
        'sum_error [1]': arrays['sum_error'],
        **exponent_columns(arrays['exponents'], arrays['standard_errors']),
    }
    return motions | {name: each.ravel() for name, each in found.items()}


def draw(arrays: Arrays) -> Figure:
    """Draw RMS with two standard errors, extremes and force against w, both directions."""
    figure = new_figure(9, 8, 'Frequency response, swept up and down')
    grid = figure.subplots(3, 1, sharex=True)
    for i, (label, style) in enumerate((('swept up', '.-'), ('swept down', '.--'))):
        look = {'color': COLOURS[i], 'linewidth': 0.8, 'markersize': 3}
        for axes, name, scale in ((grid[0], 'rms', 1), (grid[2], 'force_rms', 1e-3)):
            centre, error = arrays[name][i] * scale, arrays[f'{name}_error'][i] * scale
            draw_band(axes, arrays['w'], centre, error, COLOURS[i])
        grid[0].plot(arrays['w'], arrays['rms'][i], style, label=label, **look)
        grid[1].plot(arrays['w'], arrays['greatest'][i], style, **look)
        grid[1].plot(arrays['w'], arrays['least'][i], style, **look)
        grid[2].plot(arrays['w'], arrays['force_rms'][i] / 1000, style, **look)
    for edge in (1, -1):
        grid[1].axhline(edge, color=FAINT, linewidth=1, label='edges of the gap' * (edge > 0))
    grid[1].legend()
    grid[0].set(ylabel='RMS of δ / b')
    grid[0].legend(handles=[*grid[0].get_legend_handles_labels()[0], band_handle()])
    grid[1].set(ylabel='least and greatest δ / b')
    grid[2].set(ylabel='RMS of the mesh force [kN]', xlabel='mesh frequency / ωn')
    return figure
