"""A slow line between a browser and the lab: every byte is late, and so many go through in a second."""

import asyncio
import contextlib
import socket
import threading
from collections.abc import Iterator

CHUNK = 4096  # [bytes] that travel as one
WINDOW = 32768  # [bytes] that the operating system keeps at the lab's end of the line, at least


class Line:
    """A port that leads to the lab over a line, on an event loop of its own, in a thread."""

    def __init__(self, port: int, rate: float, delay: float, buffer: int) -> None:
        """rate: [bytes/s] each way. delay: [s] each way. buffer: [bytes] that may wait in a router before the line."""
        self.lab, self.rate, self.delay, self.buffer = port, rate, delay, buffer
        self.port = 0
        self.cut_until = 0.0  # [s] of the clock of the event loop
        self.writers: list[asyncio.StreamWriter] = []
        self.dead: set[asyncio.StreamWriter] = set()  # ends of connections that stay open and pass nothing on
        self.is_dead = False  # True if that holds for new connections too
        self.ready = threading.Event()
        self.thread = threading.Thread(target=lambda: asyncio.run(self.serve()), daemon=True)

    async def serve(self) -> None:
        """Serve until `stop` is set; asyncio ends what is then left of the connections."""
        self.loop, self.stop = asyncio.get_running_loop(), asyncio.Event()
        server = await asyncio.start_server(self.join, "127.0.0.1", 0)
        self.port = server.sockets[0].getsockname()[1]
        self.ready.set()
        await self.stop.wait()
        server.close()

    async def join(self, here: asyncio.StreamReader, back: asyncio.StreamWriter) -> None:
        """One connection, until all that both ends sent has arrived."""
        if self.loop.time() < self.cut_until:
            return back.transport.abort()
        end = socket.socket()
        end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, WINDOW)
        end.setblocking(False)
        await self.loop.sock_connect(end, ("127.0.0.1", self.lab))
        there, on = await asyncio.open_connection(sock=end, limit=CHUNK)
        self.writers += [back, on]
        if self.is_dead:
            self.dead |= {back, on}
        to_browser = asyncio.ensure_future(self.carry(there, back))
        to_lab = asyncio.ensure_future(self.carry(here, on))
        try:
            with contextlib.suppress(OSError):
                await to_browser
        finally:
            to_lab.cancel()
            back.close()
            on.close()

    def cut(self, seconds: float = 0.0) -> None:
        """Cut all connections, as where a laptop changes its network; new ones are let through after this time."""

        def abort() -> None:
            self.cut_until = self.loop.time() + seconds
            for writer in self.writers:
                writer.transport.abort()
            self.writers.clear()

        self.loop.call_soon_threadsafe(abort)

    def fall_silent(self, *, wholly: bool = False) -> None:
        """Pass nothing on over the open connections, and close none, as a router that has forgotten them.

        wholly: over new connections neither, until `come_back`.
        """

        def stop() -> None:
            self.dead |= set(self.writers)
            self.is_dead = wholly

        self.loop.call_soon_threadsafe(stop)

    def come_back(self) -> None:
        """Pass new connections on; those that are dead stay so."""
        self.loop.call_soon_threadsafe(lambda: setattr(self, "is_dead", False))

    async def carry(self, source: asyncio.StreamReader, target: asyncio.StreamWriter) -> None:
        """One way: what comes waits in the router until the line is free, and arrives `delay` later."""
        free = self.loop.time()  # [s] when the line has sent all that came so far
        waiting: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()
        delivery = asyncio.ensure_future(self.deliver(waiting, target))
        try:
            with contextlib.suppress(ConnectionError):  # a reset is an end, too
                while part := await source.read(CHUNK):
                    free = max(free, self.loop.time()) + len(part) / self.rate
                    waiting.put_nowait((free + self.delay, part))
                    # The router takes more once this is all that waits in it.
                    await asyncio.sleep(max(0.0, free - self.buffer / self.rate - self.loop.time()))
            waiting.put_nowait((free + self.delay, b""))
            await delivery  # until all has arrived
        finally:
            delivery.cancel()

    async def deliver(self, waiting: "asyncio.Queue[tuple[float, bytes]]", target: asyncio.StreamWriter) -> None:
        """Hand over what has arrived, and the end of it."""
        while True:
            arrival, part = await waiting.get()
            await asyncio.sleep(max(0.0, arrival - self.loop.time()))
            if target.is_closing():
                return
            if target not in self.dead:
                if part:
                    target.write(part)
                else:
                    target.write_eof()
            if not part:
                return


@contextlib.contextmanager
def slow_line(port: int, rate: float, delay: float, buffer: int = 65536) -> Iterator[Line]:
    """See `Line`."""
    line = Line(port, rate, delay, buffer)
    line.thread.start()
    line.ready.wait(10.0)
    try:
        yield line
    finally:
        line.loop.call_soon_threadsafe(line.stop.set)
        line.thread.join(10.0)
