"""A page hears the lab on the connection that carries the pictures, and its earlier connection ends."""

import asyncio
import contextlib
import http.client
import itertools
import math
from collections.abc import AsyncGenerator
from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser
import websockets
from websockets.asyncio.client import ClientConnection, connect

from app.messages import Pause
from app.render.handles import viser_inside
from app.server.viewer import Viewer
from app.server.web.beat import BEAT, BEAT_INTERVAL, LARGE, MAX_SILENCE, expected_silence
from app.server.web.guard import MAX_REPORTED, RefusedPages, open_server
from app.server.web.rate_limit import RateLimit
from tests import coroutines
from tests.app.server.web.test_transport import unpacked

PROTOCOL = websockets.Subprotocol(f"viser-v{viser.__version__}")


@contextlib.asynccontextmanager
async def page(port: int, path: str) -> AsyncGenerator[ClientConnection]:
    """A connection as a page has it."""
    async with connect(f"ws://127.0.0.1:{port}{path}", subprotocols=[PROTOCOL], max_size=None) as client:
        yield client


async def beat_times(client: ClientConnection, count: int) -> list[float]:
    """Times [s] at which the lab sent so many beats, from now on."""
    times: list[float] = []
    while len(times) < count:
        sent = unpacked(bytes(cast(bytes, await client.recv())))
        found = sent["messages"]
        if found and found[0]["type"] == BEAT:
            assert len(found) == 1
            if found[0]["wait"] > 0.0:
                continue  # it announces the large messages of the beginning
            times.append(sent["timestampSec"])
    return times


def test_a_paused_lab_and_its_pane_send_beats_at_regular_intervals() -> None:
    viewer = Viewer("127.0.0.1", 0)
    pane = viewer.make_pane(2)
    try:
        viewer.open("rope")
        viewer.loop.commands.put(Pause())

        async def both() -> list[list[float]]:
            async with page(viewer.port, "/?page=a") as first, page(viewer.port, "/pane/2/?page=b") as second:
                return list(await asyncio.gather(beat_times(first, 3), beat_times(second, 3)))

        for times in coroutines.run(both()):
            for before, after in itertools.pairwise(times):
                assert 0.5 * BEAT_INTERVAL < after - before < 3.0 * BEAT_INTERVAL
    finally:
        pane.shut()
        viewer.shut()


def test_a_page_that_connects_again_ends_its_own_earlier_connection_only() -> None:
    server = open_server("127.0.0.1", 0).server

    async def visit() -> tuple[bool, bool]:
        port = server.get_port()
        async with contextlib.AsyncExitStack() as stack:
            paths = ("/?page=a", "/?page=b", "/", "/?page=a", "/")
            first, other, nameless, second, also_nameless = [
                await stack.enter_async_context(page(port, path)) for path in paths
            ]
            await beat_times(second, 1)
            await beat_times(also_nameless, 1)
            with pytest.raises(websockets.exceptions.ConnectionClosed):
                await beat_times(first, 3)
            await beat_times(other, 2)
            await beat_times(nameless, 2)
            return first.close_code is not None, other.close_code is None

    try:
        assert coroutines.run(visit()) == (True, True)
    finally:
        server.stop()


def limit_with(rate: float, on_the_way: int) -> RateLimit:
    """A limit as far as it is asked here."""
    return cast(RateLimit, SimpleNamespace(rate=rate, bytes_on_the_way=on_the_way))


@pytest.mark.parametrize(
    ("rate", "on_the_way", "size", "expected"),
    [
        (0.0, 0, LARGE - 1, 0.0),
        (0.0, 0, LARGE, 5.0),
        (0.0, 0, 10**8, MAX_SILENCE),
        (1e6, 0, 100_000, 0.0),
        (1e5, 200_000, 300_000, 20.0),
        (1e3, 0, 10**6, MAX_SILENCE),
    ],
)
def test_a_message_that_takes_long_is_announced(rate: float, on_the_way: int, size: int, expected: float) -> None:
    assert math.isclose(expected_silence(limit_with(rate, on_the_way), size), expected)


def test_without_the_form_of_viser_there_is_no_beat_and_the_lab_says_what_is_lost(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(viser_inside, "messages", None)
    monkeypatch.setattr(viser_inside, "LOST", {})
    assert viser_inside.message_frame([]) == b""
    assert "a dead connection is not noticed" in capsys.readouterr().err


def answer(port: int, path: str, **headers: str) -> tuple[int, str]:
    """Status and text of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", port)
    connection.request("GET", path, headers=headers)
    found = connection.getresponse()
    return found.status, found.read().decode()


ORIGIN = "http://lab.example.org:8400"


def test_a_refused_page_reads_the_option_that_would_allow_it_and_so_does_the_terminal(
    capsys: pytest.CaptureFixture[str],
) -> None:
    server = open_server("127.0.0.1", 0).server
    try:
        port = server.get_port()
        own = f"http://127.0.0.1:{port}"
        assert len(answer(port, f"/springtide-alive?origin={own}")[1].splitlines()) == 1
        status, text = answer(port, f"/springtide-alive?origin={ORIGIN}")
        assert (status, len(text.splitlines())) == (200, 2)
        assert text.endswith(f"start the lab with --allowed-origin {ORIGIN}")
        assert capsys.readouterr().err == ""  # a question is no attempt to connect

        async def attempt(origin: str) -> None:
            with pytest.raises(websockets.exceptions.InvalidStatus):
                async with connect(f"ws://127.0.0.1:{port}/", origin=cast(Any, origin), subprotocols=[PROTOCOL]):
                    pass

        for origin in (ORIGIN, ORIGIN, "null"):
            coroutines.run(attempt(origin))
        said = capsys.readouterr().err.splitlines()
        assert [line for line in said if ORIGIN in line] == [
            f"springtide: refused a page at {ORIGIN}. If it is yours, start the lab with --allowed-origin {ORIGIN}"
        ]
    finally:
        server.stop()


def test_the_terminal_names_only_a_few_refused_addresses(capsys: pytest.CaptureFixture[str]) -> None:
    refusals = RefusedPages()
    refusals.report("http://a.example/\x1b[31m")
    assert capsys.readouterr().err == ""
    for k in range(3 * MAX_REPORTED):
        refusals.report(f"http://page{k}.example")
    assert len(capsys.readouterr().err.splitlines()) == MAX_REPORTED
