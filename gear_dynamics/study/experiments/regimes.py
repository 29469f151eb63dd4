"""Regime map: the set of attractors over two parameters, found from several initial states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.study.declaration import COUNT_OPTION, TRANSIENT_OPTION, Option, Study
from gear_dynamics.study.drawing import legend_below, new_figure
from gear_dynamics.study.operating_point import (
    FREQUENCY_RATIO,
    FRICTION,
    OperatingPoint,
    friction_chaos,
)
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.regime_cells import CELL_UNITS, SECTION, RegimeGrid, cells_task, set_name
from gear_dynamics.study.sweep import check_range, unit_of
from gear_dynamics.study.symbols import axis_label
from gear_dynamics.study.tasks import Runner, chunks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Place = tuple[int, int]

AT_ONCE = 16
"""Operating points in one task."""

SHADES = (0.0, 0.75, 0.35, 1.0, 0.2, 0.6, 0.48, 0.88)
"""Places in the colour map of the most frequent sets: neighbours differ in grey too."""

NAMED = len(SHADES)
"""Sets of attractors with a shade of their own; the rarer ones share one."""

RANGES = {FREQUENCY_RATIO: (0.9, 1.5), FRICTION: (0.0, 0.06)}
"""Ranges where nothing else is asked for; of other parameters both ends must be given."""

STUDY = Study(
    'the set of attractors over two parameters, from several initial states',
    friction_chaos,
    {
        'parameter': Option('along the map: w, speed, load_torque or a parameter of the pair'),
        'begin': Option('beginning of its range; must be given unless w is varied', default=0.9),
        'end': Option('end of its range; must be given unless w is varied', default=1.5),
        'count': COUNT_OPTION,
        'across': Option('across the map: another of these'),
        'across_begin': Option(
            'beginning of its range; must be given unless friction_coefficient is varied',
            default=0.0,
        ),
        'across_end': Option(
            'end of its range; must be given unless friction_coefficient is varied', default=0.06
        ),
        'across_count': Option('values in that range', 2),
        'starts': Option('initial states at each place', 1),
        'fine': Option('times that the grid is halved where neighbours differ', 0),
        'transient': TRANSIENT_OPTION,
        'cycles': Option('mesh cycles of the record from which exponents are taken', 100),
        'section_phase': Option('mesh phase of the section, below 1', 0),
    },
    sweeps=FREQUENCY_RATIO,
)

UNITS = {
    'values': '1',
    'across': '1',
    'parameters': '-',
    'set': '-',
    'computed': '1',
    'row': '1',
    'column': '1',
    **CELL_UNITS,
}


def regimes(
    point: OperatingPoint,
    *,
    parameter: str = FREQUENCY_RATIO,
    begin: float | None = None,
    end: float | None = None,
    count: int = 31,
    across: str = FRICTION,
    across_begin: float | None = None,
    across_end: float | None = None,
    across_count: int = 13,
    starts: int = 4,
    fine: int = 1,
    transient: int = 400,
    cycles: int = 128,
    section_phase: float = SECTION,
    runner: Runner | None = None,
) -> Outcome:
    """Return the attractors at each pair of values of two parameters.

    A coarse grid is computed first. It is halved `fine` times; a place between neighbours with the
    same set of attractors takes over theirs, and the others are computed. Each attractor is
    assessed once (`assessment.assess`).

    Parameters
    ----------
    point : OperatingPoint
    parameter, across : str
        What is varied: w, speed, load_torque or a number of the pair.
    begin, end, across_begin, across_end : float, optional
        Their ranges; by default those of RANGES, of other parameters they must be given.
    count, across_count : int
        Values of the coarse grid.
    starts : int
        Initial states at each place: the static state and others from a fixed seed.
    fine : int
        Times that the grid is halved where neighbours differ.
    transient, cycles : int
        Mesh cycles before and in each record; 100 or more in a record.
    section_phase : float
        Mesh phase of the section [cycles], 0 or more and below 1.
    runner : Runner, optional

    Returns
    -------
    Outcome
        Its table has one row an attractor and place. Its further table is the set of attractors
        at each place of the finest grid (`_map`).

    Raises
    ------
    ParameterError
        If a parameter cannot be varied, both are one, or a range is missing or upside down.
    ValueError
        If the section phase is out of its range.
    """
    names = (parameter, across)
    _refuse_one(names)
    if not 0 <= section_phase < 1:
        raise ValueError(f'section_phase is {section_phase:g}: it must be from 0 to below 1')
    ends = (_range(point, parameter, 'begin', begin, end),
            _range(point, across, 'across_begin', across_begin, across_end))  # fmt: skip
    for name, (low, high) in zip(names, ends, strict=True):
        point.with_value(name, low), point.with_value(name, high)
    runner = runner or Runner()
    grid = RegimeGrid.over(ends[0], count, ends[1], across_count, fine)
    with runner.progress(-(-len(grid.first()) // AT_ONCE), 'regimes'):
        found = _Map(point, names, grid, (starts, transient, cycles, section_phase), runner)
        found.compute(grid.first())
        stride = grid.stride
        while stride > 1:
            found.refine(grid.between(stride))
            stride //= 2
    arrays = found.arrays()
    units = UNITS | {'values': unit_of(parameter), 'across': unit_of(across)}
    further = {'_map': _map_table(arrays)}
    return Outcome('regimes', _text(arrays), _table(arrays), arrays, units, further)


def _refuse_one(names: tuple[str, str]) -> None:
    if names[0] == names[1] or {*names} == {FREQUENCY_RATIO, 'speed'}:
        raise ParameterError(f'{names[0]} and {names[1]} are varied: name two different parameters')


def _range(
    point: OperatingPoint, name: str, option: str, begin: float | None, end: float | None
) -> tuple[float, float]:
    point.value(name)
    default = RANGES.get(name, (None, None))
    low = default[0] if begin is None else begin
    high = default[1] if end is None else end
    if low is None or high is None:
        other = option.replace('begin', 'end').replace('_', '-')
        raise ParameterError(
            f'{name} has no range: give --{option.replace("_", "-")} and --{other}'
        )
    check_range(**{option: low, option.replace('begin', 'end'): high})
    return low, high


class _Map:
    """The attractors found so far at the places of a grid."""

    def __init__(
        self,
        point: OperatingPoint,
        names: tuple[str, str],
        grid: RegimeGrid,
        motions: tuple[int, int, int, float],
        runner: Runner,
    ) -> None:
        self._operation, self._names, self._grid = point, names, grid
        self._motions, self._runner = motions, runner
        self._rows: dict[Place, Arrays] = {}
        self._sets: dict[Place, str] = {}

    def compute(self, places: Sequence[Place]) -> None:
        """Compute the attractors at some places."""
        parts = [places[part] for part in chunks(len(places), AT_ONCE)]
        starts, transient, cycles, section_phase = self._motions
        arguments = [
            {
                'points': [self._at(place) for place in part],
                'starts': starts,
                'transient': transient,
                'cycles': cycles,
                'section_phase': section_phase,
            }
            for part in parts
        ]
        for part, result in zip(parts, self._runner.run(cells_task, arguments), strict=True):
            for i, place in enumerate(part):
                own = {name: result[name][result['cell'] == i] for name in CELL_UNITS}
                self._rows[place] = own
                self._sets[place] = set_name([str(kind) for kind in own['kind']])

    def refine(self, places: list[tuple[Place, list[Place]]]) -> None:
        """Take over what neighbours agree in, and compute the others."""
        open_places = []
        for place, neighbours in places:
            sets = {self._sets[each] for each in neighbours}
            if len(sets) == 1:
                self._sets[place] = sets.pop()
            else:
                open_places.append(place)
        self.compute(open_places)

    def _at(self, place: Place) -> OperatingPoint:
        row, column = place
        one = self._operation.with_value(self._names[0], float(self._grid.values[column]))
        two = one.with_value(self._names[1], float(self._grid.across[row]))
        # A frequency ratio is kept where the second value changes wn.
        if self._names[0] == FREQUENCY_RATIO:
            return two.with_value(FREQUENCY_RATIO, float(self._grid.values[column]))
        return two

    def arrays(self) -> Arrays:
        """Return the map and a row for each attractor of each computed place."""
        shape = (len(self._grid.across), len(self._grid.values))
        places = sorted(self._rows)
        counts = [len(self._rows[place]['kind']) for place in places]
        row, column = np.repeat(np.array(places), counts, axis=0).T
        arrays = {
            'values': self._grid.values,
            'across': self._grid.across,
            'parameters': np.array(self._names),
            'set': np.array([self._sets[place] for place in np.ndindex(shape)]).reshape(shape),
            'computed': np.array([place in self._rows for place in np.ndindex(shape)]),
            'row': row,
            'column': column,
        }
        arrays['computed'] = arrays['computed'].reshape(shape)
        for name in CELL_UNITS:
            arrays[name] = np.concatenate([self._rows[place][name] for place in places])
        return arrays


def _text(arrays: Arrays) -> str:
    one, other = (str(name) for name in arrays['parameters'])
    values, across = arrays['values'], arrays['across']
    lines = [
        f'{one} {values[0]:g} to {values[-1]:g}, {other} {across[0]:g} to {across[-1]:g}: '
        f'{arrays["set"].size} places, {arrays["computed"].sum()} of them computed; '
        f'attractors at them, by share of the places'
    ]
    words, counts = np.unique(arrays['set'], return_counts=True)
    for i in np.argsort(-counts, kind='stable'):
        lines.append(f'  {counts[i] / arrays["set"].size:6.1%}  {words[i]}')
    several = np.mean([' + ' in word for word in arrays['set'].ravel()])
    lines.append(f'At {several:.1%} of the places there are several attractors.')
    lines.append(f'Largest exponents are not settled at {np.mean(~arrays["settled"]):.1%}.')
    return '\n'.join(lines)


def _places(arrays: Arrays, row: np.ndarray, column: np.ndarray) -> dict[str, np.ndarray]:
    one, other = (str(name) for name in arrays['parameters'])
    return {
        f'{one} [{unit_of(one)}]': arrays['values'][column],
        f'{other} [{unit_of(other)}]': arrays['across'][row],
    }


def _table(arrays: Arrays) -> dict[str, np.ndarray]:
    columns = _places(arrays, arrays['row'], arrays['column'])
    for name, unit in CELL_UNITS.items():
        values = arrays[name]
        columns[f'{name} [{unit}]'] = values.astype(int) if values.dtype == bool else values
    return columns


def _map_table(arrays: Arrays) -> dict[str, np.ndarray]:
    row, column = (each.ravel() for each in np.indices(arrays['set'].shape))
    return _places(arrays, row, column) | {
        'set [-]': arrays['set'].ravel(),
        'computed [1]': arrays['computed'].ravel().astype(int),
    }


def draw(arrays: Arrays) -> Figure:
    """Draw the sets of attractors, the largest exponent, the RMS and the time out of contact."""
    figure = new_figure(
        10, 8, 'Which motions there are; in (a), (b), (d) the greatest value of the attractors'
    )
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    _draw_sets(panels[1, 0], arrays)
    shown = (
        ('exponent', 'largest exponent [1/τ]'),
        ('rms', 'RMS of δ / b'),
        ('out_of_contact', 'share of time out of contact'),
    )
    others = (panels[0, 0], panels[0, 1], panels[1, 1])
    for axes, (name, title) in zip(others, shown, strict=True):
        mesh = axes.pcolormesh(
            arrays['values'], arrays['across'], _greatest(arrays, name), cmap='cividis'
        )
        axes.set_title(title)
        figure.colorbar(mesh, ax=axes)
        axes.grid(False)
    # The cells at the edges reach beyond the ranges, and a coefficient must not be shown below 0.
    panels[0, 0].set(xlim=arrays['values'][[0, -1]], ylim=arrays['across'][[0, -1]])
    for letter, axes in zip('abcd', panels.ravel(), strict=True):
        axes.set_title(f'({letter}) {axes.get_title(loc="left")}')
    one, other = (str(name) for name in arrays['parameters'])
    for axes in panels[-1]:
        axes.set_xlabel(axis_label(one))
    for axes in panels[:, 0]:
        axes.set_ylabel(axis_label(other))
    return figure


def _draw_sets(axes: Axes, arrays: Arrays) -> None:
    import matplotlib as mpl
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    words, counts = np.unique(arrays['set'], return_counts=True)
    order = np.argsort(-counts, kind='stable')
    named = [str(words[i]) for i in order[:NAMED]]
    number = np.full(arrays['set'].shape, len(named))
    for i, word in enumerate(named):
        number[arrays['set'] == word] = i
    colours = [*mpl.colormaps['cividis'](SHADES[: len(named)]), (1.0, 1.0, 1.0, 1.0)]
    axes.pcolormesh(
        arrays['values'],
        arrays['across'],
        number,
        cmap=ListedColormap(colours),
        vmin=-0.5,
        vmax=len(named) + 0.5,
    )
    axes.set_title('attractors')
    axes.grid(False)
    handles = [Patch(color=colours[i], label=word) for i, word in enumerate(named)]
    if len(words) > NAMED:
        handles.append(Patch(facecolor='white', edgecolor='black', label='others'))
    legend_below(axes, handles, ncols=2)


def _greatest(arrays: Arrays, name: str) -> np.ndarray:
    """Return the greatest value of the attractors at each place; else of the nearest computed."""
    from scipy.ndimage import distance_transform_edt

    field = np.full(arrays['set'].shape, -np.inf)
    np.maximum.at(field, (arrays['row'], arrays['column']), arrays[name])
    nearest = distance_transform_edt(
        ~arrays['computed'], return_distances=False, return_indices=True
    )
    return field[tuple(nearest)]
