"""Server: gives the page to this machine's browsers, and to nobody else; it never waits for a slow one."""

import asyncio
import json
import re
import secrets
import signal
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from aiohttp import WSMsgType, web

from render.live.session import Begun, Session
from render.live.worker import Settings
from render.page.document import live

ADDRESS = "127.0.0.1"
"""Nobody from outside can connect."""

OURS = re.compile(r"(127\.0\.0\.1|localhost)(:\d{1,5})?")
"""Names that this server goes by: a page of anybody else's, whose name was made to lead here, is refused."""

AHEAD = 2
"""Frames that may be on the way to a browser that has not told that it has them."""

READERS = 8
"""Browsers that may look at once."""

LONGEST = 4096
"""Bytes of a message from a browser at most."""

HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",  # the address holds the token
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


class Reader:
    """A browser that looks: of each kind of message the newest is kept for it, and of frames the newest one."""

    def __init__(self, socket: web.WebSocketResponse, known: dict[str, str], frame: bytes | None) -> None:
        """Begin with what is known."""
        self._socket = socket
        self._words = dict(known)
        self._frame = frame
        self._ahead = 0
        self._news = asyncio.Event()
        self._news.set()

    def tell(self, kind: str, words: str) -> None:
        """Keep a message until it can be sent."""
        self._words.pop(kind, None)
        self._words[kind] = words
        self._news.set()

    def show(self, frame: bytes) -> None:
        """Keep a frame until the next one comes, or it can be sent."""
        self._frame = frame
        self._news.set()

    def has_seen(self) -> None:
        """Note that a frame has arrived."""
        self._ahead = max(self._ahead - 1, 0)
        self._news.set()

    async def write(self) -> None:
        """Send what there is, for ever."""
        while True:
            await self._news.wait()
            self._news.clear()
            while self._words:
                await self._socket.send_str(self._words.pop(next(iter(self._words))))
            if self._frame is not None and self._ahead < AHEAD:
                frame, self._frame = self._frame, None
                self._ahead += 1
                await self._socket.send_bytes(frame)


class Server:
    """One session, and whoever looks at it."""

    def __init__(self, begun: Begun, settings: Settings) -> None:
        """Prepare; `begin` starts the session."""
        self.token = secrets.token_urlsafe(24)
        self._begun, self._settings = begun, settings
        self._known: dict[str, str] = {}
        self._frame: bytes | None = None
        self._readers: dict[web.WebSocketResponse, Reader] = {}
        self._session: Session | None = None

    def begin(self) -> None:
        """Start the session, within a running loop."""
        self._session = Session(self._begun, self._settings, asyncio.get_running_loop(), self._tell, self._show)

    def application(self) -> web.Application:
        """Give what answers requests."""
        app = web.Application(middlewares=[self._guard], client_max_size=LONGEST)
        app.router.add_get("/{token}/", self._page)
        app.router.add_get("/{token}/socket", self._socket)
        app.router.add_get("/{token}/preset.toml", self._preset)
        return app

    async def close(self) -> None:
        """Say goodbye to all, and end the session."""
        for socket in list(self._readers):
            with suppress(ConnectionError, asyncio.TimeoutError):
                await asyncio.wait_for(socket.close(code=1001, message=b"tiswarm has ended"), 1)
        if self._session is not None:
            self._session.close()

    @web.middleware
    async def _guard(self, request: web.Request, handler: Callable) -> web.StreamResponse:
        """Refuse whoever does not call this server by its name, or does not know the token."""
        if not OURS.fullmatch(request.headers.get("Host", "")):
            raise web.HTTPForbidden(text="this address is not served here\n", headers=HEADERS)
        given = request.match_info.get("token", "")
        if not secrets.compare_digest(given.encode(), self.token.encode()):
            raise web.HTTPForbidden(text="open the address that tiswarm live has printed\n", headers=HEADERS)
        response = await handler(request)
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    async def _page(self, request: web.Request) -> web.Response:
        policy, text = live(self._begun.scenario.title, request.headers["Host"])
        headers = {"Content-Security-Policy": f"{policy}; frame-ancestors 'none'"}
        return web.Response(text=text, content_type="text/html", charset="utf-8", headers=headers)

    async def _preset(self, _request: web.Request) -> web.Response:
        assert self._session is not None
        name = re.sub(r"[^\w-]+", "-", self._begun.scenario.preset).strip("-") or "preset"
        headers = {"Content-Disposition": f'attachment; filename="{name}-live.toml"'}
        return web.Response(
            text=self._session.scenario.to_toml(), content_type="application/toml", charset="utf-8", headers=headers
        )

    async def _socket(self, request: web.Request) -> web.WebSocketResponse:
        if request.headers.get("Origin") != f"http://{request.headers['Host']}":
            raise web.HTTPForbidden(text="only the page itself may connect\n", headers=HEADERS)
        if len(self._readers) >= READERS:
            raise web.HTTPServiceUnavailable(text=f"{READERS} pages are open; close one\n", headers=HEADERS)
        socket = web.WebSocketResponse(heartbeat=20, max_msg_size=LONGEST, compress=False)
        await socket.prepare(request)
        reader = self._readers[socket] = Reader(socket, self._known, self._frame)
        writing = asyncio.create_task(_quietly(reader.write()))
        try:
            async for message in socket:
                if message.type == WSMsgType.TEXT:
                    self._heed(reader, message.data)
        finally:
            writing.cancel()
            self._readers.pop(socket, None)
        return socket

    def _heed(self, reader: Reader, text: str) -> None:
        """Heed what a reader did; what cannot be is told to that reader alone."""
        assert self._session is not None
        try:
            message = json.loads(text)
            if message == {"act": "seen"}:
                reader.has_seen()
            else:
                self._session.do(message)
        except (ValueError, RecursionError) as error:
            reader.tell("note", json.dumps({"kind": "note", "words": str(error), "wrong": True}))

    def _tell(self, kind: str, words: dict[str, Any]) -> None:
        text = json.dumps({"kind": kind, **words})
        if kind != "note":  # of notes none is kept for those who come later
            self._known.pop(kind, None)
            self._known[kind] = text
        if kind == "scene":
            self._frame = None
        for reader in self._readers.values():
            reader.tell(kind, text)

    def _show(self, frame: bytes) -> None:
        self._frame = frame
        for reader in self._readers.values():
            reader.show(frame)


async def _quietly(writing: Any) -> None:
    """Write until the reader is gone."""
    with suppress(ConnectionError, RuntimeError):
        await writing


def serve(begun: Begun, settings: Settings, port: int, announce: Callable[[str], None]) -> None:
    """Serve a live page until Ctrl-C. port: 0 for any that is free; announce: called with the page's address.

    Errors: OSError where the port is taken.
    """
    asyncio.run(_serve(begun, settings, port, announce))


async def _serve(begun: Begun, settings: Settings, port: int, announce: Callable[[str], None]) -> None:
    loop, stopped = asyncio.get_running_loop(), asyncio.Event()
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        with suppress(NotImplementedError, AttributeError):  # Windows has no handlers in its loop, and no SIGHUP
            loop.add_signal_handler(getattr(signal, name), stopped.set)
    server = Server(begun, settings)
    runner = web.AppRunner(server.application(), access_log=None, shutdown_timeout=1)
    await runner.setup()
    try:
        await web.TCPSite(runner, ADDRESS, port).start()
        server.begin()
        announce(f"http://{ADDRESS}:{runner.addresses[0][1]}/{server.token}/")
        await stopped.wait()
    finally:
        await server.close()
        await runner.cleanup()
