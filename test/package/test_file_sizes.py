"""A file has one subject: none is longer than CONTRIBUTING.md says."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = 'gear_dynamics test tools benchmarks demo docs examples launch config'.split()
WRITTEN = ('.py', '.md', '.yaml', '.js', '.css', '.html')
LONGEST = 400
WRITTEN_BY_TOOL = re.compile(r'<!-- (\w+): written by make readme -->.*?<!-- end of \1 -->', re.S)


def test_no_file_is_longer_than_the_rule_says():
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob('*')] + [*ROOT.glob('*')]
    # What `make readme` writes does not count: it has a row for each parameter and topic.
    lengths = {
        str(path.relative_to(ROOT)): len(
            WRITTEN_BY_TOOL.sub('', path.read_text(encoding='utf-8')).splitlines()
        )
        for path in files
        if path.suffix in WRITTEN and path.is_file()
    }
    assert len(lengths) > 300
    assert {name: length for name, length in lengths.items() if length > LONGEST} == {}
    assert f'at most {LONGEST} lines' in (ROOT / 'CONTRIBUTING.md').read_text(encoding='utf-8')
