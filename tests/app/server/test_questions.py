"""Questions to visitors before a link of one of them changes the lab for all."""

import asyncio
import contextlib
from collections.abc import AsyncGenerator, Callable
from typing import Any

import msgspec
import viser
import websockets
from websockets.asyncio.client import ClientConnection, connect

from app.panel.questions import LEAVE, LEFT, OPEN
from app.server.viewer import Viewer
from tests import coroutines
from tests.stress.clients import CAMERA

PROTOCOL = websockets.Subprotocol(f"viser-v{viser.__version__}")
MAX_WAIT = 10.0  # [s]


async def until(condition: Callable[[], Any]) -> Any:
    """Wait until something holds, and return it."""
    async with asyncio.timeout(MAX_WAIT):
        while not (found := condition()):
            await asyncio.sleep(0.01)
        return found


class Visitor:
    """A browser without a page."""

    def __init__(self, lab: Viewer, socket: ClientConnection, client: int) -> None:
        self.lab, self.socket, self.client = lab, socket, client
        self.told: list[str] = []
        handle = lab.server.get_clients()[client]
        handle.add_notification = lambda title, body, **how: self.told.append(body)  # type: ignore[method-assign]

    async def send(self, handle: Any, value: str) -> None:
        """Send the value of a control."""
        message = {"type": "GuiUpdateMessage", "uuid": handle._impl.uuid, "updates": {"value": value}}
        await self.socket.send(msgspec.msgpack.encode(message))

    async def ask(self, query: str) -> None:
        """Follow a link, and wait until its question is drawn."""
        lab = self.lab
        await self.send(lab.panel.share.inbox, f"page{self.client}\n{query}")
        await until(lambda: any(f"page{self.client}" in words for words in shown(lab)))

    async def vote(self, words: str, value: str) -> None:
        """Press a button of the question that has these words."""
        drawn = self.lab.panel.share.ballot.drawn.values()
        await self.send(next(buttons for text, buttons in drawn if words in text.content), value)


@contextlib.asynccontextmanager
async def visitor(lab: Viewer) -> AsyncGenerator[Visitor]:
    """A browser that looks at the lab, and reads what it is sent."""
    before = set(lab.server.get_clients())
    address = f"ws://127.0.0.1:{lab.port}"
    async with connect(address, subprotocols=[PROTOCOL], max_size=None, max_queue=None) as socket:
        reading = asyncio.ensure_future(read(socket))
        await socket.send(msgspec.msgpack.encode(CAMERA))
        (client,) = await until(lambda: set(lab.server.get_clients()) - before)
        yield Visitor(lab, socket, client)
        reading.cancel()


async def read(socket: ClientConnection) -> None:
    async for _ in socket:
        pass


def shown(lab: Viewer) -> list[str]:
    """The questions in the panel."""
    return [text.content for text, _ in tuple(lab.panel.share.ballot.drawn.values())]


def test_a_question_goes_with_its_asker(lab: Viewer) -> None:
    async def leave_after_asking() -> None:
        async with visitor(lab):
            async with visitor(lab) as second:
                await second.ask("?scene=rope&preset=Pendulum")
                (words,) = shown(lab)
                assert f'data-springtide-askers="page{second.client}"' in words
                assert "You are about to open <b>Rope</b> (Pendulum) for all 2 browsers." in words
                assert "Another browser asks to open <b>Rope</b> (Pendulum). This changes the lab for all 2" in words
                async with visitor(lab):
                    await until(lambda: "all 3 browsers" in shown(lab)[0])
                await until(lambda: "all 2 browsers" in shown(lab)[0])
            await until(lambda: not shown(lab))
            assert lab.questions.waiting == ()

    coroutines.run(leave_after_asking())


def test_each_question_is_kept_and_answered_by_itself(lab: Viewer) -> None:
    """Also while the scene changes; who asked is told when the lab is left as it is."""

    async def ask_and_vote() -> None:
        async with visitor(lab) as judge, visitor(lab) as first, visitor(lab) as second, visitor(lab) as third:
            await first.ask("?scene=rope&points=9")
            await second.ask("?scene=cloth")
            await third.ask("?scene=rope&points=9")  # the same question
            await until(lambda: len(shown(lab)) == 2)
            await second.ask("?scene=race")  # in place of its first question
            await until(lambda: "Cloth" not in "".join(shown(lab)) and len(shown(lab)) == 2)
            await judge.vote("Race", OPEN)
            await until(lambda: lab.panel.kind.name == "race" and len(shown(lab)) == 1)
            assert second.told == []
            await third.vote("Rope", LEAVE)
            await until(lambda: not shown(lab))
            assert (first.told, third.told) == ([LEFT], [])  # who voted knows it
            assert lab.panel.kind.name == "race"

    coroutines.run(ask_and_vote())


def test_a_vote_counts_for_the_question_that_was_read(lab: Viewer) -> None:
    async def vote_late() -> None:
        async with visitor(lab) as judge, visitor(lab) as first, visitor(lab) as second:
            await first.ask("?scene=rope&points=9")
            ((_, buttons),) = lab.panel.share.ballot.drawn.values()
            await second.ask("?scene=rope&points=11")
            await first.ask("?scene=rope&points=13")
            await until(lambda: len(shown(lab)) == 2)
            await judge.send(buttons, OPEN)  # of the question that is gone
            await judge.vote(f"page{second.client}", OPEN)
            await until(lambda: vars(lab.panel.params)["points"] == 11)
            assert [question.askers[0].client for question in lab.questions.waiting] == [first.client]

    coroutines.run(vote_late())
