"""Orbit diagrams: how the motion changes with a parameter, swept up and down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics.dynamics.attractors import SAME, same_orbit
from gear_dynamics.dynamics.regimes import PERIOD, UNDECIDED
from gear_dynamics.figure_style import COLOURS
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.study.assessment import regime_shares
from gear_dynamics.study.chaos_edges import (
    EDGE_TRANSIENT,
    FINER,
    SIDES,
    edge_in,
    edges_text,
    ranges_text,
    refine,
)
from gear_dynamics.study.declaration import (
    COUNT_OPTION,
    CYCLES_OPTION,
    TRANSIENT_OPTION,
    Option,
    Study,
)
from gear_dynamics.study.drawing import band_handle, draw_band, new_figure, zero_line
from gear_dynamics.study.exponent_tables import (
    EXPONENT_UNITS,
    convergence_table,
    exponent_columns,
    verdict,
)
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operating_point import (
    FREQUENCY_RATIO,
    FRICTION,
    OperatingPoint,
    friction_chaos,
    with_frictions,
)
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.sweep import (
    DOWN,
    UNITS,
    UP,
    by_value,
    chain_along,
    check_range,
    follow,
    measure,
    unit_of,
)
from gear_dynamics.study.symbols import axis_label
from gear_dynamics.study.tasks import Runner

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SHORTEST = 80
"""dynamics.Cycles of a record from which exponents and a period up to 32 can be told."""

FRICTIONS = (0.0, 0.03)

W_RANGE = (0.4, 2.0)
"""Of the sweep of w, where nothing else is asked for."""

STUDY = Study(
    'orbit diagrams and largest exponents along a parameter, swept up and down',
    friction_chaos,
    {
        'frictions': Option(
            'friction coefficients to compare, if not swept', default=FRICTIONS, several=True
        ),
        'parameter': Option('what is swept: w, speed, load_torque or a parameter of the pair'),
        'begin': Option(
            'beginning of the range; must be given unless w is swept', default=W_RANGE[0]
        ),
        'end': Option('end of the range; must be given unless w is swept', default=W_RANGE[1]),
        'count': COUNT_OPTION,
        'transient': TRANSIENT_OPTION,
        'cycles': CYCLES_OPTION,
    },
    sweeps=FREQUENCY_RATIO,
)


def bifurcation(
    point: OperatingPoint,
    frictions: Sequence[float] | None = None,
    *,
    parameter: str = FREQUENCY_RATIO,
    begin: float | None = None,
    end: float | None = None,
    count: int = 600,
    transient: int = 300,
    cycles: int = 150,
    runner: Runner | None = None,
) -> Outcome:
    """Return the orbit diagrams and all exponents along a parameter, up and down.

    Each motion is assessed by `assessment.assess`. About the first begin and the first end of chaos
    along the parameter, the sweep is repeated on a finer grid with longer transients
    (`chaos_edges`).

    Parameters
    ----------
    point : OperatingPoint
    frictions : sequence of float, optional
        Friction coefficients to compare, by default 0 and 0.03. If `parameter` is
        friction_coefficient there must be none, and the array `friction` is one NaN.
    parameter : str
        What is swept: w, speed, load_torque or a parameter of the pair.
    begin, end : float
        Range, in the parameter's own unit; both ends belong to it. By default W_RANGE if w is
        swept; of any other parameter both must be given.
    count : int
        Values.
    transient, cycles : int
        Mesh cycles before and in the record at each value. The next value begins where the
        transient of this one ended.
    runner : Runner, optional

    Returns
    -------
    Outcome
        Its further tables are the points of the diagram (`_section`), the means of all exponents
        over the first cycles (`_convergence`), and the finer sweeps (`_edges`) if there are any.

    Raises
    ------
    ParameterError
        If the parameter cannot be varied, its range is missing or upside down, a value is out of
        its range, a friction coefficient is given twice, or any where friction is swept.
    ValueError
        If the record is too short.
    """
    if cycles < SHORTEST:
        raise ValueError(f'{cycles} cycles are too few: give {SHORTEST} or more')
    runner = runner or Runner()
    values = np.linspace(*_range(point, parameter, begin, end), count)
    if parameter == FRICTION:
        if frictions is not None:
            raise ParameterError(
                f'frictions would have no effect, as {FRICTION} is swept: leave them out'
            )
        frictions, rubbing = [math.nan], [point]
    else:
        frictions = FRICTIONS if frictions is None else frictions
        rubbing = with_frictions(point, frictions)
    chains = [
        chain_along(each, parameter, way) for each in rubbing for way in (values, values[::-1])
    ]
    begun = np.concatenate([scattered_states(chain[0], 1) for chain in chains])
    states = follow(chains, begun, transient, runner)
    swept = measure(chains, states, cycles, runner)
    arrays = {name: by_value(array) for name, array in swept.items()}
    fine = refine(
        [each for each in rubbing for _ in (UP, DOWN)],
        parameter,
        values,
        np.concatenate(arrays['kind']),
        np.concatenate(by_value(states)),
        runner,
    )
    arrays |= {f'fine_{name}': np.stack([f[::2], f[1::2]], axis=1) for name, f in fine.items()}
    arrays |= {'values': values, 'friction': np.array(frictions), 'parameter': np.array(parameter)}
    tables = _tables(arrays)
    table = tables.pop('')
    return Outcome('bifurcation', _text(arrays), table, arrays, _units(parameter), tables)


def _range(
    point: OperatingPoint, parameter: str, begin: float | None, end: float | None
) -> tuple[float, float]:
    present = point.value(parameter)
    if parameter == FREQUENCY_RATIO:
        begin = W_RANGE[0] if begin is None else begin
        end = W_RANGE[1] if end is None else end
    if begin is None or end is None:
        unit = '' if unit_of(parameter) == '1' else f' {unit_of(parameter)}'
        raise ParameterError(
            f'{parameter} has no range of its own: give begin and end; its value is '
            f'{present:g}{unit}'
        )
    check_range(begin=begin, end=end)
    return begin, end


def _units(parameter: str) -> dict[str, str]:
    swept = dict.fromkeys(('values', 'fine_values'), unit_of(parameter))
    fine = {f'fine_{name}': unit for name, unit in EXPONENT_UNITS.items()} | {'fine_kind': '-'}
    return UNITS | swept | fine | {'friction': '1', 'parameter': '-'}


def _text(arrays: dict[str, np.ndarray]) -> str:
    values, parameter = arrays['values'], arrays['parameter']
    unit = '' if unit_of(str(parameter)) == '1' else f' {unit_of(str(parameter))}'
    step = values[1] - values[0]
    lines = [
        f'{parameter} from {values[0]:g} to {values[-1]:g}{unit}, {len(values)} values, '
        f'{step:.2g} apart; at the edges of chaos {step / FINER:.2g} apart, after '
        f'{EDGE_TRANSIENT} cycles at each'
    ]
    for i, mu in enumerate(arrays['friction']):
        kind, place = in_kind(arrays['kind'][i]), in_place(arrays['kind'][i], arrays['sections'][i])
        named = '' if math.isnan(mu) else f'mu = {mu:g}: '
        lines += [
            '',
            f'{named}up and down differ at {np.mean(kind | place):.1%}: in kind or period at '
            f'{kind.mean():.1%}, in place alone at {np.mean(place & ~kind):.1%}',
        ]
        for direction in (UP, DOWN):
            lines += _paragraph(arrays, i, direction)
    lines += ['', verdict(arrays['settled'], arrays['sum_error'])]
    if has_edges(arrays):
        swept = np.isfinite(arrays['fine_values'])
        fine = verdict(arrays['fine_settled'][swept], arrays['fine_sum_error'][swept])
        lines.append(f'At the edges of chaos: {fine}')
    return '\n'.join(lines)


def _paragraph(arrays: dict[str, np.ndarray], i: int, direction: int) -> list[str]:
    """Return what one sweep of friction i showed."""
    kinds = arrays['kind'][i, direction]
    fine = (arrays['fine_values'][i, direction], arrays['fine_kind'][i, direction])
    return [
        f'  swept {("up", "down")[direction]}: {edges_text(arrays["values"], kinds, *fine)}',
        f'    {ranges_text(arrays["values"], kinds)}',
        f'    {regime_shares(kinds)}',
    ]


def in_kind(kinds: np.ndarray) -> np.ndarray:
    """Return where the motions of two sweeps, (2, values), are of different kinds or periods.

    An undecided one has no kind that could differ.
    """
    return (kinds[UP] != kinds[DOWN]) & np.all(kinds != UNDECIDED, axis=0)


def in_place(kinds: np.ndarray, sections: np.ndarray) -> np.ndarray:
    """Return where the motions of two sweeps lie in different places.

    Those of one period are compared by their points; others by the mean of delta / b, which must
    differ by SAME and four of its standard errors, as if the points were independent.

    kinds : (2, values) array; sections : (2, values, cycles, 2) array
    """
    delta = sections[..., 0]
    mean, spread = delta.mean(axis=-1), delta.std(axis=-1)
    far = np.abs(mean[UP] - mean[DOWN]) > SAME + 4 * spread.max(axis=0) / np.sqrt(delta.shape[-1])
    for i, (one, other) in enumerate(kinds.T):
        if one == other and one.startswith(PERIOD):
            period = int(one.removeprefix(PERIOD))
            far[i] = not same_orbit(sections[UP, i, -period:], sections[DOWN, i, -period:])
    return far


def _motions(arrays: dict[str, np.ndarray], values: np.ndarray) -> dict[str, np.ndarray]:
    """Return the columns that identify motions.

    values : (frictions, 2, ..., count) array
        Of the swept parameter.
    """
    parameter = str(arrays['parameter'])
    columns = {f'{parameter} [{unit_of(parameter)}]': values}
    further = (1,) * (values.ndim - 2)
    if parameter != FRICTION:
        columns['friction_coefficient [1]'] = arrays['friction'].reshape(-1, 1, *further)
    columns['swept [-]'] = np.array(['up', 'down']).reshape(-1, *further)
    return {name: np.broadcast_to(each, values.shape).ravel() for name, each in columns.items()}


def _tables(arrays: dict[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """Return the tables by what is added to the name of their files."""
    motions = _motions(arrays, np.broadcast_to(arrays['values'], arrays['kind'].shape))
    delta, slope = np.moveaxis(arrays['sections'], -1, 0)
    measured = {
        'kind [-]': arrays['kind'],
        'settled [1]': arrays['settled'].all(axis=-1).astype(int),
        'discarded [cycles]': arrays['discarded'],
        'zero_one_test [1]': arrays['zero_one'],
        'least_delta [b]': delta.min(axis=-1),
        'greatest_delta [b]': delta.max(axis=-1),
        'sum_error [1]': arrays['sum_error'],
        **exponent_columns(arrays['exponents'], arrays['standard_errors']),
    }
    tables = {
        '': motions | {name: each.ravel() for name, each in measured.items()},
        '_section': {
            **{name: np.repeat(each, delta.shape[-1]) for name, each in motions.items()},
            'delta [b]': delta.ravel(),
            'delta_dot [b wn]': slope.ravel(),
        },
        '_convergence': convergence_table(motions, arrays),
    }
    if has_edges(arrays):
        tables['_edges'] = _edges_table(arrays)
    return tables


def has_edges(arrays: dict[str, np.ndarray]) -> bool:
    """Return whether any sweep has an edge of chaos, and so a finer sweep about it."""
    return bool(np.isfinite(arrays['fine_values']).any())


def _edges_table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    values = arrays['fine_values']
    swept = np.isfinite(values).ravel()
    measured = {
        'edge [-]': np.broadcast_to(np.array(SIDES)[:, np.newaxis], values.shape),
        'kind [-]': arrays['fine_kind'],
        'settled [1]': arrays['fine_settled'].all(axis=-1).astype(int),
        'sum_error [1]': arrays['fine_sum_error'],
        **exponent_columns(arrays['fine_exponents'], arrays['fine_standard_errors']),
    }
    columns = _motions(arrays, values) | measured
    return {name: each.ravel()[swept] for name, each in columns.items()}


WORDS = ('swept up', 'swept down')


def draw(arrays: Arrays) -> Figure:
    """Draw a column for each friction coefficient."""
    frictions, parameter = arrays['friction'], str(arrays['parameter'])
    label = axis_label(parameter)
    title = f'Motion on the section against {label}'
    figure = new_figure(6.5 * max(len(frictions), 1.4), 7.5, title)
    grid = figure.subplots(
        2, len(frictions), squeeze=False, sharex=True, sharey='row', height_ratios=(3, 1.4)
    )
    for i, mu in enumerate(frictions):
        named = '' if parameter == 'friction_coefficient' else f'μ = {mu:g}'
        _orbits(grid[0, i], arrays['values'], arrays['sections'][i, ..., 0], named)
        _exponents(grid[1, i], arrays, i)
        grid[1, i].set_xlabel(label)
    grid[0, 0].set_ylabel('δ / b')
    grid[1, 0].set_ylabel('largest exponent [1/τ]')
    lowest = float(arrays['exponents'][..., 0].min())
    highest = float(arrays['exponents'][..., 0].max())
    grid[1, 0].set_ylim(max(lowest * 1.05, -0.12), highest * 1.1 + 0.01)
    return figure


def _orbits(axes: Axes, values: np.ndarray, delta: np.ndarray, title: str) -> None:
    # Down first and larger, so that both show where they agree.
    for direction, size in ((DOWN, 1.6), (UP, 0.5)):
        x = np.repeat(values, delta.shape[-1])
        y = delta[direction].ravel()
        colour = COLOURS[direction]
        axes.scatter(x, y, s=size, color=colour, linewidths=0, rasterized=True)
        axes.plot([], [], 'o', color=colour, markersize=4, label=WORDS[direction])
    axes.set_title(title)
    axes.legend(loc='lower left')


def _exponents(axes: Axes, arrays: Arrays, i: int) -> None:
    values = arrays['values']
    for direction in (DOWN, UP):
        colour = COLOURS[direction]
        exponent = arrays['exponents'][i, direction, :, 0]
        draw_band(axes, values, exponent, arrays['standard_errors'][i, direction, :, 0], colour)
        axes.plot(values, exponent, color=colour, linewidth=0.8)
        for side, word in enumerate(SIDES):
            fine = arrays['fine_values'][i, direction, side]
            place = edge_in(fine, arrays['fine_kind'][i, direction, side], side)
            if np.isfinite(place):
                label = f'chaos {word}s, {WORDS[direction]}: {place:.{_decimals(fine)}f}'
                axes.axvline(place, color=colour, linewidth=0.8, linestyle=':', label=label)
    axes.legend(handles=[*axes.get_legend_handles_labels()[0], band_handle()], loc='upper left')
    zero_line(axes)


def _decimals(fine: np.ndarray) -> int:
    """Return how many decimals the steps of a grid resolve."""
    return max(0, math.ceil(-math.log10(fine[1] - fine[0])))
