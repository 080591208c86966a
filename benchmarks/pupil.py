"""A student without a browser: a websocket client of a lab that presses, sets, opens tasks and saves functions."""

import asyncio
import contextlib
import math
import random
import re
import struct
import time
from collections.abc import AsyncGenerator, Callable
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
import zstandard
from websockets.asyncio.client import ClientConnection

from benchmarks.labs import connected

STATUS = re.compile(r'data-state="(\w+)".*? t = ([\d.]+) s')
SLOW_MOTION = "Slow motion"  # in the status line while a run that left its bounds is shown again
STIFFNESS = "Stiffness [N/m]"
TASKS = ("3.2-1", "3.2-2", "3.2-3", "3.3-1")  # of the rope
SHADED = "/rope"  # node that a page draws with its shader, and says so: it is sent no vertices of its own
PAUSE = (1.0, 5.0)  # [s] between two actions
ANSWER_LIMIT = 30.0  # [s] after which an action counts as not answered
SPRING_FORCE = """# version {number}
import numpy as np

def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):
    r = x2 - x1
    length = np.linalg.norm(r)
    return stiffness * (length - rest_length) * r / length - damping * (v1 - v2)
"""


def decoded(message: bytes) -> list[dict[str, Any]]:
    """The messages in one transmission of viser's: lengths, a compressed part, and arrays, which are left out."""
    _, size = struct.unpack_from("<QQ", message)
    inner = zstandard.ZstdDecompressor().decompress(message[16 : 16 + size])
    return list(msgspec.msgpack.decode(inner)["messages"])


class Pupil:
    """One client. Answers are in `answers`: (action, time [s]); NaN for none within `ANSWER_LIMIT`."""

    def __init__(self, port: int, folder: Path, seed: int) -> None:
        self.port, self.folder, self.random = port, folder, random.Random(seed)
        self.answers: list[tuple[str, float]] = []
        self.frames: list[float] = []  # [s] when a picture came
        self.clock: list[tuple[float, float]] = []  # [s] when a status line came, and the time of a running rope in it
        self.made: list[tuple[str, str]] = []  # label and uuid of each control and command, in order
        self.state = ""  # "running" or "paused"
        self.headline = ""  # on the student's files
        self.task = ""  # as the list of tasks shows it
        self.stiffness = math.nan  # [N/m] as the slider shows it
        self.saves = 0
        self.links = 0  # followed
        self.news = asyncio.Event()

    async def attend(self, seconds: float) -> None:
        """Join the lab, and act for so long."""
        async with self.joined() as socket:
            end = time.monotonic() + seconds
            actions = (self.press, self.press, self.set_value, self.set_value, self.open_task, self.save)
            while time.monotonic() < end:
                await asyncio.sleep(self.random.uniform(*PAUSE))
                await self.random.choice(actions)(socket)

    @contextlib.asynccontextmanager
    async def joined(self) -> AsyncGenerator[ClientConnection]:
        """A connection to the lab, once the panel is there."""
        async with connected(self.port) as socket:
            reading = asyncio.ensure_future(self.read(socket))
            try:
                async with asyncio.timeout(ANSWER_LIMIT):
                    while not {"Play or pause", STIFFNESS, "From the page", "Task", "Shaders"} <= self.controls.keys():
                        await self.hear()
                await self.send(socket, "Shaders", f"pupil\n{SHADED}")
                yield socket
            finally:
                reading.cancel()

    @property
    def controls(self) -> dict[str, str]:
        """Label of a control or command -> uuid; of several the oldest, as a task's own go when it does."""
        return dict(reversed(self.made))

    async def hear(self) -> None:
        """Wait for the next message."""
        self.news.clear()
        await self.news.wait()

    async def read(self, socket: ClientConnection) -> None:
        """Take in what comes."""
        async for message in socket:
            assert isinstance(message, bytes)
            now, is_frame = time.monotonic(), False
            for part in decoded(message):
                is_frame = is_frame or part["type"] == "SceneNodeUpdateMessage"
                self.learn(part, now)
            if is_frame:
                self.frames.append(now)
            self.news.set()

    def learn(self, message: dict[str, Any], now: float) -> None:
        """Note a control, its value, or a text of the panel."""
        uuid, props = message.get("uuid", ""), message.get("props") or {}
        updates = message.get("updates") or {}
        if message["type"] == "GuiMultiSliderMessage":
            self.made.append((f"slider of {self.made[-1][0]}", uuid))
        elif props.get("label"):
            self.made.append((props["label"], uuid))
        elif message["type"] == "GuiRemoveMessage":
            self.made = [(label, other) for label, other in self.made if other != uuid]
        value = updates.get("value", message.get("value"))
        if value and uuid == self.controls.get("Task"):
            self.task = value
        elif value and uuid == self.controls.get(f"slider of {STIFFNESS}"):
            self.stiffness = 10.0 ** value[0]
        text = str(updates.get("content") or props.get("content") or "")
        if found := STATUS.search(text):
            self.state = found[1]
            in_real_time = self.state == "running" and SLOW_MOTION not in text
            self.clock.append((now, float(found[2]) if in_real_time else math.nan))
        elif "Your code:" in text:
            self.headline = text

    async def act(self, action: str, change: Callable[[], Any], seen: Callable[[], bool]) -> None:
        """Do something, and note how long it took until it was seen."""
        start = time.monotonic()
        self.clock.append((start, math.nan))  # the next code may set the clock back, or stop it
        await change()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(ANSWER_LIMIT):
                while not seen():
                    await self.hear()
        self.answers.append((action, time.monotonic() - start if seen() else float("nan")))

    async def send(self, socket: ClientConnection, control: str, value: str) -> None:
        """Send the value of a control."""
        uuid = self.controls[control]
        message = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}
        await socket.send(msgspec.msgpack.encode(message))

    async def press(self, socket: ClientConnection) -> None:
        """Pause the rope, and let it continue, or the other way round."""
        command = msgspec.msgpack.encode({"type": "CommandTriggerMessage", "uuid": self.controls["Play or pause"]})
        for _ in range(2):
            was = self.state
            await self.act("button", lambda: socket.send(command), lambda was=was: self.state != was)

    async def set_value(self, socket: ClientConnection) -> None:
        """Change the stiffness in its field; the slider beside it follows."""
        stiffness = round(self.random.uniform(400.0, 1200.0), 1)
        change = partial(self.send, socket, STIFFNESS, f"{stiffness}")
        await self.act("value", change, lambda: math.isclose(self.stiffness, stiffness))

    async def open_task(self, socket: ClientConnection) -> None:
        """Follow a link to a task."""
        item = self.random.choice([item for item in TASKS if item not in self.task])
        self.links += 1  # the lab takes a text of a page once, by its number
        text = f"pupil {self.links}\n?task={item}"
        await self.act("task", lambda: self.send(socket, "From the page", text), lambda: item in self.task)

    async def save(self, socket: ClientConnection) -> None:
        """Save a function that works, after one with an error, and wait until each is noticed."""
        del socket
        for text, fails in (("def spring_force(:\n", True), (SPRING_FORCE, False)):
            self.saves += 1
            await self.act(
                "saved function",
                lambda text=text: asyncio.to_thread(
                    (self.folder / "rope.py").write_text, text.replace("{number}", str(self.saves)), "utf-8"
                ),
                lambda fails=fails: ("stopped" in self.headline) is fails,
            )
