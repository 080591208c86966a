"""Labs and their clients, for benchmarks. Clients read all messages and draw nothing.

`python -m benchmarks.labs PORT CLIENTS` is a process of clients, so that their time is not counted for the lab.
"""

import asyncio
import contextlib
import os
import subprocess
import sys
import time
from collections.abc import AsyncGenerator, Iterator, Mapping
from importlib.metadata import version
from typing import Any

import msgspec
import websockets
from websockets.asyncio.client import ClientConnection, connect

CAMERA = {
    "type": "ViewerCameraMessage", "wxyz": (1.0, 0.0, 0.0, 0.0), "position": (0.0, -8.0, 3.0), "fov": 1.3, "near": 0.01,
    "far": 1000.0, "image_height": 720, "image_width": 1280, "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}  # fmt: skip
MAX_WAIT = 60.0  # [s] for clients to connect


@contextlib.contextmanager
def served(
    *words: str, environment: Mapping[str, str] | None = None, session: bool = False
) -> Iterator[tuple[int, int]]:
    """A lab in a separate process: its process and its port, once it prints its address.

    words: of its command line. environment: variables to add to those of this process. session: whether it starts a
    new session, as under a JupyterHub.
    """
    command = [sys.executable, "-m", "app", *words, "--no-open", "--port", "0"]
    surroundings = {**os.environ, **(environment or {})}
    server = subprocess.Popen(
        command, stdout=subprocess.PIPE, encoding="locale", env=surroundings, start_new_session=session
    )
    try:
        assert server.stdout is not None
        address = next(word for line in server.stdout for word in line.split() if word.startswith("http"))
        yield server.pid, int(address.rpartition(":")[2])
    finally:
        server.terminate()
        server.wait()


@contextlib.contextmanager
def viewer_here(*, shaders: bool = False) -> Iterator[Any]:
    """A lab in this process, with no scene open yet. shaders: it serves browsers that draw with them."""
    from app.render.injection import record_shaders
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    try:
        if shaders:
            record_shaders(viewer.server)
        yield viewer
    finally:
        viewer.shut()


@contextlib.contextmanager
def listened_to(viewer: Any, clients: int = 1) -> Iterator[None]:
    """Inside, so many clients of a separate process listen to the lab. Raises RuntimeError if they do not connect."""
    listeners = subprocess.Popen([sys.executable, "-m", "benchmarks.labs", str(viewer.port), str(clients)])
    try:
        end = time.monotonic() + MAX_WAIT
        while len(viewer.server.get_clients()) < clients:
            if listeners.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"{len(viewer.server.get_clients())} of {clients} clients connected")
            time.sleep(0.05)
        yield
    finally:
        listeners.terminate()
        listeners.wait()


@contextlib.asynccontextmanager
async def connected(port: int) -> AsyncGenerator[ClientConnection]:
    """A client that has sent one camera position, as a loaded page does."""
    protocol = websockets.Subprotocol(f"viser-v{version('viser')}")
    async with connect(f"ws://127.0.0.1:{port}", subprotocols=[protocol], max_size=None) as client:
        await client.send(msgspec.msgpack.encode(CAMERA))
        yield client


async def listen(port: int) -> None:
    """Read every message."""
    async with connected(port) as client:
        async for _ in client:
            pass


async def listen_all(port: int, clients: int) -> None:
    """Let so many clients listen at the same time."""
    await asyncio.gather(*(listen(port) for _ in range(clients)))


if __name__ == "__main__":
    asyncio.run(listen_all(int(sys.argv[1]), int(sys.argv[2])))
