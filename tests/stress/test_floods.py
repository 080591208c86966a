"""A browser that sends 2,000 messages a second, or holds a key down: the others are told the status as before."""

import contextlib
import threading
import time
from collections.abc import Callable
from typing import Any

import msgspec
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

from tests.stress.clients import CAMERA, DRAG, until
from tests.stress.served import MAX_END_TIME, Watcher, flood, join, served
from tests.stress.tally import Tally

FLOOD, HELD_KEY = 2000.0, 30.0  # [1/s]
SECONDS = 10.0
MAX_FLOOD_SILENCE, MAX_KEY_SILENCE = 1.0, 0.5  # [s] without a status line for another browser
RECOVERY = 1.0  # [s] after the end of a flood, from when all is as before
USUAL_SILENCE = 0.6  # [s] between two status lines as before, on a busy machine
# Methods that hold at any step, so that the run continues and its status line keeps changing.
ROPE = ("--scene", "rope", "--set", "integrator=implicit_euler")
CLOTH = ("--scene", "cloth", "--set", "rows=128", "cols=128", "integrator=implicit_euler")
RACE = ("--scene", "race", "--preset", "Implicit methods on a very stiff rope")
SEA = ("--scene", "square_sea", "--set", "size=512")

Maker = Callable[[Watcher, int], dict[str, Any]]


def update(watcher: Watcher, label: str, value: Any) -> dict[str, Any]:
    """Set the control with a label that begins so."""
    uuid = next(uuid for name, uuid in watcher.controls.items() if name.startswith(label))
    return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}


def key(watcher: Watcher, label: str) -> dict[str, Any]:
    """Press the key of a command."""
    return {"type": "CommandTriggerMessage", "uuid": watcher.commands[label]}


def preset(watcher: Watcher, number: int) -> dict[str, Any]:
    """Press one of the keys 1 to 9."""
    presets = [label for label in watcher.commands if label.startswith("Preset")][:9]
    return key(watcher, presets[number % len(presets)])


def drag(name: str, index: int | None) -> Maker:
    """Start, move and end a drag of an object in the view, again and again."""

    def make(_: Watcher, number: int) -> dict[str, Any]:
        end = (0.0, 0.0, 2.0 + number % 3)
        phase = ("start", "update", "end")[number % 3]
        return {
            **DRAG, "phase": phase, "name": name, "instance_index": index, "start_position": end, "end_position": end,
        }  # fmt: skip

    return make


MAKERS: dict[str, Maker] = {
    "control": lambda w, n: update(w, "Stiffness", str(500 + n % 400)),
    "points": lambda w, n: update(w, "Points", str(2 + n % 998)),
    "out of range": lambda w, n: update(w, "Stiffness", f"{(-1) ** n}e12"),
    "no number": lambda w, n: update(w, "Stiffness", f"<b>{n}"),
    "slider": lambda w, n: update(w, "slider of Stiffness", [2.5 + n % 400 / 200]),
    "slider out of range": lambda w, n: update(w, "slider of Stiffness", [1e5 * (-1) ** n]),
    "checkbox": lambda w, n: update(w, "Grid", bool(n % 2)),
    "preset": preset,
    "reset": lambda w, n: key(w, "Reset"),
    "step": lambda w, n: key(w, "Single step"),
    "play": lambda w, n: key(w, "Play or pause"),
    "scene": lambda w, n: update(w, "Scene", ("rope", "square_sea", "radial_sea", "cloth", "race")[n % 5]),
    "drag": drag("/points", 3),
    "drag the cloth": drag("/cloth", None),
    "camera": lambda w, n: CAMERA,
}
# The scene in which each message costs the server most.
COSTLY = {
    "control": CLOTH, "out of range": CLOTH, "no number": CLOTH, "slider": CLOTH, "slider out of range": CLOTH,
    "checkbox": SEA, "preset": RACE, "reset": CLOTH, "step": CLOTH, "play": CLOTH, "scene": CLOTH,
    "drag the cloth": CLOTH, "camera": SEA,
}  # fmt: skip


@pytest.fixture
def reader() -> Callable[[ClientConnection], None]:
    """Takes in, in threads, what the flooding browsers are sent."""

    def read(connection: ClientConnection) -> None:
        with contextlib.suppress(ConnectionClosed):
            while True:
                connection.recv()

    return lambda connection: threading.Thread(target=read, args=(connection,), daemon=True).start()


def flooded(arguments: tuple[str, ...], what: str, rate: float, reader: Any, tally: Tally) -> tuple[float, float]:
    """(longest silence [s] during a flood, and from `RECOVERY` after it); ends the server in mid-flood."""
    with served(*arguments) as server, tally.fault(f"flood: {what}", int(rate * SECONDS)):
        watcher = Watcher(server.port)
        until(lambda: len(watcher.told) > 3, "status lines before the flood")
        hostile = join(server.port)
        reader(hostile)
        make = MAKERS[what]
        start, end = flood(hostile, lambda number: make(watcher, number), rate, SECONDS)
        if what in ("step", "play"):
            for label in ("Reset", "Single step", "Play or pause"):  # paused by the flood, or perhaps not: now it runs
                hostile.send(msgspec.msgpack.encode(key(watcher, label)))
                time.sleep(0.1)
        time.sleep(RECOVERY + 2.0)
        during = watcher.longest_silence(start, end)
        after = watcher.longest_silence(end + RECOVERY, time.monotonic())
        background = threading.Thread(
            target=lambda: until_closed(hostile, lambda number: make(watcher, number)), daemon=True
        )
        background.start()
        time.sleep(0.5)
        took = server.end()
        assert took < MAX_END_TIME, f"the server took {took:.1f} s to end in the flood"
        tally.notes.append(f"{what} at {rate:g}/s: silence {during:.2f} s, then {after:.2f} s; ended in {took:.1f} s")
        return during, after


def until_closed(connection: ClientConnection, make: Callable[[int], dict[str, Any]]) -> None:
    """Flood until the server ends the connection."""
    with contextlib.suppress(ConnectionClosed):
        flood(connection, make, FLOOD, SECONDS)


@pytest.mark.parametrize(
    ("arguments", "what"),
    [*((ROPE, what) for what in MAKERS if what != "drag the cloth"), *((COSTLY[what], what) for what in COSTLY)],
)
def test_a_flood_slows_the_browser_that_sends_it_and_no_other(
    arguments: tuple[str, ...], what: str, reader: Any, tally: Tally
) -> None:
    during, after = flooded(arguments, what, FLOOD, reader, tally)
    assert during < MAX_FLOOD_SILENCE
    assert after < USUAL_SILENCE


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (RACE, "reset"), (RACE, "preset"), (RACE, "step"), (CLOTH, "reset"), (CLOTH, "preset"), (CLOTH, "step"),
        (SEA, "reset"), (SEA, "preset"), (SEA, "step"), (("--scene", "radial_sea"), "reset"),
        (("--scene", "rope", "--set", "points=1000", "integrator=implicit_midpoint"), "step"),
    ],
)  # fmt: skip
def test_a_key_held_down_leaves_the_status_fresh(
    arguments: tuple[str, ...], what: str, reader: Any, tally: Tally
) -> None:
    during, after = flooded(arguments, what, HELD_KEY, reader, tally)
    assert during < MAX_KEY_SILENCE
    assert after < USUAL_SILENCE
