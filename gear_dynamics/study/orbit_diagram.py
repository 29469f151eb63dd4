"""Orbit diagrams: how the motion changes with a parameter, swept up and down."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gear_dynamics.dynamics.attractors import SAME, same_orbit
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.study.chaos_edges import (
    FINER,
    SIDES,
    TRANSIENT,
    edges_text,
    ranges_text,
    refine,
)
from gear_dynamics.study.exponents import (
    EXPONENT_UNITS,
    convergence_table,
    exponent_columns,
    verdict,
)
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.kind import PERIOD, UNDECIDED, kind_shares
from gear_dynamics.study.lyapunov_table import FRICTION, with_frictions
from gear_dynamics.study.operation import FREQUENCY_RATIO, Operation
from gear_dynamics.study.outcome import Outcome
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
from gear_dynamics.study.tasks import Runner

SHORTEST = 80
"""Cycles of a record from which exponents and a period up to 32 can be told."""

FRICTIONS = (0.0, 0.03)

W_RANGE = (0.4, 2.0)
"""Of the sweep of w, where nothing else is asked for."""


def bifurcation(
    operation: Operation,
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

    Each motion is judged by `judgement.judge`. About the first begin and the first end of chaos
    along the parameter, the sweep is repeated on a finer grid with longer transients
    (`chaos_edges`).

    Parameters
    ----------
    operation : Operation
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
    values = np.linspace(*_range(operation, parameter, begin, end), count)
    if parameter == FRICTION:
        if frictions is not None:
            raise ParameterError(
                f'frictions would have no effect, as {FRICTION} is swept: leave them out'
            )
        frictions, rubbing = [math.nan], [operation]
    else:
        frictions = FRICTIONS if frictions is None else frictions
        rubbing = with_frictions(operation, frictions)
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
    operation: Operation, parameter: str, begin: float | None, end: float | None
) -> tuple[float, float]:
    present = operation.value(parameter)
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
        f'{step:.2g} apart; at the edges of chaos {step / FINER:.2g} apart, after {TRANSIENT} '
        'cycles at each'
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
        f'  swept {("up", "down")[direction]}: {edges_text(kinds, *fine)}',
        f'    {ranges_text(arrays["values"], kinds)}',
        f'    {kind_shares(kinds)}',
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
