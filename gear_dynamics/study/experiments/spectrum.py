"""What friction does to the spectrum: RMS and mesh harmonics, and where over phase and speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gear_dynamics.dynamics.regimes import PERIOD
from gear_dynamics.figure_style import COLOURS, FAINT, INK
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.study.declaration import TRANSIENT_OPTION, Option, Study
from gear_dynamics.study.drawing import legend_below, new_figure
from gear_dynamics.study.harmonics import DRAWN, HARMONICS, QUANTITIES
from gear_dynamics.study.operating_point import (
    OperatingPoint,
    default_operating_point,
    with_frictions,
)
from gear_dynamics.study.outcome import Arrays, Outcome
from gear_dynamics.study.published import CLAIMS, holds
from gear_dynamics.study.spectrum_tasks import (
    OTHER_UNITS,
    RECORD,
    RECURS_IN,
    map_task,
    quantities,
    table_task,
)
from gear_dynamics.study.sweep import check_range
from gear_dynamics.study.tasks import Runner, chunks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


UNITS = {
    'friction': '1',
    'period': 'cycles',
    'cycles': 'cycles',
    'order': '1',
    'ax_lines': 'm/s2',
    'ay_lines': 'm/s2',
    'map': 'm/s2; delta m; forces N',
    'map_phase': 'rad',
    'map_speed': 'rad/s',
    'map_period': 'cycles',
    **{f'map_{name}': '1' for name in CLAIMS},
}

AT_ONCE = 30

STUDY = Study(
    'RMS and mesh harmonics with and without friction, and a map over phase and speed',
    default_operating_point,
    {
        'frictions': Option('two friction coefficients to compare'),
        'phases': Option('phases of the transmission error in the map; 0 for no map', 0),
        'speeds': Option('speeds in the map', 1),
        'slowest': Option('lowest speed of the map [rad/s]'),
        'fastest': Option('highest speed of the map [rad/s]'),
        'transient': TRANSIENT_OPTION,
    },
)


def spectrum(
    point: OperatingPoint,
    frictions: Sequence[float] = (0.0, 0.03),
    *,
    phases: int = 24,
    speeds: int = 40,
    slowest: float = 20.0,
    fastest: float = 1200.0,
    transient: int = 300,
    runner: Runner | None = None,
) -> Outcome:
    """Compare the spectra with and without friction.

    Parameters
    ----------
    point : OperatingPoint
    frictions : two floats
        Friction coefficients: the one to compare with, and the other.
    phases, speeds : int
        Size of the map over the phase of the transmission error and the speed; 0 for no map.
    slowest, fastest : float
        Speeds of the map [rad/s].
    transient : int
        Mesh cycles before the record in the map.
    runner : Runner, optional

    Raises
    ------
    ParameterError
        If a value is out of its range, slowest is not below fastest, or the friction coefficients
        are not two different ones.
    """
    if len(frictions) != 2:
        raise ParameterError(f'{len(frictions)} friction coefficients are given: give two')
    check_range(slowest=slowest, fastest=fastest)
    runner = runner or Runner()
    rubbing = with_frictions(point, frictions)
    angles = np.linspace(-math.pi, math.pi, phases, endpoint=False)
    grid = np.linspace(slowest, fastest, speeds)
    # Before anything is computed, so that a speed out of range is refused at once.
    places = _places(rubbing, angles, grid)
    results = runner.run(table_task, [{'point': each} for each in rubbing], 'spectra')
    arrays = {name: np.array([result[name] for result in results]) for name in results[0]}
    arrays |= {'friction': np.array(frictions), 'order': np.arange(1, DRAWN + 1)}
    further = {}
    if places:
        arrays |= {'map_phase': angles, 'map_speed': grid}
        arrays |= _map(places, (len(rubbing), phases, speeds), transient, runner)
        further = {'_map': _map_table(arrays)}
    units = quantities() | UNITS
    return Outcome('spectrum', _text(point, arrays), _table(arrays), arrays, units, further)


def _places(
    rubbing: Sequence[OperatingPoint], angles: np.ndarray, speeds: np.ndarray
) -> list[OperatingPoint]:
    """Return what is run for the map: each friction at each phase and speed."""
    return [
        each.with_value('transmission_error_phase', float(angle)).with_value('speed', float(speed))
        for each in rubbing
        for angle in angles
        for speed in speeds
    ]


def _map(
    places: list[OperatingPoint], shape: tuple[int, int, int], transient: int, runner: Runner
) -> dict[str, np.ndarray]:
    """Return rows, periods and claims; shape : frictions, phases and speeds of the places."""
    arguments = [
        {'points': places[part], 'transient': max(transient, RECURS_IN - RECORD)}
        for part in chunks(len(places), AT_ONCE)
    ]
    results = runner.run(map_task, arguments, 'map')
    rows = np.concatenate([result['rows'] for result in results])
    rows = rows.reshape(*shape, len(QUANTITIES), HARMONICS + 1)
    period = np.concatenate([result['period'] for result in results]).reshape(shape)
    claims = {f'map_{name}': where for name, where in holds(rows).items()}
    return {'map': rows, 'map_period': period} | claims


def _text(point: OperatingPoint, arrays: dict[str, np.ndarray]) -> str:
    without, with_friction = arrays['friction']
    lines = [
        f'{point.speed * 30 / math.pi:.0f} rpm, {point.load_torque:g} N m, '
        f'phi0 = {math.degrees(point.pair.transmission_error_phase):g} deg: '
        f'mu = {with_friction:g} against mu = {without:g}',
    ]
    lines += [_record_words(arrays, i) for i in range(2)]
    for name, unit in quantities().items():
        before, after = arrays[name]
        change = f'{after[0] / before[0] - 1:+.1%}' if before[0] > 0 else 'none without friction'
        first = f', first harmonic {after[1] / before[1] - 1:+.1%}' if before[1] > 0 else ''
        lines.append(f'  {name:18s} RMS {before[0]:.4g} -> {after[0]:.4g} {unit} ({change}){first}')
    if arrays['ax_lines'][1].any():
        leads = arrays['order'][arrays['ax_lines'][1].argmax()]
        lines.append(
            f"  of mesh harmonics 1 to {DRAWN} number {leads} leads the pinion's x acceleration"
        )
    if 'map' in arrays:
        lines += _claims_text(arrays)
    return '\n'.join(lines)


def _record_words(arrays: dict[str, np.ndarray], i: int) -> str:
    """Return in words of what record the figures of friction i are."""
    mu, period, cycles = (arrays[name][i] for name in ('friction', 'period', 'cycles'))
    if period:
        return f'mu = {mu:g}: {PERIOD}{period}; the figures are of {cycles} mesh cycles'
    return (
        f'mu = {mu:g}: no period: these figures show chance as well; they are of {cycles} mesh '
        'cycles'
    )


def regular_places(arrays: dict[str, np.ndarray]) -> np.ndarray:
    """Return where in the map both motions have a period, (phases, speeds)."""
    return np.all(arrays['map_period'] > 0, axis=0)


def _claims_text(arrays: dict[str, np.ndarray]) -> list[str]:
    regular = regular_places(arrays)
    lines = [
        f'over {arrays["map_phase"].size} phases and {arrays["map_speed"].size} speeds; of these '
        f'{regular.mean():.0%} where both motions have a period',
    ]
    for name, words in CLAIMS.items():
        where = arrays[f'map_{name}']
        telling = f', of those with a period {where[regular].mean():.0%}' if regular.any() else ''
        lines.append(f'  {words}: at {where.mean():.0%}{telling}')
    return lines


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return a row for each figure and friction: RMS and harmonics of all quantities."""
    figures = ['rms', *(f'harmonic_{i + 1}' for i in range(HARMONICS))]
    frictions = arrays['friction']
    columns = {
        'figure [-]': np.repeat(figures, len(frictions)),
        'friction_coefficient [1]': np.tile(frictions, len(figures)),
        'period [cycles]': np.tile(arrays['period'], len(figures)),
        'record [cycles]': np.tile(arrays['cycles'], len(figures)),
    }
    for name, unit in quantities().items():
        values = arrays[name]
        with np.errstate(divide='ignore', invalid='ignore'):
            change = np.where(values[0] > 0, values / values[0] - 1, math.nan)
        columns[f'{name} [{unit}]'] = values.T.ravel()
        columns[f'{name}_change [1]'] = change.T.ravel()
    return columns


