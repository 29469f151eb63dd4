"""The bridge to the Foxglove app, by the app's own protocol."""

import asyncio
import contextlib
import json
import re
import struct

import pytest

pytest.importorskip('rclpy')
pytest.importorskip('foxglove')
aiohttp = pytest.importorskip('aiohttp')

import ros_support  # noqa: E402
from sensor_msgs.msg import PointCloud2  # noqa: E402

from gear_dynamics.wire.messages import deserialize, header_stamp, message_type  # noqa: E402
from gear_dynamics.wire.topics import TABLE_TYPE  # noqa: E402

SIM = 'gear_dynamics.nodes.sim'
BRIDGE = 'gear_dynamics.nodes.foxglove'
MESSAGE_DATA = 1
"""Opcode of a binary message that carries data: opcode, subscription id, log time, payload."""


class App:
    """A client that speaks the protocol foxglove.sdk.v1."""

    def __init__(self, socket):
        self.socket = socket
        self.channels = {}

    async def channel(self, topic):
        """Return the advertised channel of a topic."""
        while topic not in self.channels:
            message = await self.socket.receive(timeout=30)
            content = json.loads(message.data)
            for each in content.get('channels', []):
                self.channels[each['topic']] = each
        return self.channels[topic]

    async def subscribe(self, topic):
        channel = await self.channel(topic)
        subscription = {'id': channel['id'], 'channelId': channel['id']}
        await self.socket.send_json({'op': 'subscribe', 'subscriptions': [subscription]})
        return channel

    async def payload(self):
        """Return the bytes of the next message of a topic."""
        while True:
            message = await self.socket.receive(timeout=30)
            if message.type is aiohttp.WSMsgType.BINARY and message.data[0] == MESSAGE_DATA:
                struct.unpack('<BIQ', message.data[:13])
                return message.data[13:]


def looked_at(bridge, look):
    """Run `look(make_app)` against the bridge, and return what it gives."""
    ros_support.wait_until(lambda: re.search(r'ws://127\.0\.0\.1:\d+', bridge.output))
    address = re.search(r'ws://127\.0\.0\.1:\d+', bridge.output).group()

    async def run():
        async with aiohttp.ClientSession() as session:

            async def app():
                return App(await session.ws_connect(address, protocols=['foxglove.sdk.v1']))

            return await asyncio.wait_for(look(app), 60)

    return asyncio.run(run())


@contextlib.contextmanager
def bridge_and_sim(domain):
    with (
        ros_support.Process(BRIDGE, domain, {'port': 0}) as bridge,
        ros_support.Process(SIM, domain),
    ):
        yield bridge


def test_payloads_are_those_of_the_topic_byte_for_byte(domain, client):
    heard = client.collect(PointCloud2, 'gear_pair/samples', raw=True)
    with (
        ros_support.Process(BRIDGE, domain, {'port': 0}) as bridge,
        ros_support.Process(SIM, domain),
    ):

        async def look(make_app):
            app = await make_app()
            channel = await app.subscribe('/gear_pair/samples')
            payloads = []
            # A busy machine may lose blocks on either way: go on until one came on both.
            while len(payloads) < 20 or not any(each in heard for each in payloads):
                payloads.append(await app.payload())
            return channel, payloads

        ros_support.wait_until(lambda: heard)
        channel, payloads = looked_at(bridge, look)
    by_stamp = {header_stamp(each, TABLE_TYPE): each for each in heard}
    stamps = {header_stamp(each, TABLE_TYPE): each for each in payloads}
    assert all(by_stamp[stamp] == stamps[stamp] for stamp in by_stamp.keys() & stamps.keys())
    assert channel['encoding'] == 'cdr'
    assert channel['schemaEncoding'] == 'ros2msg'
    assert channel['schemaName'] == TABLE_TYPE
    assert channel['schema'] == message_type(TABLE_TYPE).definition


def test_a_late_client_has_the_configuration_also_while_another_looks(domain):
    with (
        ros_support.Process(BRIDGE, domain, {'port': 0}) as bridge,
        ros_support.Process(SIM, domain),
    ):

        async def look(make_app):
            found = []
            for _ in range(3):
                app = await make_app()
                await app.subscribe('/gear_pair/configuration')
                found.append(await app.payload())
            return found

        payloads = looked_at(bridge, look)
    assert payloads[0] == payloads[1] == payloads[2]
    text = deserialize(payloads[0], 'std_msgs/msg/String').data
    assert 'pinion_teeth: 34' in text


def test_a_topic_is_subscribed_to_only_while_somebody_looks(domain, client):
    topic = 'gear_pair/samples'
    node = client.node
    with (
        ros_support.Process(BRIDGE, domain, {'port': 0}) as bridge,
        ros_support.Process(SIM, domain),
    ):

        def listeners():
            return node.count_subscribers(topic)

        async def look(make_app):
            before = listeners()
            app = await make_app()
            await app.subscribe('/gear_pair/samples')
            await app.payload()
            during = listeners()
            await app.socket.close()
            return before, during

        ros_support.wait_until(lambda: node.count_publishers(topic))
        assert looked_at(bridge, look) == (0, 1)
        ros_support.wait_until(lambda: listeners() == 0)


def test_an_occupied_port_is_one_line(domain):
    with ros_support.Process(BRIDGE, domain, {'port': 0}) as first:
        first.wait_for('ws://')
        port = int(re.search(r'ws://127\.0\.0\.1:(\d+)', first.output).group(1))
        with ros_support.Process(BRIDGE, domain, {'port': port}) as second:
            assert second.wait() == 1
            assert f'port {port}' in second.output
            assert 'Traceback' not in second.output
