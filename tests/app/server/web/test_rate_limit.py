"""How much is on the way to a browser: what waits in front of a slow line is counted, on a clock that does not wait."""

import asyncio
import random
import selectors
import time
from collections.abc import AsyncGenerator, Coroutine, Sequence
from typing import Any

import numpy as np
import pytest
import viser
import websockets
from viser import _messages as vm
from viser.infra._async_message_buffer import AsyncMessageBuffer
from websockets.asyncio.client import connect

from app.server.web.guard import open_server
from app.server.web.rate_limit import MAX_UNASKED, MOST, PATIENCE, PROBE_INTERVAL, QUEUE, SMALL, RateLimit, small_first
from tests import coroutines
from tests.app.server.web.test_transport import decoded

PICTURE = b"p" * 97_000
LINE, ROUND_TRIP = 2.5e6, 0.08  # [bytes/s] and [s] of the line that has to do
INTERVAL = 1 / 27  # [s] between two pictures of a sea


class Hurried(asyncio.SelectorEventLoop):
    """An event loop whose clock jumps to the next moment at which there is something to do."""

    def __init__(self) -> None:
        self.now = 0.0
        super().__init__(Jump(self))

    def time(self) -> float:
        return self.now


class Jump(selectors.SelectSelector):
    """Waits for nothing: the clock continues instead."""

    def __init__(self, loop: Hurried) -> None:
        super().__init__()
        self.loop = loop

    def select(self, timeout: float | None = None) -> Any:
        self.loop.now += timeout or 0.0
        return super().select(0.0)


def hurried(work: Coroutine[Any, Any, Any]) -> Any:
    """Run a coroutine on a clock of its own."""
    return coroutines.run(work, Hurried)


class LineTo:
    """A browser behind a line of `rate` [bytes/s] and a round trip [s], which takes in whatever is sent."""

    def __init__(self, rate: float, round_trip: float, pongs: int = 1_000_000) -> None:
        self.rate, self.round_trip, self.pongs = rate, round_trip, pongs
        self.free = 0.0  # [s] when the line has sent all
        self.waiting: list[float] = []  # [bytes] in front of the line when a picture came
        self.sent: list[float] = []  # [s] when each picture was sent

    async def send(self, data: bytes) -> None:
        now = asyncio.get_running_loop().time()
        if len(data) >= SMALL:
            self.waiting.append(max(0.0, self.free - now) * self.rate)
            self.sent.append(now)
        self.free = max(now, self.free) + len(data) / self.rate

    async def ping(self) -> "asyncio.Future[float]":
        loop = asyncio.get_running_loop()
        pong: asyncio.Future[float] = loop.create_future()
        self.pongs -= 1
        if self.pongs >= 0:
            loop.call_at(max(loop.time(), self.free) + self.round_trip, lambda: pong.done() or pong.set_result(0.0))
        return pong


def pictures_over(line: LineTo, count: int, interval: float) -> list[float]:
    """How long each of `count` pictures waits [s], made so long [s] after the one before was sent."""

    async def send_all() -> list[float]:
        loop, waits, connection = asyncio.get_running_loop(), [], RateLimit(line)
        for _ in range(count):
            await asyncio.sleep(interval)
            start = loop.time()
            await connection.send(PICTURE)
            waits.append(loop.time() - start)
        return waits

    return hurried(send_all())


def test_pictures_do_not_queue_up_before_a_slow_line() -> None:
    line = LineTo(LINE, ROUND_TRIP)
    pictures_over(line, 400, 0.0)
    assert max(line.waiting) <= LINE * (ROUND_TRIP + QUEUE)  # at most, in the first round trip and after each probe
    assert np.mean(np.array(line.waiting) < 0.1 * len(PICTURE)) > 0.9  # else none waits
    assert len(line.sent) * len(PICTURE) > 0.93 * LINE * line.sent[-1]  # and the line is busy


def test_a_picture_waits_for_a_very_slow_line() -> None:
    line = LineTo(0.1 * LINE, ROUND_TRIP)
    pictures_over(line, 30, 0.0)
    assert max(line.waiting) == 0.0


@pytest.mark.parametrize("round_trip", [0.0005, 0.3])
def test_a_fast_line_is_not_waited_for(round_trip: float) -> None:
    waits = pictures_over(LineTo(1e8, round_trip), 200, INTERVAL)
    first = round(2.0 * (round_trip + INTERVAL) / INTERVAL) + 1  # until round trip and rate are known
    probes = int(200 * INTERVAL / PROBE_INTERVAL)
    assert sum(wait > 1e-9 for wait in waits[first:]) <= probes * (1 + round_trip / INTERVAL)


def test_pongs_that_do_not_come_stop_nothing() -> None:
    line = LineTo(LINE, ROUND_TRIP, pongs=20)
    pictures_over(line, 40, INTERVAL)
    assert len(line.sent) == 40
    assert max(np.diff(line.sent)) < 4.0 * PATIENCE  # a picture, and a probe


