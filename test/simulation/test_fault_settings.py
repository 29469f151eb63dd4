"""Faults by parameters and by file."""

import pytest

from gear_dynamics.model import faults
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.simulation.faults import FaultSettings, read_faults


def test_there_is_a_healthy_fault_of_each_kind():
    settings = FaultSettings()
    assert settings.faults() == ()
    names = settings.to_mapping()
    assert {f'fault.{kind}.severity' for kind in faults.KINDS} < set(names)
    assert all(about.live for about in settings.parameters())


def test_parameters_make_faults():
    settings = FaultSettings.from_mapping(
        {'fault.root_crack.severity': 0.4, 'fault.root_crack.tooth': -1, 'speed': 100.0}
    )
    assert settings.faults() == (faults.RootCrack('pinion', tooth=None, severity=0.4),)


def test_a_file_has_any_number(tmp_path):
    file = tmp_path / 'faults.yaml'
    file.write_text(
        '- {fault: root_crack, wheel: pinion, tooth: 5, severity: 0.4}\n'
        '- {fault: root_crack, wheel: pinion, tooth: 6, severity: 0.2}\n'
    )
    assert [(each.tooth, each.severity) for each in read_faults(file)] == [(5, 0.4), (6, 0.2)]


@pytest.mark.parametrize(
    ('values', 'message'),
    [
        ({'fault.root_crak.severity': 0.1}, 'the nearest name is fault.root_crack.severity'),
        ({'fault.wear.severity': 2}, 'fault.wear.severity is 2'),
    ],
)
def test_wrong_parameters_are_refused(values, message):
    with pytest.raises(ParameterError, match=message):
        FaultSettings.from_mapping(values)


@pytest.mark.parametrize(
    'text', ['a: 1', '- 3', '- {fault: nothing}', '[', '- {fault: wear, x: 1}']
)
def test_a_malformed_file_is_refused_in_one_line(tmp_path, text):
    file = tmp_path / 'faults.yaml'
    file.write_text(text)
    with pytest.raises(ParameterError, match=r'faults\.yaml: ') as caught:
        read_faults(file)
    assert '\n' not in str(caught.value)


def test_a_missing_file_is_refused():
    with pytest.raises(ParameterError, match=r'nowhere\.yaml: cannot be read'):
        read_faults('/nowhere.yaml')
