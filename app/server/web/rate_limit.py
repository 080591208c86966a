"""Sends a browser no more than its line carries, so that answers to controls do not queue behind pictures.

Of messages waiting for a browser viser keeps only the newest: a picture replaces the one before. But data in the
buffers of the operating system, a tunnel or a proxy can no longer be replaced, and these hold megabytes, seconds of a
slow line. Therefore a ping follows each picture, or one of several if the last pong came at once. Its pong shows when
the picture has arrived, and so the rate of the line. The next picture is sent once the data in flight is at most that
of a round trip, which keeps the line busy, and of `QUEUE` seconds more. A fast line never waits. Meanwhile small
updates of the panel overtake the waiting pictures.

This follows BBR (Cardwell et al. 2016, ACM Queue 14(5)), with pictures for packets.
"""

import asyncio
import collections
import contextvars
import math
import statistics
from collections.abc import AsyncGenerator, Awaitable, Callable, Sequence
from typing import NamedTuple

import viser

from app.render.handles.viser_inside import pass_windows_through
from app.render.handles.viser_types import ViserConnection, ViserMessage
from app.server.web.transport import kind_and_size

SMALL = 8192  # [bytes] below which a message is no picture: it never waits, and no ping follows it
QUEUE = 0.02  # [s] of the line's rate that may queue, beyond the data in flight
MOST = 12  # pictures on the way, however much a line carries: 30 a second where a round trip takes 0.4 s
QUICK = 0.01  # [s] from a picture to its pong, below which not every picture needs a ping
MAX_UNASKED = 4  # pictures in a row without a ping on such a line: each ping costs 0.1 ms
SAMPLES = 5  # of the rate; their median counts: one pong may be late, and the next seem early
PROBE_INTERVAL = 10.0  # [s] between two round trips that are measured while nothing else is on the way
PROBES = 3  # the shortest counts
PATIENCE = 1.0  # [s] beyond four times its expected time, after which a pong is given up
FIRST_PATIENCE = 10.0  # [s] the same while the rate is unknown


class Sent(NamedTuple):
    """A picture on the way."""

    size: int  # [bytes]
    start: float  # [s] when it was sent
    pong: "asyncio.Future[float]"


async def nothing(size: int) -> None:
    """Nothing is announced."""


class RateLimit:
    """The limit of one browser's messages, on the event loop of its connection."""

    def __init__(self, connection: ViserConnection) -> None:
        self.connection = connection
        self.send_now = connection.send
        self.loop = asyncio.get_running_loop()
        self.clock = self.loop.time
        self.turn = asyncio.Lock()  # pictures are sent one after the other: viser sends from two tasks
        self.on_the_way: collections.deque[Sent] = collections.deque()
        self.bytes_on_the_way = 0
        self.rates: collections.deque[float] = collections.deque(maxlen=SAMPLES)  # [bytes/s]
        self.rate = 0.0  # [bytes/s] that the line carries; 0 while that is not known
        self.probes: collections.deque[float] = collections.deque(maxlen=PROBES)  # [s]
        self.round_trip = 0.0  # [s] of a message with nothing in front of it; 0 while that is not known
        self.probe_at = -math.inf  # [s] when the round trip is measured next
        self.last_pong = -math.inf  # [s] when it came
        self.is_quick = False  # True if it came within QUICK
        self.announce: Callable[[int], Awaitable[None]] = nothing  # called before a picture, with its bytes
        self.unasked = 0  # pictures since the last ping

    async def send(self, data: bytes) -> None:
        """Send a message, a picture once there is room for it. Raises ConnectionClosed if the browser has left."""
        if len(data) < SMALL:
            await self.send_now(data)
            return
        async with self.turn:
            await self.room()
            await self.announce(len(data))
            start = self.clock()
            await self.send_now(data)
            if self.is_quick and not self.on_the_way and self.unasked < MAX_UNASKED:
                self.unasked += 1
                return
            self.unasked = 0
            sent = Sent(len(data), start, asyncio.ensure_future(await self.connection.ping()))
            self.on_the_way.append(sent)
            self.bytes_on_the_way += sent.size
            sent.pong.add_done_callback(lambda _: self.learn(sent))

    @property
    def has_room(self) -> bool:
        """True if a picture would be sent at once."""
        bound = self.rate * (self.round_trip + QUEUE)
        return self.clock() < self.probe_at and self.bytes_on_the_way <= bound and len(self.on_the_way) < MOST

    async def room(self) -> None:
        """Wait until there is room for a picture; a late pong is given up."""
        while not self.has_room:
            if not self.on_the_way:
                await self.probe()
                continue
            done, _ = await asyncio.wait([self.on_the_way[0].pong], timeout=self.patience)
            if not done:
                self.on_the_way.clear()
                self.bytes_on_the_way = 0

    @property
    def patience(self) -> float:
        """Time [s] to wait for a pong."""
        if not self.rate:
            return FIRST_PATIENCE
        return PATIENCE + 4.0 * (self.round_trip + self.bytes_on_the_way / self.rate)

    async def probe(self) -> None:
        """Measure the round trip while nothing is on the way."""
        start = self.clock()
        pong = asyncio.ensure_future(await self.connection.ping())
        await asyncio.wait([pong], timeout=self.patience)
        if has_come(pong):
            self.probes.append(self.clock() - start)
            self.round_trip = min(self.probes)
        self.probe_at = self.clock() + PROBE_INTERVAL

    def learn(self, sent: Sent) -> None:
        """Note that a picture has arrived, or the browser has left."""
        if sent in self.on_the_way:
            self.on_the_way.remove(sent)
            self.bytes_on_the_way -= sent.size
        if has_come(sent.pong):
            now = self.clock()
            # It came to the line a round trip before its pong, at the earliest when the picture before was through.
            began = max(self.last_pong, sent.start + self.round_trip)
            self.rates.append(sent.size / max(now - began, 1e-3))
            self.rate = statistics.median(self.rates)
            self.last_pong, self.is_quick = now, now - sent.start < QUICK

    def room_from(self, loop: asyncio.AbstractEventLoop) -> "asyncio.Future[None]":
        """`room`, to be waited for on this loop: a pane has one of its own."""
        if loop is self.loop:
            return asyncio.ensure_future(self.room())
        return asyncio.wrap_future(asyncio.run_coroutine_threadsafe(self.room(), self.loop))