def test_the_round_trip_is_the_shortest_of_the_last() -> None:
    """A longer one includes time in a queue."""
    line = LineTo(LINE, 0.3)

    async def probe() -> list[float]:
        connection, found = RateLimit(line), []
        for line.round_trip in (0.3, 0.08, 0.2):
            await connection.probe()
            found.append(connection.round_trip)
        return found

    assert hurried(probe()) == pytest.approx([0.3, 0.08, 0.08], abs=1e-3)


def test_the_rate_follows_the_line() -> None:
    line = LineTo(LINE, ROUND_TRIP)

    async def send_all() -> None:
        connection = RateLimit(line)
        for number in range(60):
            line.rate = LINE if number < 20 else 0.25 * LINE
            await connection.send(PICTURE)

    hurried(send_all())
    assert max(line.waiting[-30:]) < len(PICTURE)


def test_a_quick_line_is_asked_about_some_pictures_and_about_all_once_it_is_slow() -> None:
    line = LineTo(1e9, 0.001, pongs=1000)

    async def send_all() -> tuple[int, int]:
        connection, asked = RateLimit(line), []
        for number in range(200):
            await asyncio.sleep(INTERVAL)
            if number == 100:
                asked.append(1000 - line.pongs)
                line.rate, line.round_trip = 0.25 * LINE, ROUND_TRIP
            await connection.send(PICTURE)
        return asked[0], 1000 - line.pongs - asked[0]

    quick, slow = hurried(send_all())
    assert quick <= 100 / (1 + MAX_UNASKED) + 3
    assert slow > 90
    assert max(line.waiting) <= (MOST + MAX_UNASKED) * len(PICTURE)
    assert max(line.waiting[-80:]) < len(PICTURE)


def test_small_messages_do_not_wait() -> None:
    line = LineTo(0.1 * LINE, ROUND_TRIP)

    async def send_all() -> float:
        loop, connection = asyncio.get_running_loop(), RateLimit(line)
        await connection.send(PICTURE)
        waiting = asyncio.ensure_future(connection.send(PICTURE))
        await asyncio.sleep(0.0)
        start = loop.time()
        await connection.send(b"s" * (SMALL - 1))
        assert not waiting.done()
        await waiting
        return loop.time() - start

    assert hurried(send_all()) > 0.0


def test_a_browser_that_leaves_ends_the_wait() -> None:
    class Leaving(LineTo):
        async def ping(self) -> "asyncio.Future[float]":
            pong = await super().ping()
            if self.sent:
                asyncio.get_running_loop().call_soon(pong.cancel)
            return pong

    waits = pictures_over(Leaving(LINE, ROUND_TRIP), 3, 0.0)
    assert sum(waits) < PATIENCE


def picture(node: str, number: int) -> vm.Message:
    return vm.SceneNodeUpdateMessage(node, {"vertices": np.full((10, 3), number, np.float32)})


def panel(uuid: str, value: object) -> vm.Message:
    return vm.GuiUpdateMessage(uuid, {"value": value})


def passed(windows: Sequence[Sequence[vm.Message]]) -> list[list[vm.Message]]:
    """What `small_first` makes of windows that come while a picture is on the way, and of what waits in the end."""

    async def pass_all() -> list[list[vm.Message]]:
        line = LineTo(LINE, ROUND_TRIP)
        connection = RateLimit(line)
        await connection.send(PICTURE)

        async def come() -> AsyncGenerator[Sequence[vm.Message]]:
            for window in windows:
                yield window
            await asyncio.sleep(1.0)

        return [list(window) async for window in small_first(come(), connection)]

    return hurried(pass_all())


def test_small_updates_of_the_panel_go_ahead_of_the_newest_picture() -> None:
    old, new, other = picture("/sea", 1), picture("/sea", 2), picture("/box", 1)
    first, second, chart = panel("a", 1.0), panel("b", 2.0), panel("c", "x" * SMALL)
    assert passed([[old, first], [other, chart, new, second]]) == [[first], [second], [other, chart, new]]


def test_an_update_that_waits_does_not_follow_a_newer_one() -> None:
    assert passed([[panel("a", "x" * SMALL)], [picture("/sea", 1), panel("a", "new")]])[0] == [panel("a", "new")]
    assert len(passed([[panel("a", "x" * SMALL)], [panel("a", "new")]])) == 1


def test_nothing_goes_ahead_of_what_is_made_or_removed() -> None:
    windows = [[vm.RemoveSceneNodeMessage("/box")], [picture("/sea", 1), panel("a", 1.0)]]
    assert passed(windows) == [[windows[0][0], *windows[1]]]


class Unsteady(LineTo):
    """A line that loses some pongs, delays others, and now and then carries much less."""

    def __init__(self, chance: random.Random) -> None:
        super().__init__(LINE, ROUND_TRIP)
        self.chance = chance

    async def ping(self) -> "asyncio.Future[float]":
        self.rate = LINE * 10.0 ** -self.chance.choice([0.0, 0.0, 0.0, 1.0, 2.0])
        self.round_trip = self.chance.choice([0.001, ROUND_TRIP, ROUND_TRIP, 5.0])
        self.pongs = int(self.chance.random() > 0.2)
        return await super().ping()


