"""What a hostile page or program can say to the server, and what becomes of it."""

import asyncio
import contextlib
import errno
import http.client
import math
import os
import random
import socket
import time
from typing import Any

import msgspec
import numpy as np
import pytest
import viser
import websockets
from viser import _messages as vm
from websockets.asyncio.client import connect

from app.render.handles.viser_inside import uuid_of
from app.server.viewer import Viewer
from app.server.web import guard
from app.server.web.guard import (
    MAX_TEXT_LENGTH,
    Intake,
    allowed_value,
    check_port,
    is_bounded,
    is_own_origin,
    open_server,
)
from tests import coroutines
from tests.app.channels import text_of
from tests.stress.clients import CAMERA, Clients
from tests.waiting import wait_for

PROTOCOL = websockets.Subprotocol(f"viser-v{viser.__version__}")


@pytest.mark.parametrize(
    ("origin", "host", "bound", "own"),
    [
        (None, "localhost:8080", "127.0.0.1", True),
        ("http://localhost:8080", "localhost:8080", "127.0.0.1", True),
        ("http://127.0.0.1:8080", "127.0.0.1:8080", "127.0.0.1", True),
        ("http://[::1]:8080", "[::1]:8080", "::1", True),
        ("http://evil.example", "localhost:8080", "127.0.0.1", False),
        ("http://localhost:9999", "localhost:8080", "127.0.0.1", False),
        ("null", "localhost:8080", "127.0.0.1", False),
        ("file://", "localhost:8080", "127.0.0.1", False),
        # A name of someone else's that resolves to this machine.
        ("http://evil.example:8080", "evil.example:8080", "127.0.0.1", False),
        ("http://192.0.2.7:8080", "192.0.2.7:8080", "0.0.0.0", True),
        ("http://192.0.2.7:8080", "192.0.2.7:8080", "127.0.0.1", False),
        ("http://192.0.2.7:8080", "192.0.2.7:8080", "localhost", False),
    ],
)
def test_only_the_page_itself_is_its_own_origin(origin: str | None, host: str, bound: str, own: bool) -> None:
    assert is_own_origin(origin, host, bound) is own


async def say(port: int, messages: list[dict[str, Any]], origin: str | None = None, path: str = "") -> int:
    """Connect as a client of the right version and send messages; how often the server cut the connection.

    It does so at a message that cannot be decoded. The next message then goes out on a new one.
    """
    address = f"ws://127.0.0.1:{port}{path}"
    waiting = list(reversed(messages))
    cuts = 0
    while True:
        async with connect(address, origin=origin, subprotocols=[PROTOCOL], max_size=None, max_queue=None) as client:
            try:
                await client.send(msgspec.msgpack.encode(CAMERA))  # viser counts it, and what it says is judged
                while waiting:
                    await client.send(msgspec.msgpack.encode(waiting[-1]))
                    waiting.pop()
                    await asyncio.sleep(0.001)
                await asyncio.sleep(0.3)
                return cuts
            except websockets.exceptions.ConnectionClosed:
                cuts += 1


def test_the_page_is_served_and_let_in_and_no_other(lab: Viewer) -> None:
    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", lab.port)) as connection:
        connection.request("GET", "/")
        assert connection.getresponse().status == 200
    coroutines.run(say(lab.port, [], f"http://127.0.0.1:{lab.port}"))
    with pytest.raises(websockets.exceptions.InvalidStatus) as refusal:
        coroutines.run(say(lab.port, [], "http://evil.example"))
    assert refusal.value.response.status_code == 403


HOSTILE = [
    math.nan, math.inf, -math.inf, 1e300, -1e300, 3e8, 2**60, -1, 0, True, None, "", "Euler, implicit",
    "__import__('os')", "x" * 5000, [], [math.nan], [1e9], [1, 2, 3], {"a": 1}, b"\x00\xff",
]  # fmt: skip


def hostile_message(rng: random.Random, uuids: list[str]) -> dict[str, Any]:
    vector = [rng.choice(HOSTILE) for _ in range(3)]
    number = [rng.choice([math.nan, math.inf, 1e300, -1e30, 0.0]) for _ in range(4)]
    uuid = rng.choice([*uuids, "no-such-handle"])
    field = rng.choice(["value", "value", "value", "visible", "min", "options", "_order", "__class__"])
    node = rng.choice(["/root_gizmo", "/points", "/rope", "/nowhere"])
    return rng.choice(
        [
            {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {field: rng.choice(HOSTILE)}},
            {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {field: rng.choice(HOSTILE)}},
            {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {field: rng.choice(HOSTILE)}},
            {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {}},
            {"type": "TransformControlsUpdateMessage", "name": node, "wxyz": number, "position": number[:3]},
            {"type": "TransformControlsUpdateMessage", "name": node, "wxyz": [*vector, 0], "position": vector},
            {
                "type": "SceneNodeDragMessage", "phase": rng.choice(["start", "update", "end"]), "name": "/points",
                "instance_index": rng.choice([0, 5, -7, 10**9, None]), "start_position": number[:3],
                "start_screen_pos": number[:2], "end_position": rng.choice([number[:3], [9e5, 0.0, 0.0], [0.1] * 3]),
                "end_screen_pos": number[:2], "button": "left", "modifier": None, "owner": "",
            },
            {"type": "ShareUrlRequest"},
            {"type": "ShareUrlDisconnect"},
            {"type": "RunJavascriptMessage", "source": "alert(1)"},
            {
                "type": "FileTransferStartUpload", "source_component_uuid": uuid, "transfer_uuid": "t",
                "filename": "../../x", "mime_type": "x", "part_count": 1, "size_bytes": 10**12,
            },
            {"type": "CommandTriggerMessage", "uuid": uuid},
        ]
    )  # fmt: skip