def has_come(pong: "asyncio.Future[float]") -> bool:
    """True if a pong has arrived; otherwise it is pending, or the browser has left."""
    return pong.done() and not pong.cancelled() and pong.exception() is None


LIMIT: contextvars.ContextVar[RateLimit] = contextvars.ContextVar("limit")  # of the connection that a task serves
Window = Sequence[ViserMessage]
Windows = AsyncGenerator[Window, None]


def put_small_first(server: viser.ViserServer) -> None:
    """Delay messages to a server's browsers until their line has capacity; small panel updates go ahead."""
    pass_windows_through(server, lambda windows: small_first(windows, LIMIT.get()))


async def small_first(windows: Windows, limit: RateLimit) -> Windows:
    """The same messages; if there is no room only small updates of the panel, and later the newest of the others."""
    loop = asyncio.get_running_loop()
    held: dict[str, ViserMessage] = {}  # waiting messages, in order, by the key of the message that supersedes them
    more: asyncio.Future[Window] | None = None
    room: asyncio.Future[None] | None = None
    try:
        while True:
            if held:
                more = more or asyncio.ensure_future(anext(windows))
                room = room or limit.room_from(loop)
                await asyncio.wait([more, room], return_when=asyncio.FIRST_COMPLETED)
                if room.done():
                    room.result()
                    room, window = None, list(held.values())
                    held.clear()
                    yield window
                    continue
            try:
                window, more = await (more or anext(windows)), None
            except StopAsyncIteration:
                return
            if limit.has_room and not held:
                yield window
            elif ahead := hold(held, window):
                yield ahead
    finally:
        for future in (more, room):
            if future is not None:
                future.cancel()
                await asyncio.gather(future, return_exceptions=True)
        await windows.aclose()


def hold(held: dict[str, ViserMessage], window: Window) -> list[ViserMessage]:
    """Add a window to the waiting messages; returns those that may go ahead: none while a creation or removal waits."""
    ahead: list[ViserMessage] = []
    for message in window:
        key = message.redundancy_key()
        held.pop(key, None)
        if is_small(message) and all(is_update(other) for other in held.values()):
            ahead.append(message)
        else:
            held[key] = message
    return ahead


def is_small(message: ViserMessage) -> bool:
    """True if this is an update of something in the panel that is small enough to go ahead."""
    if type(message).__name__ != "GuiUpdateMessage":
        return False
    kinds_and_sizes = [kind_and_size(value) for value in message.updates.values()]
    return sum(size for _, size in filter(None, kinds_and_sizes)) < SMALL


def is_update(message: ViserMessage) -> bool:
    """True if this changes something that is there already."""
    return message.lifecycle_phase in ("update_dict", "update_simple")
