import asyncio
import contextlib
import json
import random

import numpy as np
import pytest

aiohttp = pytest.importorskip('aiohttp')

from gear_dynamics.web.hub import Hub  # noqa: E402
from gear_dynamics.web.live_rig import LiveRig  # noqa: E402
from gear_dynamics.web.server import MOST_PAGES, PageServer  # noqa: E402


class Recorder:
    """Takes commands in place of a machine."""

    def __init__(self):
        self.commands = []

    def carry_out(self, command):
        self.commands.append(command)


def served(check, rig=None):
    """Run `check(session, server, recorder)` against a server of a rig."""

    async def run():
        hub, recorder = Hub('waiting for gear_pair/samples', ('root_crack',)), Recorder()
        if rig is not None:
            hub.add(rig, recorder)
        server = PageServer(hub, '127.0.0.1', 0)
        await server.start()
        try:
            async with aiohttp.ClientSession() as session:
                await asyncio.wait_for(check(session, server, recorder), 30)
        finally:
            await server.stop()

    asyncio.run(run())


def vibrating_rig(peak=1.0):
    rig = LiveRig('rig')
    rows = np.zeros(4096, [('t', float), ('a', float)])
    rows['a'][2000] = peak
    rig.add_block(rows, 4096.0)
    return rig


async def token_of(session, server):
    async with session.get(server.address) as answer:
        text = await answer.text()
    return text.split('name="token" content="')[1].split('"')[0]


async def opened(session, server):
    origin = server.address.rstrip('/')
    token = await token_of(session, server)
    return await session.ws_connect(
        f'{server.address}socket?token={token}', headers={'Origin': origin}
    )


async def next_text(socket, kind):
    """Return the next text message of a kind."""
    while True:
        message = await socket.receive(timeout=10)
        assert message.type in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY), message
        if message.type is aiohttp.WSMsgType.TEXT and json.loads(message.data)['type'] == kind:
            return json.loads(message.data)


@pytest.mark.parametrize('host', ['evil.example', 'evil.example:80', 'localhost:1', ''])
def test_a_foreign_host_is_refused(host):
    async def check(session, server, recorder):
        async with session.get(server.address, headers={'Host': host}) as answer:
            assert answer.status == 403

    served(check)


@pytest.mark.parametrize('origin', ['http://evil.example', 'null', None])
def test_a_foreign_origin_gets_no_socket(origin):
    async def check(session, server, recorder):
        token = await token_of(session, server)
        headers = {'Origin': origin} if origin else {}
        with pytest.raises(aiohttp.WSServerHandshakeError) as refusal:
            await session.ws_connect(f'{server.address}socket?token={token}', headers=headers)
        assert refusal.value.status == 403

    served(check)


def test_without_the_token_of_the_page_there_is_no_socket():
    async def check(session, server, recorder):
        origin = server.address.rstrip('/')
        for query in ('', '?token=', '?token=guess'):
            with pytest.raises(aiohttp.WSServerHandshakeError) as refusal:
                await session.ws_connect(
                    f'{server.address}socket{query}', headers={'Origin': origin}
                )
            assert refusal.value.status == 403

    served(check)


def test_a_page_without_a_rig_is_told_what_is_waited_for():
    async def check(session, server, recorder):
        socket = await opened(session, server)
        assert (await next_text(socket, 'waiting'))['text'] == 'waiting for gear_pair/samples'

    served(check)


def test_a_command_reaches_the_rig_and_a_wrong_one_is_refused_in_one_line():
    async def check(session, server, recorder):
        socket = await opened(session, server)
        await socket.send_json({'type': 'command', 'command': 'set', 'name': 'speed', 'value': 50})
        await socket.send_json({'type': 'command', 'command': 'set', 'name': 'speed', 'value': -1})
        assert 'speed' in (await next_text(socket, 'refused'))['text']
        assert [command.value for command in recorder.commands] == [50.0]

    served(check, vibrating_rig())


def test_a_log_takes_no_commands():
    rig = LiveRig('log', controllable=False)

    async def check(session, server, recorder):
        socket = await opened(session, server)
        await socket.send_json({'type': 'command', 'command': 'reset'})
        assert 'takes no commands' in (await next_text(socket, 'refused'))['text']
        assert not recorder.commands

    served(check, rig)


