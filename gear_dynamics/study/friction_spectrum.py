"""What friction does to the spectrum: RMS and mesh harmonics, and where over phase and speed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gear_dynamics.analysis.regime import recurrence_period
from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.judgement import unzip
from gear_dynamics.study.kind import LONGEST_PERIOD, RECURS
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner, chunks

HARMONICS = 5

ACCELERATIONS = ('pinion_ax', 'pinion_ay', 'gear_ax', 'gear_ay')
QUANTITIES = (*ACCELERATIONS, 'delta', 'mesh_force', 'friction_force')

RELATIVE = {'psi': 'm', 'psi_acceleration': 'm/s2', 'delta_acceleration': 'm/s2'}
"""What the table of the full form has of the wheels' rotation and their approach beside delta."""

OTHER_UNITS = {'delta': 'm', 'mesh_force': 'N', 'friction_force': 'N'}

CLAIMS = {
    'all_directions': 'vibration rises in all directions: x and y of both wheels',
    'y1_rises': '  y of the pinion',
    'y2_rises': '  y of the gear',
    'most_in_x': 'it rises most in x: by more than in y, on both wheels',
    'most_in_x1': '  on the pinion',
    'most_in_x2': '  on the gear',
    'into_first': 'the energy goes into the first mesh harmonic: all of the following',
    'first_rises': '  of the mesh force the first harmonic rises',
    'first_rises_most': '  and rises by more than harmonics 2 to 5',
    'first_leads_x1': '  of x of the pinion the first harmonic is the highest of 1 to 5',
    'first_leads_x2': '  of x of the gear the first harmonic is the highest of 1 to 5',
    'all_claims': 'all three',
}
"""The source's claims and their parts, each by itself."""

UNITS = {
    'friction': '1',
    'order': '1',
    'ax_lines': 'm/s2',
    'ay_lines': 'm/s2',
    'map': 'm/s2; delta m; forces N',
    'map_phase': 'rad',
    'map_speed': 'rad/s',
    'map_period': 'cycles',
    **{f'map_{name}': '1' for name in CLAIMS},
}

RECORD = 32
"""Mesh cycles in a record."""

TABLE_SAMPLES, MAP_SAMPLES = 8192, 256
"""Samples in a mesh cycle; the forces jump, so that what folds back falls as one over this."""

RECURS_IN = 128
"""Mesh cycles, the last of which are the record, in which a motion of the map is seen to recur."""

DRIVE_SETTLES = 5000
"""Mesh cycles before the record of the full form, in which the drive takes up the mean loss."""

AT_ONCE = 60


def quantity_rows(samples: np.ndarray, cycle_time: float) -> dict[str, np.ndarray]:
    """Return RMS about the mean and peak amplitudes of harmonics 1 to HARMONICS, by quantity.

    Displacements are the accelerations over the square of each line's frequency, as holds for a
    motion that repeats within the record.

    Parameters
    ----------
    samples : (n,) array of SAMPLES
        Over RECORD whole mesh cycles.
    cycle_time : float
        Length of a mesh cycle [s].
    """
    rows = {}
    turn = _frequencies(len(samples), cycle_time)
    for name in QUANTITIES:
        lines = _amplitudes(samples[name])
        rows[name] = _row(lines)
        if name in ACCELERATIONS:
            divided = np.zeros_like(lines)
            divided[1:] = lines[1:] / turn[1:] ** 2
            rows[name.replace('_a', '_')] = _row(divided)
    return rows


def relative_rows(samples: np.ndarray, pair: GearPair, cycle_time: float) -> dict[str, np.ndarray]:
    """Return rows as `quantity_rows` does, of psi = rb1 th1 - rb2 th2 and by the names of RELATIVE.

    Accelerations come from the lines of psi and of delta_dot: no sample has them.
    """
    turn = _frequencies(len(samples), cycle_time)
    psi = pair.derived.pinion_base_radius * np.unwrap(samples['pinion_angle'])
    psi -= pair.derived.gear_base_radius * np.unwrap(samples['gear_angle'])
    lines = _amplitudes(psi)
    return {
        'psi': _row(lines),
        'psi_acceleration': _row(lines * turn**2),
        'delta_acceleration': _row(_amplitudes(samples['delta_dot']) * turn),
    }


def _amplitudes(values: np.ndarray) -> np.ndarray:
    return 2 * np.abs(np.fft.rfft(values)) / len(values)


