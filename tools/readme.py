"""Write into README.md what the code says: the parameter tables and the example.

Usage: python tools/readme.py
"""

from pathlib import Path

from gear_dynamics.parameters.files import NODES
from gear_dynamics.parameters.parameter import Parameter, Value

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / 'README.md'
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


def filled(text: str) -> str:
    """Return the README's text with what stands between the marks brought up to date."""
    for name, content in {'parameters': table(), 'example': example()}.items():
        begin, end = f'<!-- {name}: written by make readme -->', f'<!-- end of {name} -->'
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = f'{before}{begin}\n{content}\n{end}{after}'
    return text


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
    README.write_text(filled(README.read_text(encoding='utf-8')), encoding='utf-8')
