"""The page of a real sim, through ROS."""

import asyncio
import json
import re

import pytest

pytest.importorskip('rclpy')
aiohttp = pytest.importorskip('aiohttp')

import ros_support  # noqa: E402
import yaml  # noqa: E402

SIM = 'gear_dynamics.nodes.sim'
DASHBOARD = 'gear_dynamics.nodes.dashboard'
ADDRESS = re.compile(r'http://127\.0\.0\.1:\d+/')


async def states(address, commands, until):
    """Open the page, give commands, and return the first state of which `until` is true."""
    async with aiohttp.ClientSession() as session:
        async with session.get(address) as answer:
            token = (await answer.text()).split('name="token" content="')[1].split('"')[0]
        headers = {'Origin': address.rstrip('/')}
        async with session.ws_connect(f'{address}socket?token={token}', headers=headers) as page:
            given = False
            async for message in page:
                await page.send_json({'type': 'ready'})
                if message.type is not aiohttp.WSMsgType.TEXT:
                    continue
                content = json.loads(message.data)
                if content['type'] != 'state':
                    continue
                if content['controllable'] and not given:
                    given = True
                    for command in commands:
                        await page.send_json({'type': 'command', **command})
                if until(content):
                    return content


def watch(address, commands, until):
    return asyncio.run(asyncio.wait_for(states(address, commands, until), 60))


def test_the_page_shows_and_steers_the_sim(domain):
    with (
        ros_support.Process(DASHBOARD, domain, {'port': 0}) as dashboard,
        ros_support.Process(SIM, domain) as sim,
    ):
        dashboard.wait_for('the page is at')
        address = ADDRESS.search(dashboard.output).group()
        sim.wait_for('streaming')
        commands = [
            {'command': 'set', 'name': 'speed', 'value': 110.0},
            {'command': 'set', 'name': 'friction_coefficient', 'value': 0.07},
        ]

        def obeyed(state):
            parameters = state['configuration'].get('parameters', {})
            given = parameters.get('speed'), parameters.get('friction_coefficient')
            return given == (110.0, 0.07) and abs(state['latest'].get('speed', 0) - 110.0) < 2.0

        state = watch(address, commands, obeyed)
        assert state['rig'] == '/'
        assert 'gear_ay' in state['channels']
        held = watch(
            address,
            [{'command': 'pause', 'held': True}],
            lambda state: 'paused' in state['notices'],
        )
        assert any('friction_coefficient set to 0.07' in line for line in held['notices'])
        assert sim.running
        assert dashboard.stop() == 0


def test_two_rigs_can_be_told_apart(domain):
    remap = ['--ros-args', '-r', '__ns:=/second']
    with (
        ros_support.Process(DASHBOARD, domain, {'port': 0}) as dashboard,
        ros_support.Process(SIM, domain),
        ros_support.Process(SIM, domain, arguments=remap),
    ):
        dashboard.wait_for('the page is at')
        address = ADDRESS.search(dashboard.output).group()
        state = watch(address, [], lambda state: len(state['rigs']) == 2)
        assert sorted(state['rigs']) == ['/', '/second']


def test_an_occupied_port_is_one_line(domain):
    with ros_support.Process(DASHBOARD, domain, {'port': 0}) as first:
        first.wait_for('the page is at')
        port = int(ADDRESS.search(first.output).group().rstrip('/').rsplit(':', 1)[1])
        with ros_support.Process(DASHBOARD, domain, {'port': port}) as second:
            assert second.wait() == 1
            assert f'port {port}' in second.output
            assert 'Traceback' not in second.output


def test_the_configuration_on_the_page_is_that_of_the_topic(domain, client):
    from std_msgs.msg import String

    heard = client.collect(String, 'gear_pair/configuration', qos=latched())
    with (
        ros_support.Process(DASHBOARD, domain, {'port': 0}) as dashboard,
        ros_support.Process(SIM, domain),
    ):
        dashboard.wait_for('the page is at')
        address = ADDRESS.search(dashboard.output).group()
        state = watch(address, [], lambda state: state['configuration'])
        ros_support.wait_until(lambda: heard)
        assert state['configuration'] == yaml.safe_load(heard[-1].data)


def latched():
    from rclpy.qos import DurabilityPolicy, QoSProfile

    return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
