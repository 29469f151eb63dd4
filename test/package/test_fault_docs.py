"""docs/faults.md has a row for every fault, with its magnitude."""

from pathlib import Path

import pytest

from gear_dynamics.model.faults import KINDS

DOCS = (Path(__file__).resolve().parents[2] / 'docs' / 'faults.md').read_text(encoding='utf-8')


@pytest.mark.parametrize('each', KINDS.values())
def test_every_fault_has_a_row_and_a_source_of_its_magnitude(each):
    (row,) = [line for line in DOCS.splitlines() if line.startswith(f'| `{each.__name__}` |')]
    magnitude = row.split('|')[3].strip().split('`')[1].partition('(')[0]
    assert hasattr(each, magnitude)
    for name in row.split('|')[2].split('`')[1::2]:
        assert name in {about.name for about in each.parameters()}
