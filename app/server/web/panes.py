"""Labs beside the first one, at paths of its port: "/pane/2/" is a viser server that binds no port of its own.

The protection of the first lab (origins, key, base path) covers the others too, and a proxy that passes one port passes
all of them. The page of a pane is the same as the first one's, so only its websocket is handed over, to the handler of
its own viser server, which runs on its own event loop.
"""

# pyright: reportPrivateUsage=false

import asyncio
import contextlib
import re
import weakref
from collections.abc import Awaitable, Callable, Coroutine, Generator
from dataclasses import replace
from types import SimpleNamespace
from typing import TypeAlias, TypeVar

import websockets.asyncio.server
from websockets.http11 import Request

from app.render.handles.viser_types import ViserConnection

PANE_PATH = re.compile(r"/pane/([2-9])(?=/)")
T = TypeVar("T")
CLOSING_TIME = 1.0  # [s] for an ending pane to wait for its browsers


class Bridge:
    """A browser's connection, used on another event loop than its own."""

    def __init__(self, connection: ViserConnection, home: asyncio.AbstractEventLoop) -> None:
        self.connection, self.home = connection, home
        self.subprotocol = connection.subprotocol

    async def send(self, data: bytes) -> None:
        """See websockets."""
        await self.at_home(self.connection.send(data))

    async def recv(self) -> object:
        """See websockets."""
        return await self.at_home(self.connection.recv())

    async def close(self, *why: object) -> None:
        """See websockets."""
        await self.at_home(self.connection.close(*why))

    def at_home(self, action: Coroutine[object, object, T]) -> Awaitable[T]:
        """Run on the connection's event loop and wait here; a cancellation here cancels it there."""
        return asyncio.wrap_future(asyncio.run_coroutine_threadsafe(action, self.home))


PaneHandler: TypeAlias = Callable[[Bridge], Coroutine[object, object, None]]


class Unbound:
    """Stand-in for viser's websocket server: it binds no port and gets its connections from `Panes`."""

    server = SimpleNamespace(sockets=())

    def __init__(self, handler: PaneHandler) -> None:
        self.handler = handler
        self.loop: asyncio.AbstractEventLoop | None = None
        self.open: set[asyncio.Task[None]] = set()

    async def __aenter__(self) -> "Unbound":
        self.loop = asyncio.get_running_loop()
        return self

    async def __aexit__(self, *_: object) -> None:
        for task in self.open:
            task.cancel()
        if self.open:
            await asyncio.wait(self.open, timeout=CLOSING_TIME)

    async def serve(self, connection: ViserConnection) -> None:
        """Serve a browser connected to another event loop, on which this runs."""
        assert self.loop is not None
        bridge = Bridge(connection, asyncio.get_running_loop())
        with contextlib.suppress(asyncio.CancelledError, RuntimeError):  # the pane has ended
            await asyncio.wrap_future(asyncio.run_coroutine_threadsafe(self.handle(bridge), self.loop))

    async def handle(self, bridge: Bridge) -> None:
        """Serve it, on the pane's event loop."""
        task = asyncio.create_task(self.handler(bridge))
        self.open.add(task)
        try:
            await task
        finally:
            self.open.discard(task)


class Panes:
    """The panes of a server, by number from 2."""

    def __init__(self) -> None:
        self.servers: dict[int, Unbound] = {}
        self.wanted: weakref.WeakKeyDictionary[ViserConnection, int] = weakref.WeakKeyDictionary()

    def read(self, connection: ViserConnection, request: Request) -> Request | None:
        """The request with the pane's own path, or unchanged if it names no pane; None without a request."""
        match = PANE_PATH.match(request.path)
        if match is None:
            return request
        number = int(match.group(1))
        if number not in self.servers:
            return None
        self.wanted[connection] = number
        return replace(request, path=request.path[match.end() :])

    async def serve(self, connection: ViserConnection, first: Callable[[ViserConnection], Awaitable[None]]) -> None:
        """Hand a websocket to the named pane, or to `first`, the handler of the first lab, if it named none."""
        number = self.wanted.pop(connection, None)
        if number is None:
            await first(connection)
        elif number in self.servers:
            await self.servers[number].serve(connection)

    @contextlib.contextmanager
    def making(self) -> Generator[list[Unbound]]:
        """Context in which a started websocket server is one of a pane, which is put on the list."""
        serve = websockets.asyncio.server.serve
        servers: list[Unbound] = []

        def unbound(handler: PaneHandler, *_: object, **__: object) -> Unbound:
            servers.append(Unbound(handler))
            return servers[-1]

        websockets.asyncio.server.serve = unbound  # type: ignore[assignment]
        try:
            yield servers
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[assignment]

    def remove(self, number: int) -> None:
        """Admit nobody any longer."""
        self.servers.pop(number, None)
