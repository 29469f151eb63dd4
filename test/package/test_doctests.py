"""The examples in docstrings run, and say what they print."""

import doctest
import importlib

import pytest

from gear_dynamics.digest import ROOT

MODULES = [
    '.'.join(path.relative_to(ROOT.parent).with_suffix('').parts)
    for path in sorted(ROOT.rglob('*.py'))
    if '>>>' in path.read_text(encoding='utf-8')
]


@pytest.mark.parametrize('name', MODULES)
def test_examples_of_a_module_run(name):
    if name.startswith('gear_dynamics.nodes'):
        pytest.importorskip('rclpy')
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    failed, tried = doctest.testmod(importlib.import_module(name), optionflags=flags)
    assert tried
    assert not failed


def test_there_are_examples():
    assert 'gear_dynamics.simulation.simulate' in MODULES