def _frequencies(count: int, cycle_time: float) -> np.ndarray:
    """Return the angular frequencies of the lines of a record of `count` samples [rad/s]."""
    return 2 * math.pi / (RECORD * cycle_time) * np.arange(count // 2 + 1)


def _row(lines: np.ndarray) -> np.ndarray:
    harmonics = lines[RECORD : (HARMONICS + 1) * RECORD : RECORD]
    return np.array([math.sqrt(float((lines[1:] ** 2).sum()) / 2), *harmonics])


def table_task(operation: Operation) -> Arrays:
    """Return all rows of the full form, once the drive has settled."""
    pairs = [operation.pair]
    run = (pairs, operation.speed, operation.load_torque)
    before = run_cycles(*run, DRIVE_SETTLES, drive=True)
    after = run_cycles(
        *run, RECORD, states=before.states, drive=True, samples_per_cycle=TABLE_SAMPLES
    )
    samples, cycle_time = after.samples[0], float(after.period[0])
    rows = quantity_rows(samples, cycle_time) | relative_rows(samples, operation.pair, cycle_time)
    lines, y_lines = _amplitudes(samples['pinion_ax']), _amplitudes(samples['pinion_ay'])
    orders = np.arange(len(lines)) / RECORD
    shown = orders <= 20
    return rows | {'order': orders[shown], 'ax_lines': lines[shown], 'ay_lines': y_lines[shown]}


def map_task(operations: list[Operation], transient: int) -> Arrays:
    """Return rows of QUANTITIES of motions of the reduced form, (n, quantities, 6), and periods.

    The period is 0 for a motion without one: what its record shows is partly chance.
    """
    pairs, speeds, torques = unzip(operations)
    states = np.concatenate([scattered_states(each, 1) for each in operations])
    before = run_cycles(pairs, speeds, torques, transient, states=states)
    after = run_cycles(
        pairs, speeds, torques, RECORD, states=before.states, samples_per_cycle=MAP_SAMPLES
    )
    rows = [
        quantity_rows(samples, float(period))
        for samples, period in zip(after.samples, after.period, strict=True)
    ]
    sections = np.concatenate([before.sections, after.sections], axis=1)[:, -RECURS_IN:]
    periods = [
        recurrence_period(each.scaled(section), RECURS, LONGEST_PERIOD)[0]
        for each, section in zip(operations, sections, strict=True)
    ]
    return {
        'rows': np.array([[row[name] for name in QUANTITIES] for row in rows]),
        'period': np.array(periods),
    }


def spectrum(
    operation: Operation,
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
    operation : Operation
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
        If a value is out of its range.
    """
    runner = runner or Runner()
    rubbing = [operation.with_value('friction_coefficient', mu) for mu in frictions]
    results = runner.run(table_task, [{'operation': each} for each in rubbing], 'spectra')
    arrays = {name: np.array([result[name] for result in results]) for name in results[0]} | {
        'friction': np.array(frictions)
    }
    further = {}
    if phases and speeds:
        grid = np.linspace(slowest, fastest, speeds)
        arrays |= _map(rubbing, phases, grid, transient, runner)
        further = {'_map': _map_table(arrays)}
    units = dict(_quantities()) | UNITS
    return Outcome('spectrum', _text(operation, arrays), _table(arrays), arrays, units, further)


def _map(
    rubbing: Sequence[Operation], phases: int, speeds: np.ndarray, transient: int, runner: Runner
) -> dict[str, np.ndarray]:
    angles = np.linspace(-math.pi, math.pi, phases, endpoint=False)
    operations = [
        each.with_value('transmission_error_phase', float(angle)).with_value('speed', float(speed))
        for each in rubbing
        for angle in angles
        for speed in speeds
    ]
    arguments = [
        {'operations': operations[part], 'transient': max(transient, RECURS_IN - RECORD)}
        for part in chunks(len(operations), AT_ONCE)
    ]
    results = runner.run(map_task, arguments, 'map')
    rows = np.concatenate([result['rows'] for result in results])
    rows = rows.reshape(len(rubbing), phases, len(speeds), len(QUANTITIES), HARMONICS + 1)
    period = np.concatenate([result['period'] for result in results])
    period = period.reshape(len(rubbing), phases, len(speeds))
    found = {'map': rows, 'map_phase': angles, 'map_speed': speeds, 'map_period': period}
    return found | {f'map_{name}': where for name, where in holds(rows).items()}


def holds(rows: np.ndarray) -> dict[str, np.ndarray]:
    """Return where each claim of the source holds, by the names of CLAIMS, from a map's rows.

    Vibration is the RMS of an acceleration. x vibrates by friction alone, so that it always rises,
    and by all that it is.

    Parameters
    ----------
    rows : (2, ..., quantities, 6) array
        Without and with friction.
    """
    at = {name: i for i, name in enumerate(QUANTITIES)}
    rise = {name: rows[1, ..., at[name], :] - rows[0, ..., at[name], :] for name in QUANTITIES}
    rms = {name: rise[name][..., 0] for name in ACCELERATIONS}
    force = rise['mesh_force'][..., 1:]
    found = {
        'y1_rises': rms['pinion_ay'] > 0,
        'y2_rises': rms['gear_ay'] > 0,
        'most_in_x1': rms['pinion_ax'] > rms['pinion_ay'],
        'most_in_x2': rms['gear_ax'] > rms['gear_ay'],
        'first_rises': force[..., 0] > 0,
        'first_rises_most': (force[..., 0] > 0) & (force.argmax(axis=-1) == 0),
        'first_leads_x1': rows[1, ..., at['pinion_ax'], 1:].argmax(axis=-1) == 0,
        'first_leads_x2': rows[1, ..., at['gear_ax'], 1:].argmax(axis=-1) == 0,
    }
    found['all_directions'] = found['y1_rises'] & found['y2_rises']
    found['most_in_x'] = found['most_in_x1'] & found['most_in_x2']
    found['into_first'] = (
        found['first_rises_most'] & found['first_leads_x1'] & found['first_leads_x2']
    )
    found['all_claims'] = found['all_directions'] & found['most_in_x'] & found['into_first']
    return {name: found[name] for name in CLAIMS}


def _text(operation: Operation, arrays: dict[str, np.ndarray]) -> str:
    without, with_friction = arrays['friction']
    lines = [
        f'{operation.speed * 30 / math.pi:.0f} rpm, {operation.load_torque:g} N m, '
        f'phi0 = {math.degrees(operation.pair.transmission_error_phase):g} deg: '
        f'mu = {with_friction:g} against mu = {without:g}',
    ]
    for name, unit in _quantities():
        before, after = arrays[name]
        change = f'{after[0] / before[0] - 1:+.1%}' if before[0] > 0 else 'none without friction'
        first = f', first harmonic {after[1] / before[1] - 1:+.1%}' if before[1] > 0 else ''
        lines.append(f'  {name:18s} RMS {before[0]:.4g} -> {after[0]:.4g} {unit} ({change}){first}')
    if arrays['ax_lines'][1].any():
        leads = arrays['order'][1, int(arrays['ax_lines'][1][1:].argmax()) + 1]
        lines.append(f"  the pinion's x acceleration is led by mesh harmonic {leads:g}")
    if 'map' in arrays:
        lines += _claims_text(arrays)
    return '\n'.join(lines)


def _claims_text(arrays: dict[str, np.ndarray]) -> list[str]:
    regular = (arrays['map_period'] > 0).all(axis=0)
    return [
        f'over {arrays["map_phase"].size} phases and {arrays["map_speed"].size} speeds; of these '
        f'{regular.mean():.0%} where both motions have a period',
        *(
            f'  {words}: at {arrays[f"map_{name}"].mean():.0%}, of those with a period '
            f'{arrays[f"map_{name}"][regular].mean():.0%}'
            for name, words in CLAIMS.items()
        ),
    ]


def _quantities() -> list[tuple[str, str]]:
    found = []
    for name in QUANTITIES:
        found.append((name, OTHER_UNITS.get(name, 'm/s2')))
        if name in ACCELERATIONS:
            found.append((name.replace('_a', '_'), 'm'))
    return [*found, *RELATIVE.items()]


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return a row for each figure and friction: RMS and harmonics of all quantities."""
    figures = ['rms', *(f'harmonic_{i + 1}' for i in range(HARMONICS))]
    frictions = arrays['friction']
    columns = {
        'figure [-]': np.repeat(figures, len(frictions)),
        'friction_coefficient [1]': np.tile(frictions, len(figures)),
    }
    for name, unit in _quantities():
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