def test_a_peak_of_one_sample_is_in_the_frame():
    async def check(session, server, recorder):
        socket = await opened(session, server)
        view = {'rig': '', 'channels': ['a'], 'window': 1.0, 'trigger': 'none', 'pixels': 100}
        await socket.send_json({'type': 'view', **view})
        for _ in range(200):
            await socket.send_json({'type': 'ready'})
            message = await socket.receive(timeout=10)
            if message.type is not aiohttp.WSMsgType.BINARY:
                continue
            length = int.from_bytes(message.data[:4], 'little')
            header = json.loads(message.data[4 : 4 + length])
            if header['arrays'].get('a') == 200:
                assert 7.0 in np.frombuffer(message.data[4 + length :], '<f4')
                return
        pytest.fail('no frame of 100 pixels came')

    served(check, vibrating_rig(peak=7.0))


def hostile_texts(count):
    """Return messages that no page sends, from a fixed seed."""
    chance = random.Random(1)
    atoms = ['1e999', '9' * 400, '-' + '9' * 400, 'NaN', '"x"', 'null', '{}', '[]', '"\\u0000"']
    keys = ['type', 'command', 'name', 'value', 'channels', 'window', 'pixels', 'rig', 'held']
    words = ['"view"', '"command"', '"set"', '"speed"', '"fault"', '"preset"', '["a"]']
    for _ in range(count):
        chosen = chance.sample(keys, chance.randint(0, len(keys)))
        yield '{' + ','.join(f'"{key}":{chance.choice(atoms + words)}' for key in chosen) + '}'


def test_hostile_messages_do_no_harm():
    async def check(session, server, recorder):
        socket = await opened(session, server)

        async def drain():
            async for _ in socket:
                pass

        draining = asyncio.create_task(drain())
        for text in hostile_texts(2000):
            await socket.send_str(text)
        draining.cancel()
        other = await opened(session, server)
        assert (await next_text(other, 'state'))['rig'] == 'rig'
        assert not recorder.commands

    served(check, vibrating_rig())


def test_a_message_that_is_too_large_ends_its_own_page_alone():
    async def check(session, server, recorder):
        socket = await opened(session, server)
        await socket.send_str('x' * 1_000_000)
        while (await socket.receive(timeout=10)).type is not aiohttp.WSMsgType.CLOSED:
            pass
        other = await opened(session, server)
        assert (await next_text(other, 'state'))['rig'] == 'rig'

    served(check, vibrating_rig())


def test_a_long_request_line_is_refused():
    async def check(session, server, recorder):
        async with session.get(f'{server.address}{"x" * 10_000}') as answer:
            assert answer.status in (400, 404, 414)
        async with session.get(server.address) as answer:
            assert answer.status == 200

    served(check)


def test_a_page_that_draws_nothing_is_sent_one_frame_alone():
    async def check(session, server, recorder):
        socket = await opened(session, server)
        kinds = []
        with contextlib.suppress(asyncio.TimeoutError):
            while len(kinds) < 20:
                kinds.append((await socket.receive(timeout=1.0)).type)
        assert kinds.count(aiohttp.WSMsgType.BINARY) == 1
        await socket.send_json({'type': 'ready'})
        assert (await socket.receive(timeout=10)).data

    served(check, vibrating_rig())


def test_two_pages_see_the_same_rig_and_too_many_are_refused():
    async def check(session, server, recorder):
        sockets = [await opened(session, server) for _ in range(MOST_PAGES)]
        for socket in sockets[:2]:
            assert (await next_text(socket, 'state'))['rig'] == 'rig'
        with pytest.raises(aiohttp.WSServerHandshakeError) as refusal:
            await opened(session, server)
        assert refusal.value.status == 503

    served(check, vibrating_rig())


def test_an_occupied_port_is_an_os_error():
    async def run():
        first = PageServer(Hub(''), '127.0.0.1', 0)
        await first.start()
        port = int(first.address.rstrip('/').rsplit(':', 1)[1])
        with pytest.raises(OSError, match='in use'):
            await PageServer(Hub(''), '127.0.0.1', port).start()
        await first.stop()

    asyncio.run(run())


def test_what_lies_outside_the_static_files_is_not_served():
    async def check(session, server, recorder):
        for path in ('static/../server.py', 'static/%2e%2e/server.py', 'static//etc/passwd'):
            async with session.get(server.address + path) as answer:
                assert answer.status in (403, 404)

    served(check)
