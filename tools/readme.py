"""Write into README.md and docs/interfaces.md what the code says: parameters, topics, example.

Usage: python tools/readme.py
"""

from pathlib import Path

from gear_dynamics.__main__ import EXECUTABLES
from gear_dynamics.monitoring.catalogue import markdown as indicator_table
from gear_dynamics.parameters.files import NODES
from gear_dynamics.parameters.parameter import Parameter, Value
from gear_dynamics.wire.topics import (
    EVENTS_TOPIC,
    ORDER_SPECTRUM,
    POINCARE,
    SAMPLES,
    SPECTRUM,
    TOPICS,
    Topic,
)

ROOT = Path(__file__).resolve().parents[1]
FILES = (ROOT / 'README.md', ROOT / 'docs' / 'interfaces.md', ROOT / 'docs' / 'analysis.md')
HEAD = ['| name | default | range | unit | live | what it is |', '|---|---|---|---|---|---|']


def table() -> str:
    """Return the parameters of all nodes in Markdown, one table for each list."""
    lists = dict.fromkeys(each for lists in NODES.values() for each in lists)
    parts = []
    for each in lists:
        nodes = ' and '.join(f'`{node}`' for node in NODES if each in NODES[node])
        what = (each.__doc__ or '').partition('\n')[0]
        rows = [_row(about) for about in each.parameters()]
        parts.append('\n'.join([f'**{nodes}**: {what}', '', *HEAD, *rows]))
    return '\n\n'.join(parts)


def example() -> str:
    """Return the example of a listener as Markdown."""
    return f'```python\n{(ROOT / "examples" / "listen.py").read_text(encoding="utf-8")}```'


def executables() -> str:
    """Return a line for each executable."""
    rows = [f'| `{name}` | {about} |' for name, (_, about) in EXECUTABLES.items()]
    return '\n'.join(['| name | what it does |', '|---|---|', *rows])


def overview() -> str:
    """Return a line for each topic."""
    rows = [f'| `{each.name}` | {_short(each.type_name)} | {each.about} |' for each in TOPICS]
    return '\n'.join(['| topic | type | what |', '|---|---|---|', *rows])


def topics(publisher: str) -> str:
    """Return what a node publishes; '' stands for topics that several programs publish."""
    rows = [
        f'| `{each.name}` | {_short(each.type_name)} | {each.qos.words()} | {each.rate} '
        f'| {"yes" if each.logged else ""} | {each.about} |'
        for each in TOPICS
        if each.publisher == publisher
    ]
    head = ['| topic | type | QoS | rate | logged | what |', '|---|---|---|---|---|---|']
    return '\n'.join([*head, *rows])


def columns(topic: Topic) -> str:
    """Return the columns of a table."""
    rows = [
        f'| `{each.name}` | {each.type} | {each.unit} | {each.about} |' for each in topic.columns
    ]
    return '\n'.join(['| column | type | unit | what |', '|---|---|---|---|', *rows])


PARTS = {
    'parameters': table,
    'example': example,
    'executables': executables,
    'topics': overview,
    'topics of gear_sim': lambda: topics('gear_sim'),
    'topics of gear_analyzer': lambda: topics('gear_analyzer'),
    'topics of several': lambda: topics(''),
    'columns of samples': lambda: columns(SAMPLES),
    'columns of events': lambda: columns(EVENTS_TOPIC),
    'columns of spectrum': lambda: columns(SPECTRUM),
    'columns of order_spectrum': lambda: columns(ORDER_SPECTRUM),
    'columns of poincare': lambda: columns(POINCARE),
    'indicators': indicator_table,
}
"""What can stand between the marks of a file, by name."""


def filled(text: str) -> str:
    """Return a text with what stands between its marks brought up to date."""
    for name, content in PARTS.items():
        begin, end = f'<!-- {name}: written by make readme -->', f'<!-- end of {name} -->'
        if begin in text:
            before, _, rest = text.partition(begin)
            _, _, after = rest.partition(end)
            text = f'{before}{begin}\n{content()}\n{end}{after}'
    return text


def _short(type_name: str) -> str:
    return type_name.replace('/msg/', '/')


def _row(about: Parameter) -> str:
    live = 'yes' if about.live else ''
    cells = (f'`{about.name}`', _text(about.default), _range(about), about.unit, live)
    return f'| {" | ".join(cells)} | {about.description} |'


def _range(about: Parameter) -> str:
    if about.choices:
        return ', '.join(f'`{choice}`' for choice in about.choices)
    if about.minimum is None or about.maximum is None:
        return ''
    return f'{_text(about.minimum)} to {_text(about.maximum)}'


def _text(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float) and abs(value) < 1e7 and float(value).is_integer():
        return f'{value:.0f}'
    if isinstance(value, int | float):
        return f'{value:.6g}'.replace('e+0', 'e').replace('e+', 'e').replace('e-0', 'e-')
    return f'`{value}`' if value else ''


if __name__ == '__main__':
    for file in FILES:
        file.write_text(filled(file.read_text(encoding='utf-8')), encoding='utf-8')
