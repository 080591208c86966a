"""Browsers of a lab without a page."""

import asyncio
import contextlib
from collections.abc import AsyncGenerator, Callable
from typing import Any

import msgspec
import viser
import websockets
from websockets.asyncio.client import ClientConnection, connect

from app.server.viewer import Viewer
from tests.stress.clients import CAMERA

PROTOCOL = websockets.Subprotocol(f"viser-v{viser.__version__}")
MAX_WAIT = 120.0  # [s]: a scene may have to be compiled first


async def until(condition: Callable[[], Any]) -> Any:
    """Wait until something holds, and return it."""
    async with asyncio.timeout(MAX_WAIT):
        while not (found := condition()):
            await asyncio.sleep(0.01)
        return found


class Visitor:
    """A browser without a page."""

    def __init__(self, lab: Viewer, socket: ClientConnection, client: int) -> None:
        self.lab, self.socket, self.client = lab, socket, client

    async def send(self, handle: Any, value: object) -> None:
        """Send the value of a control."""
        await self.say({"type": "GuiUpdateMessage", "uuid": handle._impl.uuid, "updates": {"value": value}})

    async def say(self, message: dict[str, Any]) -> None:
        """Send a message."""
        await self.socket.send(msgspec.msgpack.encode(message))


@contextlib.asynccontextmanager
async def visitor(lab: Viewer) -> AsyncGenerator[Visitor]:
    """A browser that looks at the lab, and reads what it is sent."""
    before = set(lab.server.get_clients())
    address = f"ws://127.0.0.1:{lab.port}"
    async with connect(address, subprotocols=[PROTOCOL], max_size=None, max_queue=None) as socket:
        reading = asyncio.ensure_future(read(socket))
        await socket.send(msgspec.msgpack.encode(CAMERA))
        (client,) = await until(lambda: set(lab.server.get_clients()) - before)
        yield Visitor(lab, socket, client)
        reading.cancel()


async def read(socket: ClientConnection) -> None:
    async for _ in socket:
        pass
