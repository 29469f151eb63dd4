"""The machine files of docs/machines.md can be read."""

import re
from pathlib import Path

import pytest
import yaml

from gear_dynamics.machine.machine import Machine

DOCS = Path(__file__).resolve().parents[2] / 'docs' / 'machines.md'
EXAMPLES = re.findall(r'```yaml\n(.*?)```', DOCS.read_text(encoding='utf-8'), re.DOTALL)


def test_there_is_an_example_for_each_kind_of_machine():
    assert len(EXAMPLES) == 5


@pytest.mark.parametrize('text', EXAMPLES)
def test_every_example_is_a_machine(text):
    machine = Machine.from_mapping(yaml.safe_load(text))
    for shaft in machine.shafts:
        assert machine.root(shaft.name)
