"""Clients that read all messages of a lab on this machine and draw nothing, until they are ended.

`python -m app.bench.listener PORT [CLIENTS]`, in a separate process, so that its time is not counted for the server.
"""

import asyncio
import sys
from importlib.metadata import version

import msgspec
import websockets
from websockets.asyncio.client import connect

CAMERA = {
    "type": "ViewerCameraMessage", "wxyz": (1.0, 0.0, 0.0, 0.0), "position": (0.0, -8.0, 3.0), "fov": 1.3, "near": 0.01,
    "far": 1000.0, "image_height": 720, "image_width": 1280, "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}  # fmt: skip


async def listen(port: int) -> None:
    """Send one camera position, as a loaded page does, and read every message."""
    protocol = websockets.Subprotocol(f"viser-v{version('viser')}")
    async with connect(f"ws://127.0.0.1:{port}", subprotocols=[protocol], max_size=None) as client:
        await client.send(msgspec.msgpack.encode(CAMERA))
        async for _ in client:
            pass


async def listen_all(port: int, clients: int) -> None:
    """Let so many clients listen at the same time."""
    await asyncio.gather(*(listen(port) for _ in range(clients)))


if __name__ == "__main__":
    asyncio.run(listen_all(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1))
