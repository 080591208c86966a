"""Browsers without a browser: websocket clients of viser's protocol, well-behaved and not."""

import asyncio
import contextlib
import threading
import time
from collections.abc import Callable, Coroutine, Iterator
from typing import Any

import msgspec
import pytest
import viser
import websockets
from websockets.asyncio.client import ClientConnection, connect

CAMERA = {  # viser counts a browser as there from its first camera on
    "type": "ViewerCameraMessage", "wxyz": (1.0, 0.0, 0.0, 0.0), "position": (0.0, -4.0, 2.0), "fov": 1.3, "near": 0.1,
    "far": 1000.0, "image_height": 480, "image_width": 640, "look_at": (0.0, 0.0, 2.0), "up_direction": (0.0, 0.0, 1.0),
}  # fmt: skip
DRAG = {
    "type": "SceneNodeDragMessage", "start_screen_pos": (0.5, 0.5), "end_screen_pos": (0.4, 0.6), "button": "left",
    "modifier": None, "owner": "",
}  # fmt: skip


class Clients:
    """Clients on an event loop of their own, in a thread."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()
        self.open: list[ClientConnection] = []
        self.received: dict[ClientConnection, int] = {}  # [bytes]
        self.readers: set[asyncio.Task[None]] = set()

    def call(self, work: Coroutine[Any, Any, Any], seconds: float = 60.0) -> Any:
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(seconds)

    def join(self, reads: bool = True) -> ClientConnection:
        """One more client; one that does not read keeps its connection and takes nothing from it."""
        return self.call(self.start(reads))

    async def start(self, reads: bool) -> ClientConnection:
        protocol = websockets.Subprotocol(f"viser-v{viser.__version__}")
        client = await connect(
            f"ws://127.0.0.1:{self.port}",
            origin=websockets.Origin(f"http://127.0.0.1:{self.port}"),
            subprotocols=[protocol],
            max_size=None,
            # A small window, so that who does not read is soon felt on the other side.
            max_queue=(1, 0),
        )
        await client.send(msgspec.msgpack.encode(CAMERA))
        self.open.append(client)
        self.received[client] = 0
        if reads:
            reader = asyncio.ensure_future(self.read(client))
            self.readers.add(reader)
            reader.add_done_callback(self.readers.discard)
        return client

    async def read(self, client: ClientConnection) -> None:
        with contextlib.suppress(websockets.exceptions.ConnectionClosed):
            async for message in client:
                if client in self.received:
                    self.received[client] += len(message)

    def say(self, client: ClientConnection, message: dict[str, Any]) -> None:
        self.call(client.send(msgspec.msgpack.encode(message)))

    def drag(self, client: ClientConnection, node: str, phase: str, instance: int | None, end: Any) -> None:
        """A hand on a node: `phase` is start, update or end; `end` is where it points [m]."""
        self.say(
            client,
            {**DRAG, "phase": phase, "name": node, "instance_index": instance, "start_position": end,
             "end_position": end},
        )  # fmt: skip

    def kill(self, client: ClientConnection) -> None:
        """End a client as a killed process does: no closing handshake."""
        self.loop.call_soon_threadsafe(client.transport.abort)
        self.open.remove(client)
        self.received.pop(client)

    def shut(self) -> None:
        for client in list(self.open):
            self.kill(client)
        self.call(asyncio.sleep(0.1))
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join(10.0)


@contextlib.contextmanager
def clients_of(port: int) -> Iterator[Clients]:
    clients = Clients(port)
    try:
        yield clients
    finally:
        clients.shut()


def until(condition: Callable[[], Any], what: str, seconds: float = 60.0) -> None:
    """Wait until the condition holds, or fail: what must not hang is waited for this long."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return
        time.sleep(0.02)
    pytest.fail(f"not within {seconds:g} s: {what}")
