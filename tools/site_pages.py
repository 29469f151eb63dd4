"""Hooks of MkDocs: pages that docs/ does not hold, and links that leave docs/.

README.md becomes the first page; the pages of the Python API are written from what the package
exports; a file of the repository that a page links to is copied into the site.
"""

import importlib
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

PAGES = {'README.md': 'index.md', 'CONTRIBUTING.md': 'CONTRIBUTING.md'}
"""Pages of the repository's root by their name in the site."""

ROOMS = ('faults', 'signal', 'dynamics', 'study')

LINK = re.compile(r'\]\(([\w./-]+)((?:#[\w-]+)?)\)')


def on_files(files: Any, config: Any) -> Any:
    """Add the pages and the linked files that lie outside docs/."""
    from mkdocs.structure.files import File

    for name, page in PAGES.items():
        text = (ROOT / name).read_text(encoding='utf-8')
        files.append(File.generated(config, page, content=text))
    for room, text in api_pages().items():
        files.append(File.generated(config, f'api/{room}.md', content=text))
    for path in sorted(linked()):
        files.append(File(path, str(ROOT), config.site_dir, config.use_directory_urls))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Let links point to where their targets lie in the site."""
    above = 'docs/' if page.file.src_uri not in PAGES.values() else ''

    def moved(match: re.Match[str]) -> str:
        return f']({_in_site(_in_repository(above + match[1]))}{match[2]})'

    return markdown if page.file.src_uri.startswith('api/') else LINK.sub(moved, markdown)


def linked() -> set[str]:
    """Return the files outside docs/ that pages link to, other than pages."""
    targets = set()
    for page in [*(ROOT / name for name in PAGES), *(ROOT / 'docs').glob('*.md')]:
        folder = '' if page.parent == ROOT else 'docs/'
        for target, _ in LINK.findall(page.read_text(encoding='utf-8')):
            targets.add(_in_repository(folder + target))
    outside = {path for path in targets if not path.startswith('docs/') and path not in PAGES}
    return {path for path in outside if (ROOT / path).is_file()}


def api_pages() -> dict[str, str]:
    """Return the pages of the Python API in Markdown, one for each public module."""
    package = importlib.import_module('gear_dynamics')
    places = [f'{home}.{name}' for name, home in package._MODULES.items()]
    names = sorted(place for place in places if not place.endswith('__'))
    pages = {'gear_dynamics': _page('gear_dynamics', 'import gear_dynamics as gd', names)}
    for room in ROOMS:
        module = importlib.import_module('gear_dynamics.' + package._PACKAGES[room])
        exported = [getattr(module, name) for name in module.__all__]
        found = [
            f'{each.__module__.removeprefix("gear_dynamics.")}.{each.__qualname__}'
            for each in exported
            if hasattr(each, '__qualname__')
        ]
        head = f'from gear_dynamics import {room}'
        pages[room] = _page(f'gear_dynamics.{room}', head, sorted(found))
    return pages


def _page(title: str, head: str, names: Iterable[str]) -> str:
    parts = [f'# {title}', f'    {head}', *(f'::: gear_dynamics.{name}' for name in names)]
    return '\n\n'.join(parts) + '\n'


def _in_repository(path: str) -> str:
    """Return a path without `..`."""
    parts: list[str] = []
    for part in path.split('/'):
        if part == '..' and parts:
            parts.pop()
        elif part not in ('', '.'):
            parts.append(part)
    return '/'.join(parts)


def _in_site(path: str) -> str:
    return PAGES.get(path, path.removeprefix('docs/'))
