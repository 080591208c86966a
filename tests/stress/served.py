"""A server in a process of its own, and browsers on it that are websocket clients: one looks on, one floods."""

import contextlib
import itertools
import os
import re
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import viser
from websockets.sync.client import ClientConnection, connect

from benchmarks.pupil import decoded
from tests.stress.clients import CAMERA

STATUS_WORDS = 'class="springtide-panel"'  # in the panel's status line, and nowhere else
MAX_END_TIME = 3.0  # [s] in which a server ends after a signal


def join(port: int) -> ClientConnection:
    """One more browser."""
    connection = connect(
        f"ws://127.0.0.1:{port}",
        origin=f"http://127.0.0.1:{port}",  # type: ignore[arg-type]
        subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
        max_size=None,
        compression=None,
    )
    connection.send(msgspec.msgpack.encode(CAMERA))
    return connection


class Watcher:
    """A browser that looks on, in a thread of its own: when it was told the status, and what there is in the panel."""

    def __init__(self, port: int) -> None:
        self.connection = join(port)
        self.told: list[float] = []  # [s] when a status line came
        self.controls: dict[str, str] = {}  # label -> uuid; "slider of LABEL" for the slider beside a field
        self.label = ""  # of the newest control
        self.commands: dict[str, str] = {}  # label -> uuid
        self.thread = threading.Thread(target=self.read, daemon=True)
        self.thread.start()

    def read(self) -> None:
        """Take in what comes until the connection ends."""
        with contextlib.suppress(Exception):
            while True:
                for message in decoded(self.connection.recv()):  # type: ignore[arg-type]
                    self.learn(message)

    def learn(self, message: dict[str, Any]) -> None:
        """Note a status line, a new control or a new command."""
        props = message.get("props") or {}
        content = (message.get("updates") or {}).get("content") or props.get("content") or ""
        if STATUS_WORDS in content:
            self.told.append(time.monotonic())
        if message["type"] == "RegisterCommandMessage":
            self.commands[props["label"]] = message["uuid"]
        elif message["type"] == "GuiMultiSliderMessage":
            self.controls[f"slider of {self.label}"] = message["uuid"]
        elif "label" in props and "uuid" in message:
            self.label = props["label"]
            self.controls[self.label] = message["uuid"]

    def longest_silence(self, start: float, end: float) -> float:
        """Longest time [s] without a status line between two moments of the monotonic clock."""
        moments = [start, *(t for t in self.told if start <= t <= end), end]
        return max(b - a for a, b in itertools.pairwise(moments))


class Served:
    """A running `springtide` process."""

    def __init__(self, process: "subprocess.Popen[str]", port: int) -> None:
        self.process, self.port = process, port

    def end(self) -> float:
        """Signal the end; the time [s] that it took. Raises TimeoutExpired if it does not end."""
        start = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(4.0 * MAX_END_TIME)
        return time.monotonic() - start


@contextlib.contextmanager
def served(*arguments: str) -> Iterator[Served]:
    """`springtide --no-open --port 0 ARGUMENTS` until the block ends."""
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "--no-open", "--port", "0", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="locale",
        env=dict(os.environ),
    )
    try:
        yield Served(process, port_of(process))
    finally:
        process.kill()
        process.wait()


def port_of(process: "subprocess.Popen[str]", seconds: float = 240.0) -> int:
    """The port that a server says it is bound to."""
    assert process.stdout is not None
    end, said = time.monotonic() + seconds, ""
    while time.monotonic() < end and process.poll() is None:
        if select.select([process.stdout], [], [], 0.2)[0]:
            said += process.stdout.readline()
            if found := re.search(r"http://localhost:(\d+)", said):
                return int(found[1])
    raise AssertionError(f"no server: {said}")


def flood(
    connection: ClientConnection, make: Callable[[int], dict[str, Any]], rate: float, seconds: float
) -> tuple[float, float]:
    """Send make(0), make(1), ... at `rate` [1/s] for `seconds`; (start, end) of the monotonic clock."""
    start = time.monotonic()
    for number in range(int(rate * seconds)):
        connection.send(msgspec.msgpack.encode(make(number)))
        ahead = start + number / rate - time.monotonic()
        if ahead > 0.0:
            time.sleep(ahead)
    return start, time.monotonic()
