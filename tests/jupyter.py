"""A real Jupyter server in a process of its own, behind a token and a path, as a JupyterHub has it."""

import contextlib
import json
import os
import secrets
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import viser
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

BASE = "/user/ada/"
START_TIMEOUT = 90.0  # [s]


class Jupyter:
    """A running server."""

    def __init__(self, folder: Path, base: str = BASE, *options: str) -> None:
        """folder: of its notebooks and of all that it writes."""
        self.token, self.folder, self.base = secrets.token_hex(16), folder, base
        own = {f"JUPYTER_{name}_DIR": str(folder / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
        self.runtime = folder / "runtime"
        self.log = (folder / "jupyter.log").open("w")
        settings = [
            f"--ServerApp.base_url={base}", f"--IdentityProvider.token={self.token}", "--ServerApp.port=0",
            f"--ServerApp.root_dir={folder}", "--ServerApp.open_browser=False", "--allow-root", *options,
        ]  # fmt: skip
        self.process = subprocess.Popen(
            [sys.executable, "-m", "jupyter_server", *settings],
            env={**os.environ, **own, "JUPYTER_PLATFORM_DIRS": "1", "IPYTHONDIR": str(folder / "ipython")},
            stdout=self.log, stderr=self.log, cwd=folder,
        )  # fmt: skip
        self.port = self.wait_for_port()

    def wait_for_port(self) -> int:
        end = time.monotonic() + START_TIMEOUT
        while time.monotonic() < end and self.process.poll() is None:
            for path in self.runtime.glob("jpserver-*.json"):
                with contextlib.suppress(ValueError, OSError):  # half written, or nobody listens yet
                    port = int(json.loads(path.read_text("utf-8"))["port"])
                    socket.create_connection(("127.0.0.1", port), timeout=10).close()
                    return port
            time.sleep(0.05)
        self.end()
        raise AssertionError((self.folder / "jupyter.log").read_text("utf-8"))

    def address(self, path: str = "", host: str = "127.0.0.1") -> str:
        """Of a page below the base path, with the token."""
        return f"http://{host}:{self.port}{self.base}{path}{'&' if '?' in path else '?'}token={self.token}"

    def ask(self, path: str, method: str = "GET") -> Any:
        """The answer of the server's own interface."""
        request = urllib.request.Request(self.address(path), method=method, data=b"{}" if method == "POST" else None)
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.loads(answer.read() or b"null")

    def end(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(15)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()


@contextlib.contextmanager
def jupyter(folder: Path, base: str = BASE, *options: str) -> Iterator[Jupyter]:
    """A server that ends with the block."""
    server = Jupyter(folder, base, *options)
    try:
        yield server
    finally:
        server.end()


def join(port: int, path: str, origin: str, name: str = "127.0.0.1", **headers: str) -> int:
    """Connect as viser's client does: 101 where it is let in, 0 where it is closed at once, else the status.

    name: of the server, as the browser calls it.
    """
    try:
        with connect(
            f"ws://{name}:{port}{path}",
            sock=socket.create_connection(("127.0.0.1", port)),
            origin=origin,  # type: ignore[arg-type]
            subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
            additional_headers=headers,
            max_size=None,
        ) as browser:
            return 101 if browser.recv(timeout=60) else 0
    except InvalidStatus as refusal:
        return refusal.response.status_code
    except ConnectionClosed:
        return 0
