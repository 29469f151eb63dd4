"""The page's server: static files and one websocket a page, on the loopback unless told otherwise.

Only the page itself may command: its address, its Origin and its token are checked.
"""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import hmac
import ipaddress
import logging
import secrets
from importlib import resources

from aiohttp import WSCloseCode, WSMsgType, web

from gear_dynamics.web.commands import read_command
from gear_dynamics.web.frames import Frames
from gear_dynamics.web.hub import Hub
from gear_dynamics.web.messages import LARGEST, MessageRefusedError, json_text, read_message
from gear_dynamics.web.presets import PRESETS
from gear_dynamics.web.view import View

FRAME_PERIOD = 0.04
"""Time between two frames of a page [s]."""

MOST_PAGES = 16
"""Pages served at once."""

STALLED = 10.0
"""Time after which a page that takes nothing is let go [s]."""

HEADERS = {
    'Cache-Control': 'no-store',
    'Content-Security-Policy': (
        "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
        "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
    ),
    'X-Content-Type-Options': 'nosniff',
    'Referrer-Policy': 'no-referrer',
}
"""Sent with every answer. 'unsafe-inline' of styles is what the plotting library sets on its own
elements; scripts come from this server alone."""

TOKEN_MARK = '{{token}}'


class PageServer:
    """Serve the page of a hub.

    Parameters
    ----------
    hub : Hub
    host : str
        Address to listen on.
    port : int
        0 takes a free one.
    """

    def __init__(self, hub: Hub, host: str, port: int) -> None:
        self._hub = hub
        self._host = host
        self._port = port
        self._token = secrets.token_urlsafe(24)
        self._pages: set[web.WebSocketResponse] = set()
        self._runner: web.AppRunner | None = None

    @property
    def address(self) -> str:
        """The page's address for a browser on this machine."""
        host = 'localhost' if _is_any(self._host) else self._host
        return f'http://{f"[{host}]" if ":" in host else host}:{self._port}/'

    async def start(self) -> None:
        """Listen.

        Raises
        ------
        OSError
            If the address cannot be listened on.
        """
        application = web.Application(middlewares=[self._guard], client_max_size=LARGEST)
        application.router.add_get('/', self._index)
        application.router.add_get('/socket', self._socket)
        static = resources.files('gear_dynamics.web') / 'static'
        application.router.add_static('/static/', str(static))
        logging.getLogger('aiohttp').setLevel(logging.CRITICAL)  # what clients do wrong
        self._runner = web.AppRunner(application, access_log=None, shutdown_timeout=1.0)
        await self._runner.setup()
        site = web.TCPSite(self._runner, self._host, self._port)
        await site.start()
        self._port = self._runner.addresses[0][1]

    async def stop(self) -> None:
        """Let all pages go and stop listening."""
        for page in list(self._pages):
            with contextlib.suppress(Exception):
                await page.close(code=WSCloseCode.GOING_AWAY, message=b'the server stops')
        if self._runner is not None:
            await self._runner.cleanup()

    @web.middleware
    async def _guard(self, request: web.Request, handler: web.Handler) -> web.StreamResponse:  # type: ignore[name-defined]
        if not self._own_host(request.headers.get('Host', '')):
            return web.Response(status=403, text='this Host is not served\n')
        response = await handler(request)
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    def _own_host(self, host: str) -> bool:
        name, _, port = host.rpartition(':')
        if not port.isdigit() or int(port[:6]) != self._port:
            return False
        if _is_any(self._host):  # any of this machine's addresses, but no name of others
            return name == 'localhost' or _is_address(name.strip('[]'))
        return name.strip('[]') in {self._host, 'localhost', '127.0.0.1'}

    async def _index(self, request: web.Request) -> web.Response:
        page = resources.files('gear_dynamics.web') / 'static' / 'index.html'
        text = page.read_text(encoding='utf-8').replace(TOKEN_MARK, self._token)
        return web.Response(text=text, content_type='text/html')

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        if request.headers.get('Origin') != f'{request.scheme}://{request.host}':
            return web.Response(status=403, text='this Origin is not served\n')
        if not self._has_token(request.query.get('token')):
            return web.Response(status=403, text='reload the page: its token is not valid\n')
        if len(self._pages) >= MOST_PAGES:
            return web.Response(status=503, text=f'{MOST_PAGES} pages are open already\n')
        socket = web.WebSocketResponse(max_msg_size=LARGEST, heartbeat=3 * STALLED, compress=False)
        await socket.prepare(request)
        self._pages.add(socket)
        page = _Page(self._hub, socket)
        sender = asyncio.create_task(page.send_frames())
        try:
            await page.receive()
        finally:
            sender.cancel()
            self._pages.discard(socket)
        return socket

    def _has_token(self, token: str | None) -> bool:
        return hmac.compare_digest((token or '').encode(), self._token.encode())


@dataclasses.dataclass
class _Page:
    """One open page: its view, and the two sides of its socket."""

    hub: Hub
    socket: web.WebSocketResponse
    view: View = dataclasses.field(default_factory=View)
    ready: asyncio.Event = dataclasses.field(default_factory=asyncio.Event)

    async def receive(self) -> None:
        """Take messages until the page goes."""
        async for message in self.socket:
            if message.type is not WSMsgType.TEXT:
                continue
            try:
                self._take(message.data)
            except MessageRefusedError as error:
                await self._say(str(error))

    def _take(self, text: str) -> None:
        content = read_message(text)
        if content.get('type') == 'ready':
            self.ready.set()
            return
        if content.get('type') == 'view':
            self.view = View.from_message(content)
            return
        if content.get('type') != 'command':
            raise MessageRefusedError('type must be view, ready or command')
        rig = self.hub.rig(self.view.rig)
        if rig is None:
            raise MessageRefusedError(self.hub.waiting_for)
        refusal = self.hub.carry_out(rig, read_command(content, self.hub.fault_kinds))
        if refusal:
            raise MessageRefusedError(refusal)

    async def send_frames(self) -> None:
        """Send frames for as long as the page is open, each when the last one is drawn.

        A slow page gets fewer frames, and none of them late; a page that nobody sees gets none.
        """
        frames = Frames()
        self.ready.set()
        await self.socket.send_str(json_text({'type': 'hello', **self._hello()}))
        with contextlib.suppress(ConnectionError, asyncio.TimeoutError):
            while not self.socket.closed:
                await self.ready.wait()
                await asyncio.wait_for(self._send(frames), STALLED)
                await asyncio.sleep(FRAME_PERIOD)
        with contextlib.suppress(Exception):
            await self.socket.close()

    def _hello(self) -> dict[str, object]:
        presets = [preset.name for preset in PRESETS]
        return {'presets': presets, 'faultKinds': list(self.hub.fault_kinds)}

    async def _send(self, frames: Frames) -> None:
        rig = self.hub.rig(self.view.rig)
        if rig is None:
            await self.socket.send_str(json_text({'type': 'waiting', 'text': self.hub.waiting_for}))
            await asyncio.sleep(0.5)
            return
        self.ready.clear()
        for message in frames.next(rig, self.hub.names, self.view):
            if isinstance(message, str):
                await self.socket.send_str(message)
            else:
                await self.socket.send_bytes(message)

    async def _say(self, line: str) -> None:
        with contextlib.suppress(ConnectionError):
            await self.socket.send_str(json_text({'type': 'refused', 'text': line}))


def _is_any(host: str) -> bool:
    return host in ('', '0.0.0.0', '::')


def _is_address(host: str) -> bool:
    with contextlib.suppress(ValueError):
        ipaddress.ip_address(host)
        return True
    return False