@pytest.mark.parametrize("count", [300, pytest.param(2000, marks=pytest.mark.stress)])
def test_hostile_messages_leave_the_server_running_and_the_state_finite(lab: Viewer, count: int) -> None:
    rng = random.Random(2)
    uuids = list(lab.server.gui._gui_input_handle_from_uuid)
    messages = [hostile_message(rng, uuids) for _ in range(count)]
    cuts = coroutines.run(say(lab.port, messages))
    assert cuts < count / 4
    assert sum(lab.message_filter.refused.values()) > count / 6  # what was on its way when a connection was cut is lost
    lab.loop.run.audience = lambda: 1
    ticks = lab.loop.run.counts["ticks"]
    wait_for(lambda: lab.loop.run.counts["ticks"] >= ticks + 30)
    assert np.isfinite(lab.scene.state.x).all() or lab.loop.run.halted
    assert np.isfinite(lab.loop.latest.frame.points).all()
    params = lab.settings.params
    for name, control in lab.panel.controls.items():
        value = getattr(params, name)
        if control.parameter.choices:
            assert value in control.parameter.choices
        elif not isinstance(value, bool):
            assert control.parameter.low <= value <= control.parameter.high, name
    assert lab.server._share_tunnel is None
    assert not any("Share" in kind.__name__ for kind in lab.server._websock_server._incoming_handlers)
    coroutines.run(say(lab.port, [], f"http://127.0.0.1:{lab.port}"))


async def leave_at_once(port: int) -> None:
    """Connect, say a camera just after another, so that it has to wait for its turn, and leave."""
    async with connect(f"ws://127.0.0.1:{port}", subprotocols=[PROTOCOL], max_size=None, max_queue=None) as client:
        for _ in range(2):
            await client.send(msgspec.msgpack.encode(CAMERA))
            await asyncio.sleep(0.05)


def test_a_browser_that_leaves_while_its_camera_waits_is_not_counted(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.server.web.guard.INTAKE_INTERVAL", 0.3)
    before = len(lab.server.get_clients())
    coroutines.run(leave_at_once(lab.port))
    time.sleep(0.5)  # until the turn of the camera would have come
    assert len(lab.server.get_clients()) == before


def test_a_browser_that_connects_while_the_server_starts_is_served(monkeypatch: pytest.MonkeyPatch) -> None:
    """As a page does whose lab is started again: viser listens before its messages are filtered."""
    guarded, clients = guard.guarded, []

    def guarded_late(server: viser.ViserServer) -> guard.MessageFilter:
        clients.append(Clients(server.get_port()))
        clients[0].join()
        return guarded(server)

    monkeypatch.setattr(guard, "guarded", guarded_late)
    server = open_server("127.0.0.1", 0).server
    try:
        wait_for(lambda: len(server.get_clients()) == 1)
        (browser,) = clients[0].open
        received = clients[0].received[browser]
        field = server.gui.add_text("Field", "")
        wait_for(lambda: clients[0].received[browser] > received)
        clients[0].say(browser, {"type": "GuiUpdateMessage", "uuid": uuid_of(field), "updates": {"value": "heard"}})
        wait_for(lambda: field.value == "heard")
    finally:
        clients[0].shut()
        server.stop()


async def follow_a_link_while_somebody_looks(lab: Viewer) -> None:
    """One browser is there, and another sends the link in its address before its first camera."""
    address, sharing = f"ws://127.0.0.1:{lab.port}", lab.panel.share
    link = {
        "type": "GuiUpdateMessage",
        "uuid": uuid_of(sharing.channel.field),
        "updates": {"value": text_of("open", "?scene=rope&points=9")},
    }
    async with (
        connect(address, subprotocols=[PROTOCOL], max_size=None, max_queue=None) as first,
        connect(address, subprotocols=[PROTOCOL], max_size=None, max_queue=None) as second,
    ):
        await first.send(msgspec.msgpack.encode(CAMERA))
        await second.send(msgspec.msgpack.encode(link))
        await asyncio.sleep(0.3)
        assert lab.changes.latest is None
        await second.send(msgspec.msgpack.encode(CAMERA))
        await asyncio.sleep(0.3)


def test_a_link_that_comes_before_its_browser_is_counted_is_shown_to_the_others(lab: Viewer) -> None:
    before = lab.settings.params
    coroutines.run(follow_a_link_while_somebody_looks(lab))
    assert lab.changes.latest is not None
    assert lab.changes.latest.before.params == before


def test_messages_to_one_control_are_merged_and_those_to_the_channel_are_not() -> None:
    handled: list[tuple[str, str]] = []

    async def handle(client: int, message: Any) -> None:
        handled.append((message.uuid, message.updates["value"]))

    async def send() -> None:
        intake = Intake(lambda message: message, [handle], lambda uuid: uuid == "channel")
        intake.counted = True
        for value in ("1", "2", "3"):
            for uuid in ("slider", "channel"):
                intake.queue(1, vm.GuiUpdateMessage(uuid, {"value": value}))
        assert intake.turn is not None
        await intake.turn

    coroutines.run(send())
    assert [value for uuid, value in handled if uuid == "channel"] == ["1", "2", "3"]
    assert [value for uuid, value in handled if uuid == "slider"] == ["3"]


def test_a_callback_that_fails_is_reported_and_loses_no_other_message(capsys: pytest.CaptureFixture) -> None:
    handled: list[str] = []

    async def on_server(client: int, message: Any) -> None:
        if message.uuid == "bad":
            raise ValueError("no such colour")
        handled.append(message.uuid)

    async def on_client(client: int, message: Any) -> None:
        handled.append(f"{message.uuid} of {client}")

    async def send() -> None:
        intake = Intake(lambda message: message, [on_server, on_client])
        intake.counted = True
        for uuid in ("a", "bad", "b", "c"):
            intake.queue(1, vm.GuiUpdateMessage(uuid, {"value": 1.0}))
        assert intake.turn is not None
        await intake.turn

    coroutines.run(send())
    assert handled == ["a", "a of 1", "bad of 1", "b", "b of 1", "c", "c of 1"]
    report = capsys.readouterr().err
    assert report.count("Traceback") == 1
    assert "no such colour" in report


@pytest.mark.parametrize(
    "value",
    [True, None, 0, -1e6, 0.5, "", "text", b"x" * 5000, bytearray(3), memoryview(b"x"), [1, [2.0]], {"k": None}],
)
def test_sane_values_pass(value: Any) -> None:
    assert is_bounded(value)


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e7, [math.nan], {"k": [1, math.inf]}, "x" * 2000, object()])
def test_unbounded_values_are_seen(value: Any) -> None:
    assert not is_bounded(value)


