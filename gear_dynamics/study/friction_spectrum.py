"""What friction does to the spectrum: RMS and mesh harmonics, and where over phase and speed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.operation import Operation
from gear_dynamics.study.orbit_diagram import unzip
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner, chunks

HARMONICS = 5

ACCELERATIONS = ('pinion_ax', 'pinion_ay', 'gear_ax', 'gear_ay')
QUANTITIES = (*ACCELERATIONS, 'delta', 'mesh_force', 'friction_force')

UNITS = {'delta': 'm', 'mesh_force': 'N', 'friction_force': 'N'}

RECORD = 32
"""Mesh cycles in a record."""

TABLE_SAMPLES, MAP_SAMPLES = 8192, 256
"""Samples in a mesh cycle; the forces jump, so that what folds back falls as one over this."""

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
    rate = 2 * math.pi / (RECORD * cycle_time)
    for name in QUANTITIES:
        lines = 2 * np.abs(np.fft.rfft(samples[name])) / len(samples)
        rows[name] = _row(lines)
        if name in ACCELERATIONS:
            divided = np.zeros_like(lines)
            divided[1:] = lines[1:] / (rate * np.arange(1, len(lines))) ** 2
            rows[name.replace('_a', '_')] = _row(divided)
    return rows


def _row(lines: np.ndarray) -> np.ndarray:
    harmonics = lines[RECORD : (HARMONICS + 1) * RECORD : RECORD]
    return np.array([math.sqrt(float((lines[1:] ** 2).sum()) / 2), *harmonics])


def table_task(operation: Operation) -> Arrays:
    """Return `quantity_rows` of the full form, once the drive has settled."""
    pairs = [operation.pair]
    run = (pairs, operation.speed, operation.load_torque)
    before = run_cycles(*run, DRIVE_SETTLES, drive=True)
    after = run_cycles(
        *run, RECORD, states=before.states, drive=True, samples_per_cycle=TABLE_SAMPLES
    )
    rows = quantity_rows(after.samples[0], float(after.period[0]))
    lines = 2 * np.abs(np.fft.rfft(after.samples[0]['pinion_ax'])) / after.samples.shape[1]
    y_lines = 2 * np.abs(np.fft.rfft(after.samples[0]['pinion_ay'])) / after.samples.shape[1]
    orders = np.arange(len(lines)) / RECORD
    shown = orders <= 20
    return rows | {'order': orders[shown], 'ax_lines': lines[shown], 'ay_lines': y_lines[shown]}


def map_task(operations: list[Operation], transient: int) -> Arrays:
    """Return rows of QUANTITIES for each motion of the reduced form, (n, quantities, 6)."""
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
    return {'rows': np.array([[row[name] for name in QUANTITIES] for row in rows])}


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
    if phases and speeds:
        arrays |= _map(rubbing, phases, np.linspace(slowest, fastest, speeds), transient, runner)
    return Outcome('spectrum', _text(operation, arrays), _table(arrays), arrays)


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
        {'operations': operations[part], 'transient': transient}
        for part in chunks(len(operations), AT_ONCE)
    ]
    results = runner.run(map_task, arguments, 'map')
    rows = np.concatenate([result['rows'] for result in results])
    rows = rows.reshape(len(rubbing), phases, len(speeds), len(QUANTITIES), HARMONICS + 1)
    return {'map': rows, 'map_phase': angles, 'map_speed': speeds}


def holds(rows: np.ndarray) -> dict[str, np.ndarray]:
    """Return where each part of the source's finding holds, from the rows of a map.

    Parameters
    ----------
    rows : (2, ..., quantities, 6) array
        Without and with friction.
    """
    at = {name: i for i, name in enumerate(QUANTITIES)}
    rms, first = rows[..., 0], rows[..., 1]
    return {
        'y vibration of the pinion rises': rms[1, ..., at['pinion_ay']]
        > rms[0, ..., at['pinion_ay']],
        'y vibration of the gear rises': rms[1, ..., at['gear_ay']] > rms[0, ..., at['gear_ay']],
        'first mesh harmonic of the mesh force rises': first[1, ..., at['mesh_force']]
        > first[0, ..., at['mesh_force']],
        'first harmonic leads in x': rows[1, ..., at['pinion_ax'], 1:].argmax(axis=-1) == 0,
    }


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
        lines.append(f'  {name:15s} RMS {before[0]:.4g} -> {after[0]:.4g} {unit} ({change}){first}')
    leads = arrays['order'][1, int(arrays['ax_lines'][1][1:].argmax()) + 1]
    lines.append(f"  the pinion's x acceleration is led by mesh harmonic {leads:g}")
    if 'map' in arrays:
        phases, speeds = arrays['map_phase'].size, arrays['map_speed'].size
        lines.append(f'over {phases} phases and {speeds} speeds')
        for words, where in holds(arrays['map']).items():
            lines.append(f'  {words}: at {where.mean():.0%}')
    return '\n'.join(lines)


def _quantities() -> list[tuple[str, str]]:
    found = []
    for name in QUANTITIES:
        found.append((name, UNITS.get(name, 'm/s2')))
        if name in ACCELERATIONS:
            found.append((name.replace('_a', '_'), 'm'))
    return found


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    columns: dict[str, list] = {'quantity': [], 'unit': [], 'friction_coefficient [1]': []}
    figures = ['rms', *(f'harmonic_{i + 1}' for i in range(HARMONICS))]
    columns |= {f'{name} [unit]': [] for name in figures}
    columns |= {f'{name}_change [1]': [] for name in figures}
    for name, unit in _quantities():
        for mu, row in zip(arrays['friction'], arrays[name], strict=True):
            columns['quantity'].append(name)
            columns['unit'].append(unit)
            columns['friction_coefficient [1]'].append(mu)
            for figure, value, first in zip(figures, row, arrays[name][0], strict=True):
                columns[f'{figure} [unit]'].append(value)
                change = value / first - 1 if first > 0 else math.nan
                columns[f'{figure}_change [1]'].append(change)
    return {name: np.array(column) for name, column in columns.items()}