def _map_table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the map: changes by friction of the RMS and the first harmonic, and the claims."""
    phase, speed = np.meshgrid(arrays['map_phase'], arrays['map_speed'], indexing='ij')
    rows = arrays['map']
    columns = {
        'transmission_error_phase [rad]': phase,
        'speed [rad/s]': speed,
        'period_without_friction [cycles]': arrays['map_period'][0],
        'period_with_friction [cycles]': arrays['map_period'][1],
    }
    for i, name in enumerate(QUANTITIES):
        unit = OTHER_UNITS.get(name, 'm/s2')
        columns[f'{name}_rms_rise [{unit}]'] = rows[1, ..., i, 0] - rows[0, ..., i, 0]
        columns[f'{name}_first_harmonic_rise [{unit}]'] = rows[1, ..., i, 1] - rows[0, ..., i, 1]
    columns |= {f'{name} [1]': arrays[f'map_{name}'].astype(int) for name in CLAIMS}
    return {name: column.ravel() for name, column in columns.items()}


CLAIMED = {
    'all_directions': 'claim 1: rises in all directions',
    'most_in_x': 'claim 2: rises most in x',
    'into_first': 'claim 3: into the first harmonic',
}
"""Maps of where the source's claims hold."""


def draw(arrays: Arrays) -> Figure:
    """Draw the lines of the pinion's acceleration above the maps over phase and speed."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    has_map = 'map' in arrays
    figure = new_figure(12, 11 if has_map else 4, 'What friction does to the vibration')
    parts = figure.subfigures(3 if has_map else 1, 1, squeeze=False)[:, 0]
    left, right = parts[0].subplots(1, 2)
    _lines(left, arrays, 'ay_lines', 'pinion, along the line of action (y)')
    _lines(right, arrays, 'ax_lines', 'pinion, across the line of action (x)')
    if has_map:
        left, right = parts[1].subplots(1, 2)
        _ratio(left, arrays, 'pinion_ay', 0, "RMS of the pinion's acceleration along y")
        _ratio(right, arrays, 'mesh_force', 1, 'first mesh harmonic of the mesh force')
        parts[2].suptitle(
            'Where the claims hold: shares of the places where both motions have a period',
            fontsize=10,
        )
        claims = parts[2].subplots(1, 3, sharey=True)
        for axes, name in zip(claims, CLAIMED, strict=True):
            _claim(axes, arrays, name)
        true, false = Patch(color=COLOURS[0], label='holds'), Patch(color=FAINT, label='does not')
        irregular = Line2D([], [], color=INK, marker='.', linestyle='none', label='no period')
        legend_below(claims[1], [true, false, irregular])
    return figure


def _lines(axes: Axes, arrays: Arrays, name: str, title: str) -> None:
    from matplotlib.ticker import MaxNLocator

    for i, mu in enumerate(arrays['friction']):
        orders = arrays['order'] + 0.3 * (i - 0.5)
        label = f'μ = {mu:g}' + ('' if arrays['period'][i] else ', no period')
        axes.bar(orders, arrays[name][i], 0.3, color=COLOURS[i], label=label)
    axes.set(xlabel='mesh harmonic', ylabel='amplitude [m/s²]', title=title)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend()


def _ratio(axes: Axes, arrays: Arrays, name: str, which: int, title: str) -> None:
    import matplotlib as mpl

    rows = arrays['map'][..., QUANTITIES.index(name), which]
    with np.errstate(divide='ignore', invalid='ignore'):
        change = 100 * (rows[1] / rows[0] - 1)
    limit = 20.0
    norm = mpl.colors.Normalize(-limit, limit)
    axes.pcolormesh(*_map_axes(arrays), change, cmap='RdBu_r', norm=norm)
    _label_map(axes, arrays, title)
    bar = axes.figure.colorbar(mpl.cm.ScalarMappable(norm, 'RdBu_r'), ax=axes, extend='both')
    bar.set_label('change by friction [%]')


def _claim(axes: Axes, arrays: Arrays, name: str) -> None:
    from matplotlib.colors import ListedColormap

    where = arrays[f'map_{name}']
    colours = ListedColormap([FAINT, COLOURS[0]])
    axes.pcolormesh(*_map_axes(arrays), where, cmap=colours, vmin=0, vmax=1)
    regular = regular_places(arrays)
    share = f'{where[regular].mean():.0%}' if regular.any() else 'none has one'
    _label_map(axes, arrays, f'{CLAIMED[name]}: {share}')


def _map_axes(arrays: Arrays) -> tuple[np.ndarray, np.ndarray]:
    return arrays['map_speed'] * 30 / np.pi, np.degrees(arrays['map_phase'])


def _label_map(axes: Axes, arrays: Arrays, title: str) -> None:
    """Label a map, and dot it where one of the two motions has no period."""
    irregular = ~regular_places(arrays)
    if irregular.any():
        speed, phase = np.meshgrid(*_map_axes(arrays))
        axes.plot(speed[irregular], phase[irregular], '.', color=INK, markersize=1.5)
    axes.set(xlabel='speed [rpm]', ylabel='φ0 [deg]', title=title)
    axes.grid(False)
