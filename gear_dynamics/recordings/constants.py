"""Numbers in a recording that contradict the machine file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.shaft import FixedSpeed
from gear_dynamics.monitoring.spans.summary import Summary
from gear_dynamics.recordings.table import RecordingTable, plain

_DEFECT_NAMES = {
    **dict.fromkeys(('bpfo', 'ballpassfrequencyouter'), 'outer'),
    **dict.fromkeys(('bpfi', 'ballpassfrequencyinner'), 'inner'),
    **dict.fromkeys(('bsf', 'ballspinfrequency'), 'element'),
    **dict.fromkeys(('ftf', 'fundamentaltrainfrequency', 'cagefrequency'), 'cage'),
}

TOLERANCE = 0.03


def contradictions(tables: Sequence[RecordingTable], summary: Summary) -> Iterator[str]:
    """Yield a sentence for each constant of the files that the machine file contradicts.

    Known are the defect frequencies of a bearing by their usual names (BPFO, BPFI, BSF, FTF) and
    speeds with rpm in their name. Constants of other names say nothing that could be compared.
    """
    machine = summary.machine
    for table in tables:
        for name, value in table.constants.items():
            short = plain(name.rpartition('.')[2])
            if short in _DEFECT_NAMES:
                yield from _defect(table, name, value, _DEFECT_NAMES[short], summary)
            elif 'rpm' in short:
                yield from _speed(table, name, value, machine)


def _defect(
    table: RecordingTable, name: str, value: float, defect: str, summary: Summary
) -> Iterator[str]:
    expected = {}
    for bearing in summary.machine.bearings:
        speed = summary.mean_speed(bearing.shaft)
        if defect in bearing.orders and not math.isnan(speed):
            expected[bearing.name] = bearing.orders[defect] * speed
    # The spin of an element is half of the frequency at which it meets the races.
    factors = (1.0, 0.5) if defect == 'element' else (1.0,)
    near = [
        abs(value / (factor * line) - 1) <= TOLERANCE
        for line in expected.values()
        for factor in factors
    ]
    if expected and not any(near):
        lines = ', '.join(f'{line:.4g} Hz for {bearing}' for bearing, line in expected.items())
        yield (
            f'{name} of {table.name} is {value:g} Hz, which contradicts the machine file: its '
            f'{defect} order gives {lines}'
        )


def _speed(table: RecordingTable, name: str, value: float, machine: Machine) -> Iterator[str]:
    fixed = {
        shaft.name: shaft.speed.speed * 30 / math.pi
        for shaft in machine.shafts
        if isinstance(shaft.speed, FixedSpeed)
    }
    if fixed and not any(abs(value / rpm - 1) <= 0.002 for rpm in fixed.values()):
        speeds = ', '.join(f'{rpm:g} rpm for {shaft}' for shaft, rpm in fixed.items())
        yield f'{name} of {table.name} is {value:g}, and the machine file states {speeds}'
