import dataclasses
import math

import pytest
import yaml

from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.configuration import configuration_text


def text(pair=None, **settings):
    return configuration_text(pair or GearPair(), SimSettings(**settings))


def test_holds_every_parameter_as_it_is():
    content = yaml.safe_load(text(GearPair(half_backlash=1e-4), speed=50.0))
    assert GearPair.from_mapping(content['parameters']) == GearPair(half_backlash=1e-4)
    assert SimSettings.from_mapping(content['parameters']) == SimSettings(speed=50.0)


def test_holds_the_derived_quantities():
    derived = yaml.safe_load(text(speed=1000 * 2 * math.pi / 60))['derived']
    assert derived['contact_ratio'] == GearPair().derived.contact_ratio
    assert set(derived) == {f.name for f in dataclasses.fields(GearPair().derived)} | {
        'mesh_frequency'
    }
    assert derived['mesh_frequency'] == pytest.approx(34 * 1000 / 60, rel=1e-14)


def test_rig_comes_back():
    pair = GearPair(pinion_teeth=30, half_backlash=1e-4)
    rig = Rig.from_text(text(pair, sample_rate=25600.0, block_size=100, section_phase=0.25))
    assert rig == Rig(
        pinion_teeth=30,
        gear_teeth=59,
        wn=pair.derived.wn,
        half_backlash=1e-4,
        sample_rate=25600.0,
        block_size=100,
        section_phase=0.25,
        pinion_inertia=pair.derived.pinion_inertia,
        gear_inertia=pair.derived.gear_inertia,
        described=rig.machine,
    )


def test_the_machine_travels_in_the_text():
    pair = GearPair(pinion_teeth=30, half_backlash=1e-4)
    rig = Rig.from_text(text(pair))
    built = dataclasses.replace(rig, described=None).machine
    assert rig.described == rig.machine == built
    assert rig.machine.channel('mesh_force').unit == 'N'


def test_texts_of_before_have_the_machine_of_every_rig():
    content = yaml.safe_load(text())
    del content['machine']
    old = Rig.from_text(yaml.safe_dump(content))
    assert old.described is None
    assert old.machine == Rig.from_text(text()).machine


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('parameters:', 'parameter:', 'parameters'),
        ('pinion_teeth: 34', 'pinion_teeth: 34.5', 'pinion_teeth'),
        ('pinion_teeth: 34', 'pinion_teeth: -34', 'pinion_teeth'),
        ('sample_rate: 51200.0', 'sample_rate: .nan', 'sample_rate'),
        ('sample_rate: 51200.0', 'sample_rate: 0.0', 'sample_rate'),
        ('  wn:', '  nw:', 'wn'),
        ('derived:', '[derived', 'YAML'),
        ('section_phase: 0.5', 'section_phase: half', 'section_phase'),
        ('    teeth: 34', '    teeth: 3', 'machine of the configuration'),
    ],
)
def test_damaged_text_is_refused_in_one_line(old, new, words):
    assert old in text()
    with pytest.raises(ValueError, match=words) as caught:
        Rig.from_text(text().replace(old, new))
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('content', ['', '3', '[1, 2]', 'word', '\x00'])
def test_other_text_is_refused(content):
    with pytest.raises(ValueError, match='configuration'):
        Rig.from_text(content)
