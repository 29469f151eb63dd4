"""What was found, in sentences, and how sure it is."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import DEFECTS, Bearing
from gear_dynamics.monitoring.spans.gears import FEWEST_REVOLUTIONS
from gear_dynamics.monitoring.spans.summary import BearingRecord, Summary
from gear_dynamics.monitoring.spans.unexplained import unexplained_lines

CLEAR_SHARE = 0.8
CLEAR_LEVEL = 15.0
"""Share of the spans, and median height [dB], from which on a named defect counts as clear."""

LOCAL_FM4 = 5.0
"""FM4 from which on a wheel is suspected of a local fault; noise has 3 (Stewart 1977)."""

OFFSET = 0.5
"""Mean over standard deviation from which on an offset is worth a sentence."""

_PARTS = {
    'outer': 'outer race',
    'inner': 'inner race',
    'element': 'rolling element',
    'cage': 'cage',
}

Row = Mapping[str, float]


@dataclasses.dataclass(frozen=True)
class Finding:
    """A sentence on what was found.

    Attributes
    ----------
    subject : str
        speed, bearing, gear, severity, quality or lines.
    alarming : bool
        Whether it tells of a fault.
    text : str
    """

    subject: str
    alarming: bool
    text: str


def findings(summary: Summary, rows: Sequence[Row]) -> list[Finding]:
    """Return what the spans of a recording show, faults first."""
    machine = summary.machine
    found = [
        *_bearing_findings(summary, rows),
        *_gear_findings(machine, rows),
        *_severity_findings(machine, rows),
        *_speed_findings(summary, rows),
        *_quality_findings(machine, rows),
        *_line_findings(summary),
    ]
    return sorted(found, key=lambda finding: not finding.alarming)


def _bearing_findings(summary: Summary, rows: Sequence[Row]) -> Iterator[Finding]:
    for bearing in summary.machine.bearings:
        for (channel, name), record in summary.bearings.items():
            if name == bearing.name:
                yield _bearing_finding(bearing, channel, record, rows)
        if not any(name == bearing.name for _, name in summary.bearings):
            yield Finding(
                'bearing',
                False,
                f'bearing {bearing.name} was not judged: that needs {FEWEST_REVOLUTIONS} '
                'revolutions in a span, and a sample rate of 8 times its highest order.',
            )


def _bearing_finding(
    bearing: Bearing, channel: str, record: BearingRecord, rows: Sequence[Row]
) -> Finding:
    count = len(record.named)
    where = f'bearing {bearing.name} on channel {channel}'
    best = max(DEFECTS, key=record.named.count)
    share = record.named.count(best) / count
    rivals = [each for each in DEFECTS if each != best and record.named.count(each) > 0.2 * count]
    if share > 0.5 and not rivals:
        prefix = f'{channel}/{bearing.name}_{best}'
        order, level = _median(rows, f'{prefix}_order'), _median(rows, f'{prefix}_level')
        clear = share >= CLEAR_SHARE and level >= CLEAR_LEVEL
        nominal = bearing.orders[best]
        low, high = record.shown.band
        return Finding(
            'bearing',
            True,
            f'{where}: {"clear" if clear else "probable"} signs of a fault of the {_PARTS[best]}. '
            f'Its line stands at order {order:.3f} of the shaft ({order / nominal - 1:+.1%} from '
            f'the kinematic {nominal:.3f}), the least of three harmonics {level:.1f} dB above its '
            f'surroundings, in {record.named.count(best)} of {count} spans (squared envelope of '
            f'{low:.0f} to {high:.0f} Hz).',
        )
    if record.named.count('undecided') > 0.2 * count or rivals:
        return Finding(
            'bearing',
            True,
            f'{where}: undecided. Lines of more than one defect stand out, and none wins clearly '
            f'({_counted(record.named)} of {count} spans).',
        )
    levels = {
        each: _median(rows, f'{channel}/{bearing.name}_{each}_level') for each in bearing.orders
    }
    known = {each: level for each, level in levels.items() if not math.isnan(level)}
    greatest = max(known, key=lambda each: known[each], default=next(iter(levels)))
    return Finding(
        'bearing',
        False,
        f'{where}: no fault stands out; the greatest is the {_PARTS[greatest]} with '
        f'{levels[greatest]:.1f} dB in the median of {count} spans.',
    )


def _counted(named: Sequence[str]) -> str:
    counts = {each: named.count(each) for each in dict.fromkeys(named) if each}
    return ', '.join(f'{each} in {count}' for each, count in counts.items())


def _gear_findings(machine: Machine, rows: Sequence[Row]) -> Iterator[Finding]:
    for channel in machine.channels:
        for wheel in machine.wheels:
            fm4 = _median(rows, f'{channel.name}/{wheel.name}_fm4')
            if math.isnan(fm4):
                continue
            where = f'wheel {wheel.name} on channel {channel.name}'
            if fm4 >= LOCAL_FM4:
                yield Finding(
                    'gear',
                    True,
                    f'{where}: signs of a local fault of a tooth. FM4 of the average revolution '
                    f'is {fm4:.2f} in the median of the spans, noise has 3.',
                )
            else:
                yield Finding(
                    'gear',
                    False,
                    f'{where}: no local tooth fault stands out (FM4 {fm4:.2f} in the median of '
                    'the spans, noise has 3).',
                )


def _severity_findings(machine: Machine, rows: Sequence[Row]) -> Iterator[Finding]:
    if machine.severity is None:
        return
    for channel in machine.channels:
        worst = _greatest(rows, f'{channel.name}/velocity_rms')
        if not math.isnan(worst):
            zone = machine.severity.zone(worst)
            yield Finding(
                'severity',
                zone in 'CD',
                f'channel {channel.name}: zone {zone}. Its greatest velocity RMS from 10 to '
                f'1000 Hz is {worst * 1e3:.2f} mm/s in a span (limits of the '
                f'{machine.severity.origin}).',
            )


def _speed_findings(summary: Summary, rows: Sequence[Row]) -> Iterator[Finding]:
    sources = {
        'tacho': 'from its tacho',
        'angle': 'from its angle',
        'speed': 'from its recorded speed',
        'fixed': 'as stated: synchronous results rest on this fixed speed',
        'tracked': 'tracked from a line of the vibration',
    }
    for shaft in summary.machine.shafts:
        speeds = summary.speeds.get(shaft.name)
        if not speeds:
            yield Finding('speed', False, f'shaft {shaft.name}: its speed is unknown.')
            continue
        rpm = 60 * np.asarray(speeds)
        text = (
            f'shaft {shaft.name}: {rpm.mean():.5g} rpm on average over the spans, '
            f'{rpm.min():.5g} to {rpm.max():.5g}, {sources[summary.origins[shaft.name]]}'
        )
        uncertain = _median(rows, f'{shaft.name}/speed_uncertainty')
        if not math.isnan(uncertain):
            text += f', uncertain by {uncertain * 30 / math.pi:.2g} rpm in a span'
        limit = np.mean([bool(row.get(f'{shaft.name}/at_limit')) for row in rows])
        if limit > 0:
            text += f'; in {limit:.0%} of the spans at a limit of its range: widen it'
        yield Finding('speed', False, text + '.')


def _quality_findings(machine: Machine, rows: Sequence[Row]) -> Iterator[Finding]:
    for channel in machine.channels:
        name = channel.name
        mean, std = _median(rows, f'{name}/mean'), _median(rows, f'{name}/std')
        if std == 0:
            words = 'all zeros' if mean == 0 else f'constant at {mean:g} {channel.unit}'
            yield Finding('quality', False, f'channel {name} is {words}.')
        elif abs(mean) > OFFSET * std:
            yield Finding(
                'quality',
                False,
                f'channel {name} has an offset of {mean:.4g} {channel.unit} in the median of the '
                'spans; shape indicators are about the mean.',
            )
        clipped = _greatest(rows, f'{name}/clipped')
        if clipped > 0:
            yield Finding(
                'quality',
                False,
                f'channel {name} is clipped: up to {clipped:.2%} of the samples of a span. Peak, '
                'crest factor and kurtosis are too low there.',
            )
        if channel.unit == 'unknown':
            yield Finding(
                'quality',
                False,
                f'channel {name} has no unit: its values are as recorded, and no velocity or '
                'severity follows.',
            )


def _line_findings(summary: Summary) -> Iterator[Finding]:
    for channel in summary.machine.channels:
        lines = unexplained_lines(summary, channel.name)
        if lines:
            listed = ', '.join(f'{line.frequency:.2f} Hz ({line.height:.0f} dB)' for line in lines)
            yield Finding(
                'lines',
                False,
                f'channel {channel.name}: lines that no shaft, mesh or bearing explains, with '
                f'their height over the surroundings, mean of all spans: {listed}.',
            )


def _values(rows: Sequence[Row], column: str) -> np.ndarray:
    values = np.array([row.get(column, math.nan) for row in rows], dtype=float)
    return values[~np.isnan(values)]


def _median(rows: Sequence[Row], column: str) -> float:
    values = _values(rows, column)
    return float(np.median(values)) if len(values) else math.nan


def _greatest(rows: Sequence[Row], column: str) -> float:
    values = _values(rows, column)
    return float(values.max()) if len(values) else math.nan
