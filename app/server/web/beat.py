"""A beat on each connection to a browser, over the path that carries the pictures.

A connection may end without being closed: a laptop sleeps, changes its network, or a router forgets it. The browser
then waits without end, and other requests of its page are answered. So the lab sends a beat at regular intervals, and a
page that hears nothing connects again (`app/render/js/page/line.js`). The lab in turn ends the earlier connection of a
page that connects again.

A message arrives as a whole: while a large one is on its way, nothing else comes. The beat before it says how long
that may take.
"""

import asyncio
import contextlib
import contextvars
import weakref
from collections.abc import AsyncGenerator
from urllib.parse import parse_qs, urlsplit

import websockets.exceptions

from app.render.handles.viser_inside import message_frame
from app.render.handles.viser_types import ViserConnection
from app.server.web.rate_limit import RateLimit

BEAT = "SpringtideBeat"  # type of the message, which `js/before/connection.js` takes out
BEAT_INTERVAL = 2.0  # [s]
PAGE_NAME = "page"  # name of the page, in the query of a connection
PAGE: contextvars.ContextVar[str] = contextvars.ContextVar("page")  # on a connection; "" for programs
SMALLEST_RATE = 20e3  # [bytes/s] of a line whose rate is not known
LARGE = 100_000  # [bytes] of a message on such a line, from which it is announced
MAX_SILENCE = 60.0  # [s] announced


def beat(wait: float = 0.0) -> bytes:
    """A beat as viser's client reads messages; empty if viser has changed. wait: [s] without another message."""
    return message_frame([{"type": BEAT, "wait": wait}])


def expected_silence(limit: RateLimit, size: int) -> float:
    """Time [s] for which a message of `size` [bytes] may keep others back, 0 if that is not noticed."""
    if not limit.rate:
        return min(size / SMALLEST_RATE, MAX_SILENCE) if size >= LARGE else 0.0
    expected = (limit.bytes_on_the_way + size) / limit.rate
    return min(4.0 * expected, MAX_SILENCE) if expected > BEAT_INTERVAL else 0.0


class Beats:
    """The beats of a server's connections."""

    def __init__(self) -> None:
        self.pages: weakref.WeakValueDictionary[str, ViserConnection] = weakref.WeakValueDictionary()

    def take_over(self, connection: ViserConnection) -> None:
        """End the earlier connection of the page that connects, which nobody reads any more."""
        name = parse_qs(urlsplit(str(connection.request.path)).query).get(PAGE_NAME, [""])[0]
        PAGE.set(name)
        earlier = self.pages.get(name)
        if name:
            self.pages[name] = connection
        if earlier is not None:
            earlier.transport.abort()

    @contextlib.asynccontextmanager
    async def on(self, connection: ViserConnection, limit: RateLimit) -> AsyncGenerator[None]:
        """Context in which beats are sent on a connection, one at its beginning."""
        self.take_over(connection)

        async def announce(size: int) -> None:
            if wait := expected_silence(limit, size):
                await limit.send_now(beat(wait))

        async def send_all() -> None:
            with contextlib.suppress(websockets.exceptions.ConnectionClosed):
                while True:
                    await limit.send_now(beat())
                    await asyncio.sleep(BEAT_INTERVAL)

        if not beat():
            yield
            return
        limit.announce = announce
        task = asyncio.create_task(send_all())
        try:
            yield
        finally:
            task.cancel()