def test_gui_values_of_another_kind_than_their_controls_are_refused(lab: Viewer) -> None:
    controls = lab.panel.controls
    assert allowed_value(controls["gravity"].field, "9.81") == "9.81"  # the control reads it, or says why not
    assert allowed_value(controls["gravity"].field, "9" * 65) is None
    assert allowed_value(controls["gravity"].field, "9\n8") is None
    assert allowed_value(controls["gravity"].field, 9.81) is None
    text = lab.server.gui.add_text("", "", multiline=True)
    assert allowed_value(text, "two\nlines\x07") == "two\nlines\x07"  # the workbook keeps it, or says why not
    assert allowed_value(text, "x" * 100_000) == "x" * MAX_TEXT_LENGTH
    assert allowed_value(text, 1) is None
    assert allowed_value(controls["gravity"].slider, [1e5]) == (1e5,)  # the settings bound it
    assert allowed_value(controls["gravity"].slider, [1.0, 2.0]) is None
    assert allowed_value(controls["gravity"].slider, ["1"]) is None
    assert allowed_value(controls["gravity"].slider, [True]) is None
    assert allowed_value(controls["integrator"].field, "Leapfrog") == "Leapfrog"
    assert allowed_value(controls["integrator"].field, "rk4") is None  # a browser says what its list shows
    assert allowed_value(controls["floor"].field, 1) is None
    assert allowed_value(controls["stiffness"].slider, [math.nan]) is None
    assert allowed_value(controls["stiffness"].slider, [math.inf]) is None


def test_a_busy_port_is_an_error_not_another_port() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(OSError) as refused:  # noqa: PT011 - its words are those of the system
            open_server("127.0.0.1", taken.getsockname()[1])
        assert refused.value.errno in (errno.EADDRINUSE, errno.EACCES)


@pytest.mark.skipif(os.name != "posix", reason="elsewhere a port is free at once")
def test_the_port_of_a_server_that_has_just_ended_is_free() -> None:
    """Its connections stay for a minute, on the side that closed them first."""
    with socket.socket() as server:
        server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as asyncio's servers do
        server.bind(("127.0.0.1", 0))
        server.listen()
        address = server.getsockname()
        with socket.create_connection(address) as client:
            answering, _ = server.accept()
            answering.close()
            assert client.recv(1) == b""
    with socket.socket() as plain, pytest.raises(OSError, match="in use"):
        plain.bind(address)
    check_port(*address)


def test_an_address_of_another_machine_is_an_error_at_once() -> None:
    with pytest.raises(OSError) as refused:  # noqa: PT011 - its words are those of the system
        open_server("192.0.2.1", 0)  # of RFC 5737: nobody has it
    assert refused.value.errno == errno.EADDRNOTAVAIL
