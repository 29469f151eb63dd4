"""What a replay plays and when, in the first pass and in later ones."""

import itertools

import pytest

from gear_dynamics.bag.channel import LogChannel
from gear_dynamics.bag.metadata import OfferedQos
from gear_dynamics.bag.writer import LogWriter
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.nodes.playlist import SHORTEST_PASS, Playlist
from gear_dynamics.nodes.replay_topics import recorded_qos, replayed_names
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.simulation.configuration import configuration_text
from gear_dynamics.wire.messages import deserialize, message_class, serialize
from gear_dynamics.wire.topics import Qos

TEXT = 'std_msgs/msg/String'
NUMBER = 'std_msgs/msg/Float64'
BEGIN = 1_700_000_000 * 10**9
LATCHED = OfferedQos(depth=1, durability='transient_local')
CONFIGURATION = '/gear_pair/configuration'
COUNT = '/count'


def text_of(message):
    return deserialize(message.data, TEXT).data


@pytest.fixture(scope='module')
def log(tmp_path_factory):
    """Half a second of numbers 0.1 s apart; the configuration comes after the first of them."""
    writer = LogWriter(tmp_path_factory.mktemp('logs'), {}, free_floor=1.0)
    for number in range(6):
        data = serialize(message_class(NUMBER)(float(number)))
        at = BEGIN + number * 100_000_000
        writer.write(COUNT, NUMBER, data, at, at)
        if number == 0:
            text = configuration_text(GearPair(), SimSettings())
            data = serialize(message_class(TEXT)(text))
            writer.write(CONFIGURATION, TEXT, data, at + 1000, at, LATCHED)
    return writer.close().path


def playlist(log, begin=0.0, end=0.5, loop=True):
    def refuse(what):
        raise AssertionError(what)

    times = (BEGIN + round(each * 1e9) for each in (begin, end))
    topics = [COUNT, CONFIGURATION]
    return Playlist([log], topics, [CONFIGURATION], *times, loop, refuse, refuse)


def test_one_pass_has_the_configuration_first_and_then_the_spacing_of_the_log(log):
    items = list(playlist(log, loop=False))
    assert [item.message.channel.topic for item in items] == [CONFIGURATION, *6 * [COUNT]]
    assert [item.due_ns for item in items if item.message.channel.topic == COUNT] == [
        number * 100_000_000 for number in range(6)
    ]
    assert {item.pass_number for item in items} == {1}
    assert text_of(items[0].message) == configuration_text(GearPair(), SimSettings())


def test_each_later_pass_begins_with_its_announcement_after_the_duration_of_the_log(log):
    items = list(itertools.islice(playlist(log), 3 * 7))
    for number in (2, 3):
        later = [item for item in items if item.pass_number == number]
        assert later[0].message.channel.topic == CONFIGURATION
        texts = [text_of(item.message) for item in later if item.message.channel.type_name == TEXT]
        assert {Rig.from_text(text).replay_pass for text in texts} == {number}
        due = [item.due_ns for item in later if item.message.channel.topic == COUNT]
        assert due == [(number - 1) * 500_000_000 + each * 100_000_000 for each in range(6)]
        data = [item.message.data for item in later if item.message.channel.topic == COUNT]
        assert data == [
            item.message.data for item in items[:7] if item.message.channel.topic == COUNT
        ]
    assert [item.due_ns for item in items] == sorted(item.due_ns for item in items)


def test_a_part_begins_with_what_held_before_it(log):
    items = list(playlist(log, 0.2, 0.3, loop=False))
    assert [item.due_ns for item in items] == [0, 0, 100_000_000]
    assert items[0].message.channel.topic == CONFIGURATION


def test_a_loop_of_one_message_is_paced(log):
    items = list(itertools.islice(playlist(log, 0.2, 0.2), 40))
    dues = [item.due_ns for item in items if item.message.channel.topic == COUNT]
    assert {b - a for a, b in itertools.pairwise(dues)} == {SHORTEST_PASS}


@pytest.mark.parametrize(
    ('namespace', 'topics', 'names'),
    [
        ('/', ['/rig1/gear_pair/samples'], ['/rig1/gear_pair/samples']),
        ('/b', ['/gear_pair/samples', '/tf'], ['/b/gear_pair/samples', '/b/tf']),
        ('/b', ['/a/gear_pair/samples', '/a/x', '/y'], ['/b/gear_pair/samples', '/b/x', '/b/y']),
        # Two rigs stay two.
        (
            '/b',
            ['/a/gear_pair/events', '/c/gear_pair/events'],
            ['/b/a/gear_pair/events', '/b/c/gear_pair/events'],
        ),
        ('/', ['/diagnostics'], ['~/diagnostics']),
        ('/b', ['/diagnostics'], ['~/diagnostics']),
    ],
)
def test_a_namespace_takes_the_place_of_the_recorded_one(namespace, topics, names):
    assert list(replayed_names(topics, namespace).values()) == names


@pytest.mark.parametrize(
    ('text', 'qos'),
    [
        (OfferedQos(depth=7).text(), Qos(depth=7)),
        (LATCHED.text(), Qos(depth=1, durability='transient_local')),
        ('- {depth: 3, reliability: 2, durability: 1}', Qos(3, 'best_effort', 'transient_local')),
        ('', Qos()),
        ('[', Qos()),
        ('- 5', Qos()),
    ],
)
def test_qos_is_read_in_words_and_numbers(text, qos):
    assert recorded_qos(LogChannel('/x', TEXT, metadata=(('offered_qos_profiles', text),))) == qos
