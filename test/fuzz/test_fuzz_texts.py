"""Damaged texts and any values: files of parameters and thresholds, configurations, machines."""

import tempfile
from pathlib import Path

import pytest
from fuzz.damage import CORPUS, check_refusal, damaged_texts
from hypothesis import given
from hypothesis import strategies as st
from ros_support import ROOT

from gear_dynamics.bag.qos import first_profile, in_words
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.machine.machine import Machine
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.files import NODES, check_parameter_file, read_parameters
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.parameters.yaml_text import YamlError, parse_yaml
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.simulation.faults import read_faults

CONFIGURATION = configuration_text(GearPair(), SimSettings())
FILES = {path.name: path.read_text() for path in sorted((ROOT / 'config').glob('*.yaml'))}
CORPUS_TEXTS = [path.read_text() for path in sorted(CORPUS.glob('*.yaml'))]
TEXTS = [*FILES.values(), *CORPUS_TEXTS, CONFIGURATION]
EXPECTED = (ParameterError, YamlError, ValueError)


def tried(read, *arguments):
    """Call a reader; what it refuses it refuses in one line, as a ValueError of our own wording."""
    try:
        return read(*arguments)
    except EXPECTED as error:
        check_refusal(error)
        return None


@given(text=damaged_texts(TEXTS))
def test_any_text_is_read_or_refused_in_one_line(text):
    tried(parse_yaml, text)
    tried(Rig.from_text, text)
    first_profile(text), in_words(text)  # no QoS is refused
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, 'given.yaml')
        path.write_bytes(text.encode(errors='surrogatepass'))
        for read in (
            check_parameter_file,
            read_parameters,
            read_faults,
            GearPair.from_yaml,
            Machine.from_yaml,
            Thresholds.from_yaml,
        ):
            tried(read, path)


@given(data=st.binary(max_size=200))
def test_any_bytes_are_read_or_refused_in_one_line(data):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, 'given.yaml')
        path.write_bytes(data)
        tried(check_parameter_file, path)
        tried(GearPair.from_yaml, path)
        tried(Thresholds.from_yaml, path)


LISTS = sorted({each for lists in NODES.values() for each in lists}, key=str)

ANYTHING = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=20),
    st.lists(st.integers(), max_size=2),
    st.sampled_from(('1e3', '5.33e8', 'nan', '-inf', '٣', '1_0', '0x1F', '')),
)


@pytest.mark.parametrize('parameters', LISTS)
@given(value=ANYTHING, draw=st.data())
def test_any_value_of_a_parameter_is_taken_in_its_range_or_refused_by_name(parameters, value, draw):
    about = draw.draw(st.sampled_from(parameters.parameters()))
    try:
        taken = about.check(value)
    except ParameterError as error:
        check_refusal(error)
        named = about.name in str(error)
    else:
        named = True
        check_taken(about, taken)
    assert named


def check_taken(about, taken):
    assert type(taken) is type(about.default)
    if about.minimum is not None and about.maximum is not None:
        assert about.minimum <= taken <= about.maximum
