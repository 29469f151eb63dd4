"""The report of an analysis: one page of HTML that opens without the internet."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gear_dynamics.machine.channel import Channel
from gear_dynamics.monitoring.spans.analysis import SLOW
from gear_dynamics.monitoring.spans.findings import Finding
from gear_dynamics.monitoring.spans.summary import REACH, TABULATED
from gear_dynamics.recordings import report_figures as figures
from gear_dynamics.recordings.analyse import Analysis
from gear_dynamics.versions import versions

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #22303c; max-width: 62rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
h3 { font-size: 1rem; margin-bottom: .3rem; }
table { border-collapse: collapse; font-size: 13px; margin: .5rem 0; }
th, td { padding: .15rem .7rem; text-align: right; border-bottom: 1px solid #e4e9ed; }
th:first-child, td:first-child { text-align: left; }
img { max-width: 100%; display: block; margin: .6rem 0; }
li.alarm { font-weight: 600; color: #a82a42; }
.faint { color: #66757f; font-size: 13px; }
"""


def write_report(path: Path, analysis: Analysis, found: Sequence[Finding]) -> None:
    """Write the report."""
    machine = analysis.machine
    title = f'Analysis of {machine.name}'
    parts = [
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{_text(title)}</title>'
        f'<style>{STYLE}</style></head><body><h1>{_text(title)}</h1>',
        _about(analysis),
        '<h2>What was found</h2><ul>',
        *(
            f'<li class="{"alarm" if each.alarming else ""}">{_text(each.text)}</li>'
            for each in found
        ),
        '</ul>',
        *_reservations(analysis),
    ]
    for channel in machine.channels:
        if channel.name in analysis.summary.spectra:
            parts += _channel(analysis, channel)
    parts += _trend(analysis)
    parts += _indicators(analysis)
    parts.append(
        '<p class="faint">'
        + _text(', '.join(f'{name} {number}' for name, number in versions().items()))
        + '</p></body></html>'
    )
    path.write_text('\n'.join(parts), encoding='utf-8')


def _about(analysis: Analysis) -> str:
    rows = analysis.rows
    total = sum(row['duration'] for row in rows)
    files = ', '.join(analysis.files[:8]) + (', ...' if len(analysis.files) > 8 else '')
    return (
        f'<p>{len(rows)} span{"s" if len(rows) != 1 else ""}, {total:.4g} s in all, of '
        f'{len(analysis.files)} file{"s" if len(analysis.files) != 1 else ""}: {_text(files)}.</p>'
        + _table(
            ('channel', 'source', 'rate [Hz]', 'unit'),
            (
                (name, origin, f'{rate:.6g}', analysis.machine.channel(name).unit)
                for name, (origin, rate) in analysis.sources.items()
            ),
        )
    )


def _reservations(analysis: Analysis) -> Iterator[str]:
    lines = [f'{name} was not analysed: {why}' for name, why in analysis.failures.items()]
    lines += analysis.notes
    spans = len(analysis.rows)
    lines += [
        f'{note} (in {count} of {spans} spans)' for note, count in analysis.summary.notes.items()
    ][:40]
    if lines:
        yield '<h2>To be known when reading</h2><ul>'
        yield from (f'<li>{_text(line)}</li>' for line in lines)
        yield '</ul>'


def _channel(analysis: Analysis, channel: Channel) -> Iterator[str]:
    summary, name, unit = analysis.summary, channel.name, channel.unit
    yield f'<h2>Channel {_text(name)}</h2>'
    yield _img(figures.spectrum_image(summary.spectra[name], name, unit, summary))
    if unit in SLOW:
        return
    averages = {shaft: each for (its, shaft), each in summary.averages.items() if its == name}
    for shaft, average in averages.items():
        if any(wheel.shaft == shaft for wheel in analysis.machine.wheels):
            yield _img(figures.order_image(average, name, shaft, unit, analysis.machine))
            yield _img(figures.average_image(average, name, shaft, unit))
    yield from _sidebands(analysis, name, unit)
    if averages:
        yield '<h3>Share of the variance that is synchronous with a shaft</h3>'
        yield _table(
            ('shaft', 'share', 'revolutions'),
            ((s, f'{a.share:.1%}', str(a.revolutions)) for s, a in averages.items()),
        )
    for (its, bearing), record in summary.bearings.items():
        if its == name:
            yield _img(figures.envelope_image(record, name, bearing, unit))


def _sidebands(analysis: Analysis, channel: str, unit: str) -> Iterator[str]:
    for (its, mesh, wheel), table in analysis.summary.sidebands().items():
        if its != channel:
            continue
        yield (
            f'<h3>Mesh {_text(mesh)}: lines and sidebands by the shaft of {_text(wheel)}, peak '
            f'amplitude [{_text(unit)}], RMS of all spans</h3>'
        )
        head = ['mesh line', *(f'{k:+d}' if k else 'line' for k in range(-REACH, REACH + 1))]
        yield _table(
            head,
            (
                (str(number), *(_number(value) for value in row))
                for number, row in zip(range(1, TABULATED + 1), table, strict=True)
            ),
        )


def _trend(analysis: Analysis) -> Iterator[str]:
    rows = analysis.rows
    if len(rows) < 2:
        return
    yield '<h2>Trend</h2>'
    time = [row['t'] for row in rows]
    groups: dict[tuple[str, str], dict[str, list[float]]] = {}
    for column, unit in analysis.units.items():
        subject, _, kind = column.partition('/')
        if kind in ('std', 'kurtosis', 'velocity_rms', 'speed') or kind.endswith('_level'):
            title = 'bearing lines over their surroundings' if kind.endswith('_level') else kind
            values = [_float(row.get(column)) for row in rows]
            if not all(math.isnan(value) for value in values):
                label = column if kind.endswith('_level') else subject
                groups.setdefault((title, unit), {})[label] = values
    for (title, unit), columns in groups.items():
        yield _img(figures.trend_image(time, columns, unit or '1', title))


def _indicators(analysis: Analysis) -> Iterator[str]:
    yield '<h2>All indicators</h2>'
    yield (
        f'<p class="faint">Least, median and greatest of {len(analysis.rows)} spans; '
        'indicators.csv holds every span.</p>'
    )
    lines = []
    for column, unit in analysis.units.items():
        if '/' not in column:
            continue
        values = np.array([_float(row.get(column)) for row in analysis.rows])
        values = values[~np.isnan(values)]
        if len(values):
            numbers = (values.min(), float(np.median(values)), values.max())
            lines.append((column, *(_number(each) for each in numbers), unit))
    yield _table(('indicator', 'least', 'median', 'greatest', 'unit'), lines)


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    cells = ''.join(f'<th>{_text(each)}</th>' for each in head)
    body = ''.join(
        '<tr>' + ''.join(f'<td>{_text(cell)}</td>' for cell in row) + '</tr>' for row in rows
    )
    return f'<table><tr>{cells}</tr>{body}</table>'


def _img(address: str) -> str:
    return f'<img src="{address}" alt="">'


def _number(value: float) -> str:
    return '' if math.isnan(value) else f'{value:.4g}'


def _float(value: Any) -> float:
    return math.nan if value is None else float(value)


def _text(value: str) -> str:
    return html.escape(value)