State = dict[str, dict[str, Any]]


def apply(state: State, messages: Sequence[vm.Message]) -> None:
    """Change elements of the panel and nodes as a page does."""
    for message in messages:
        match message:
            case vm.GuiHtmlMessage(uuid=name) | vm.FrameMessage(name=name):
                state[name] = {}
            case vm.GuiUpdateMessage(uuid=name) | vm.SceneNodeUpdateMessage(name=name):
                state.get(name, {}).update(message.updates)
            case vm.GuiRemoveMessage(uuid=name) | vm.RemoveSceneNodeMessage(name=name):
                state.pop(name, None)
            case _:
                raise AssertionError(message)


def changes(chance: random.Random, state: State, count: int) -> vm.Message:
    """A change of a page in this state. The names of nodes come again, those of elements do not."""
    node = f"/node{chance.randrange(4)}"
    elements = [name for name in state if name[0] != "/"]
    match chance.randrange(9):
        case 0:
            return vm.GuiHtmlMessage(f"html{count}", "root", vm.GuiHtmlProps(0.0, "", True))
        case 1 if len(elements) > 2:
            return vm.GuiRemoveMessage(chance.choice(elements))
        case 2 if node in state:
            return vm.RemoveSceneNodeMessage(node)
        case 3 | 4 | 5 if elements:
            return panel(chance.choice(elements), str(count) * chance.choice([1, 1, SMALL]))
        case _ if node in state:
            return vm.SceneNodeUpdateMessage(node, {"text": str(count) * chance.choice([1, SMALL, 5 * SMALL])})
        case _:
            return vm.FrameMessage(node, vm.FrameProps(False, 0.1, 0.1, 0.1, (0, 0, 0), 1.0))


@pytest.mark.parametrize("seed", range(8))
def test_each_change_reaches_a_browser_on_any_line_and_one_that_comes_again(seed: int) -> None:
    chance = random.Random(seed)

    async def show(buffer: AsyncMessageBuffer, number: int, page: State) -> None:
        line = Unsteady(chance)
        connection = RateLimit(line)
        async for window in small_first(buffer.window_generator(number), connection):
            await connection.send(bytes(sum(len(str(getattr(message, "updates", ""))) for message in window)))
            apply(page, window)

    async def change() -> None:
        loop = asyncio.get_running_loop()
        buffer = AsyncMessageBuffer(loop, persistent_messages=True, window_duration_sec=0.0)
        wanted: State = {}
        pages: list[State] = []
        tasks: list[asyncio.Task[None]] = []
        for count in range(400):
            if count % 100 == 0:
                for task in tasks[-1:]:
                    task.cancel()
                pages.append({})
                tasks.append(loop.create_task(show(buffer, len(pages), pages[-1])))
            message = changes(chance, wanted, count)
            apply(wanted, [message])
            buffer.push(message)
            await asyncio.sleep(chance.choice([0.0, 0.0, 0.001, 0.03, 0.3]))
        end = loop.time() + 120.0
        while pages[-1] != wanted and loop.time() < end:
            await asyncio.sleep(0.1)
        ended = [task for task in tasks if task.done() and not task.cancelled()]
        assert not ended
        assert pages[-1] == wanted
        tasks[-1].cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    hurried(change())


def test_what_a_browser_is_sent_before_it_answers_is_bounded() -> None:
    """A browser that takes nothing for a while: then it gets the panel first, and of 40 pictures few."""
    server = open_server("127.0.0.1", 0).server

    async def visit() -> list[dict[str, Any]]:
        protocol = websockets.Subprotocol(f"viser-v{viser.__version__}")
        address = f"ws://127.0.0.1:{server.get_port()}"
        seen: list[dict[str, Any]] = []
        async with connect(address, subprotocols=[protocol], max_size=None, max_queue=None) as client:
            mesh = server.scene.add_mesh_simple("/sea", np.zeros((9000, 3), np.float32), np.array([[0, 1, 2]]))
            field = server.gui.add_text("Field", "")
            await until_told(client, seen, "Field")
            client.transport.pause_reading()
            for number in range(40):
                mesh.vertices = np.full((9000, 3), number, np.float32)
                await asyncio.sleep(0.01)
            field.value = "told"
            await asyncio.sleep(0.05)
            client.transport.resume_reading()
            seen.clear()
            await until_told(client, seen, "told")
            return seen

    try:
        seen = coroutines.run(visit())
    finally:
        server.stop()
    assert sum("vertices" in message.get("updates", {}) for message in seen) <= MOST + MAX_UNASKED


async def until_told(client: Any, seen: list[dict[str, Any]], text: str) -> None:
    """Read until a message holds this text."""
    end = time.monotonic() + 30.0
    while time.monotonic() < end:
        messages = decoded(bytes(await client.recv()))
        seen.extend(messages)
        if any(text in str(message) for message in messages):
            return
