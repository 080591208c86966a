"""Access control: which pages may connect, and which messages pass.

viser checks neither the Origin of a websocket nor any value that arrives on it, so any page in the user's browser could
drive a loopback server, and any client could set a slider out of its range or open the public share tunnel. Everything
from a browser passes `MessageFilter`: a short list of message types, only finite bounded numbers, and GUI values of the
kind of their control. Their range is decided where they are used. If viser has changed so that this is not possible,
only loopback addresses are served.
"""

# pyright: reportPrivateUsage=false

import asyncio
import collections
import concurrent.futures
import contextlib
import dataclasses
import ipaddress
import logging
import math
import os
import socket
import sys
import threading
import time
import traceback
from collections.abc import Awaitable, Callable, Generator, Sequence
from http import HTTPStatus
from typing import NamedTuple, TypeAlias, TypeGuard, cast
from urllib.parse import urlsplit

import rich
import viser
import websockets.asyncio.server
from websockets.http11 import Request, Response

from app.render.handles.channel import is_to_channel
from app.render.handles.viser_inside import (
    UNKNOWN,
    Handler,
    Taker,
    forget_client,
    input_of,
    intercept,
    lose,
    refuse_requests,
    send_to_all,
    wake_on_loop,
)
from app.render.handles.viser_types import GuiHandle, ViserConnection, ViserMessage
from app.server.web.access import KEY_VARIABLE, OWN_PAGES_ONLY, Access, admitted, read_origin, refusal
from app.server.web.beat import PAGE, Beats
from app.server.web.page import own_answer, with_cover
from app.server.web.panes import Panes
from app.server.web.rate_limit import LIMIT, RateLimit, put_small_first

MAX_NUMBER = 1e6  # largest number allowed in a message
MAX_LENGTH = 1000  # of a text, or of a list
MAX_FIELD_LENGTH = 64  # of a text typed into a field
MAX_TEXT_LENGTH = 31_000  # of a field of several lines: a set-up file of 5,000 characters as a text of JSON
INTAKE_INTERVAL = 1 / 60  # [s] between two turns of handling one browser's messages
MAX_REPORTED = 5  # kinds of refused pages in the terminal
MAX_WAITING = 64  # waiting messages of one browser
STARTING = threading.Lock()  # one server at a time: websockets' serve() is patched while a server starts

ClientId: TypeAlias = int
MergeKey: TypeAlias = tuple[object, ...]

# Messages that our page sends. No uploads, no forms, no share tunnel.
ALLOWED = (
    "CommandTriggerMessage",
    "GetRenderResponseMessage",
    "GuiButtonHoldMessage",
    "GuiUpdateMessage",
    "SceneNodeClickMessage",
    "SceneNodeDragMessage",
    "ScenePointerMessage",
    "TransformControlsDragEndMessage",
    "TransformControlsDragStartMessage",
    "TransformControlsUpdateMessage",
    "ViewerCameraMessage",
)


def is_own_origin(origin: str | None, host: str | None, bound: str) -> bool:
    """True if a websocket with these headers comes from our own page, on a server bound to address `bound`.

    A browser always sends an Origin; programs that send none are no threat here. The Host must be a name of this
    machine, since a page of another name that resolves to it (DNS rebinding) has the same Origin and Host.
    """
    if origin is None:
        return True
    page = urlsplit(origin)
    if page.scheme not in ("http", "https") or page.netloc != (host or ""):
        return False
    name = page.hostname or ""
    if name in ("localhost", bound, socket.gethostname()):
        return True
    try:
        address = ipaddress.ip_address(name)
    except ValueError:
        return False
    return address.is_loopback or not is_loopback(bound)


def is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def may_connect(request: Request, bound: str, access: Access, origin: str | None) -> bool:
    """True if a page of this origin, at the Host of a request that has the key if one is set, may connect."""
    return bool(access.key) or origin in access.origins or is_own_origin(origin, request.headers.get("Host"), bound)


def advice(origin: str) -> str:
    """The option that would let a page of this origin connect; "" if it is no address of a page."""
    try:
        return f"--allowed-origin {read_origin(origin)}"
    except ValueError:
        return ""


class RefusedPages:
    """The pages that were refused, each reported once in the terminal."""

    def __init__(self) -> None:
        self.reported: set[str] = set()

    def report(self, origin: str) -> None:
        """Print that a page of this origin was refused, and the option that would allow it."""
        option = advice(origin)
        if option:
            self.say(f"refused a page at {option.split()[1]}. If it is yours, start the lab with {option}")

    def report_path(self, access: Access, response: Response) -> None:
        """Print that a page without the key or outside of the lab's path was refused, and the cure, without the key."""
        if response.status_code == HTTPStatus.FORBIDDEN:
            self.say(
                "refused a page without the key. Open the address that was printed at the start, or start the lab "
                f"without {KEY_VARIABLE}"
            )
        elif response.status_code == HTTPStatus.NOT_FOUND:
            self.say(f"refused a page outside of {access.base_path}/, where --base-path puts the lab")

    def say(self, words: str) -> None:
        """Print a sentence once."""
        if words not in self.reported and len(self.reported) < MAX_REPORTED:
            self.reported.add(words)
            print(f"springtide: {words}", file=sys.stderr, flush=True)

    @staticmethod
    def reason(origin: str) -> str:
        """The same for the page."""
        option = advice(origin)
        cure = f" If the page is yours, start the lab with {option}" if option else ""
        return f"This page may not connect: the lab does not know its address.{cure}"


@contextlib.contextmanager
def checked_requests(bound: str, access: Access, panes: Panes) -> Generator[list[str]]:
    """While open, a websocket server that starts refuses upgrades from other pages with 403, and serves the panes.

    A browser that connects meanwhile waits: viser listens before its messages are filtered. Yields a list with an entry
    for each started server.
    """
    serve = websockets.asyncio.server.serve
    started: list[str] = []
    ended: concurrent.futures.Future[None] = concurrent.futures.Future()
    beats, refusals = Beats(), RefusedPages()

    def guarded_serve(
        handler: Callable[[ViserConnection], Awaitable[None]],
        *address: object,
        process_request: ViserConnection = None,
        **options: object,
    ) -> object:
        def check(connection: ViserConnection, sent: Request) -> object:
            request = admitted(access, sent)
            if isinstance(request, Response):
                refusals.report_path(access, request)
                return request
            origin = request.headers.get("Origin")
            if not may_connect(request, bound, access, origin):
                if "Upgrade" in request.headers:
                    refusals.report(origin or "")
                return connection.respond(HTTPStatus.FORBIDDEN, "This page may not connect here.\n")
            request = panes.read(connection, request)
            if request is None:
                return refusal(HTTPStatus.NOT_FOUND, "No second pane is open.")

            def refused(page: str) -> str:
                """The reason why a page of this origin may not connect; "" if it may."""
                return refusals.reason(page) if page and not may_connect(sent, bound, access, page) else ""

            answer = own_answer(request, shared=bool(access.key), refused=refused)
            return answer or with_cover(request, process_request(connection, request))

        async def serve_pane(connection: ViserConnection) -> None:
            await asyncio.shield(asyncio.wrap_future(ended))
            limit = RateLimit(connection)
            connection.send = limit.send
            LIMIT.set(limit)
            async with beats.on(connection, limit):
                await panes.serve(connection, handler)

        started.append(bound)
        return serve(serve_pane, *address, process_request=check, **options)  # type: ignore[arg-type]

    websockets.asyncio.server.serve = guarded_serve  # type: ignore[assignment]
    try:
        yield started
    finally:
        websockets.asyncio.server.serve = serve  # type: ignore[assignment]
        ended.set_result(None)


def is_bounded(value: object) -> bool:
    """True if every number in a message is finite and of a sane size, and no text is long."""
    if isinstance(value, bool) or value is None:
        return True
    if isinstance(value, int | float):
        return math.isfinite(value) and abs(value) <= MAX_NUMBER
    if isinstance(value, str):
        return len(value) <= MAX_LENGTH
    if isinstance(value, bytes | bytearray | memoryview):
        return True
    if isinstance(value, dict):
        entries = cast(dict[object, object], value)
        return all(is_bounded(k) and is_bounded(v) for k, v in entries.items())
    return is_sequence(value) and len(value) <= MAX_LENGTH and all(is_bounded(v) for v in value)


def is_sequence(value: object) -> TypeGuard[Sequence[object]]:
    """True if this is a list or a tuple."""
    return isinstance(value, list | tuple)


def is_number(value: object) -> TypeGuard[float]:
    """True if this is a finite number and not a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


# Type of the value of each GUI element.
FLAGS = (viser.GuiCheckboxHandle, viser.GuiButtonHandle)
CHOICES = (viser.GuiDropdownHandle, viser.GuiButtonGroupHandle)


def allowed_value(handle: GuiHandle, value: object) -> object:
    """`value` if it is of the kind that a GUI control takes, a long text cut; None otherwise.

    A number may be out of its parameter's range, which the settings decide.
    """
    kind = cast("type[object]", type(handle))
    if issubclass(kind, FLAGS):
        return value if isinstance(value, bool) else None
    if issubclass(kind, viser.GuiMultiSliderHandle):
        if not is_sequence(value) or len(value) != len(handle.value) or not all(map(is_number, value)):
            return None
        return tuple(float(number) for number in value if is_number(number))
    if issubclass(kind, CHOICES):
        return value if isinstance(value, str) and value in handle.options else None
    if issubclass(kind, viser.GuiTextHandle):
        if handle.multiline:  # its content is checked when it is saved, which can report errors
            return value[:MAX_TEXT_LENGTH] if isinstance(value, str) else None
        return value if isinstance(value, str) and len(value) <= MAX_FIELD_LENGTH and value.isprintable() else None
    return None


def same(good: object, sent: object) -> bool:
    """True if a browser already shows the value accepted from its message."""
    return (is_sequence(good) and is_sequence(sent) and list(good) == list(sent)) or good == sent


def kind_of(message: ViserMessage) -> str:
    """The name of the type of a message."""
    return type(message).__name__


class MessageFilter:
    """Filter of a browser's messages: passes the allowed ones and counts the others."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.server = server
        self.refused: collections.Counter[str] = collections.Counter()
        self.is_in_place = False  # True if messages pass through it
        self.pages: dict[ClientId, str] = {}  # connected clients that are pages of ours, with their names

    def __call__(self, message: ViserMessage) -> ViserMessage:
        """The message, with a text cut to its greatest length, or None if it is refused.

        Counts refused messages, and tells every browser a value that is not the one sent.
        """
        if kind_of(message) != "GuiUpdateMessage":
            good = message if kind_of(message) in ALLOWED and is_bounded(dataclasses.asdict(message)) else None
        else:
            good = self.judge_update(message)
            if good is not None and not same(good.updates["value"], message.updates["value"]):
                # The sender shows its own value: send the accepted one to it and to everyone.
                send_to_all(self.server, good)
        if good is None:
            self.refused[type(message).__name__] += 1
        return good

    def judge_update(self, message: ViserMessage) -> ViserMessage | None:
        """A new value of a control, of its kind; None if it is not valid."""
        handle = input_of(self.server, message.uuid)
        if handle is UNKNOWN:
            return message if is_bounded(message.updates) else None
        if handle is None or set(message.updates) != {"value"}:
            return None
        good = allowed_value(handle, message.updates["value"])
        if good is None or getattr(handle, "disabled", False):
            return None
        return dataclasses.replace(message, updates={"value": good})


def merge_key(message: ViserMessage) -> MergeKey | None:
    """Key by which messages are coalesced to the latest. None for messages that are never coalesced."""
    match kind := kind_of(message):
        case "GuiUpdateMessage" | "CommandTriggerMessage" | "GuiButtonHoldMessage":
            return kind, message.uuid
        case "SceneNodeDragMessage":
            return kind, message.name, message.instance_index, message.phase
        case "SceneNodeClickMessage" | "TransformControlsUpdateMessage":
            return kind, message.name
        case "ViewerCameraMessage" | "ScenePointerMessage":
            return (kind,)
        case _:
            return None


def is_camera(message: ViserMessage) -> bool:
    """True if this message holds the camera of a browser."""
    return kind_of(message) == "ViewerCameraMessage"


class Intake:
    """The messages of one browser on their way to viser's handlers, on viser's event loop.

    A single message is handled at once. Messages faster than `INTAKE_INTERVAL` wait for the next turn, and of messages
    that supersede each other only the last is handled: a browser that floods slows itself, not others.

    viser counts a browser from its first camera message on, and ignores half of its earlier messages. These wait until
    then: a page may send the link in its address first.
    """

    def __init__(
        self,
        message_filter: Callable[[ViserMessage], ViserMessage],
        handlers: "list[Handler]",
        is_to_channel: Callable[[str], bool] = lambda uuid: False,
    ) -> None:
        """is_to_channel: true for the field of the channel, through which all topics go: each message counts."""
        self.message_filter, self.handlers, self.is_to_channel = message_filter, handlers, is_to_channel
        self.waiting: dict[MergeKey, ViserMessage] = {}
        self.unmerged = 0  # counts messages that are never merged, to give each a key
        self.turn: asyncio.Task[None] | None = None
        self.turned_at = -math.inf  # [s] time of the last handled message
        self.counted = False  # True once viser has had a camera message

    def queue(self, client: ClientId, message: ViserMessage) -> None:
        """Queue a message, replacing one that it supersedes; beyond `MAX_WAITING` the oldest is dropped."""
        if kind_of(message) not in ALLOWED:
            self.message_filter(message)  # refused and counted
            return
        key = merge_key(message)
        if key is None or (kind_of(message) == "GuiUpdateMessage" and self.is_to_channel(message.uuid)):
            self.unmerged += 1
            key = (kind_of(message), self.unmerged)
        self.waiting.pop(key, None)
        self.waiting[key] = message
        if len(self.waiting) > MAX_WAITING:
            self.waiting.pop(next(iter(self.waiting)))
        if self.turn is None:
            self.turn = asyncio.get_running_loop().create_task(self.handle_waiting(client))

    def close(self) -> None:
        """Handle no more messages: a camera message handled after its browser has left would count as a browser."""
        self.waiting, self.handlers = {}, []

    async def handle_waiting(self, client: ClientId) -> None:
        """Handle the waiting messages, in turns."""
        try:
            while self.waiting:
                pause = self.turned_at + INTAKE_INTERVAL - time.monotonic()
                if pause > 0.0:
                    await asyncio.sleep(pause)
                keys = [key for key, message in self.waiting.items() if self.counted or is_camera(message)]
                if not keys:
                    return
                for message in [self.waiting.pop(key) for key in keys]:
                    await self.handle(client, message)
                self.turned_at = time.monotonic()
        finally:
            self.turn = None

    async def handle(self, client: ClientId, message: ViserMessage) -> None:
        """Filter a message and call its handlers; one that fails is reported, and the others are called."""
        good = self.message_filter(message)
        if good is None:
            return
        for handle in self.handlers:
            try:
                await handle(client, good)
            except Exception:
                traceback.print_exc()
        self.counted = True


def put_intakes(server: viser.ViserServer, message_filter: MessageFilter) -> bool:
    """Pass every message of a browser through its intake before viser's handlers. False if that is impossible."""
    intakes: dict[ClientId, Intake] = {}

    def join(client: ClientId, handlers: list[Handler]) -> Taker:
        intakes[client] = intake = Intake(message_filter, handlers, lambda uuid: is_to_channel(server, uuid))
        if name := PAGE.get(""):
            message_filter.pages[client] = name
        return intake.queue

    def leave(client: ClientId) -> None:
        intakes.pop(client).close()
        message_filter.pages.pop(client, None)
        forget_client(server, client)

    return intercept(server, join, leave)


@contextlib.contextmanager
def quiet() -> Generator[None]:
    """Context in which viser prints nothing: we print our own address, and a notebook would show both."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before


def check_port(host: str, port: int) -> None:
    """Raise OSError if it cannot be bound: viser would take the next port, or wait for the address forever."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        if os.name == "posix":  # ports of servers that have just ended; elsewhere it would allow those of running ones
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind((host, port))


class Opened(NamedTuple):
    """A listening server."""

    server: viser.ViserServer
    message_filter: MessageFilter
    panes: Panes  # the labs reached through its port


def open_server(host: str, port: int, access: Access = OWN_PAGES_ONLY) -> Opened:
    """A viser server that only our own page may connect to, with its messages filtered by `MessageFilter`.

    access: who else may connect. Raises OSError if the port is busy or may not be bound.
    """
    check_port(host, port)
    # A message that cannot be decoded ends its connection, and would print a traceback each time.
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)
    panes = Panes()
    with STARTING, checked_requests(host, access, panes) as started, quiet():
        server = viser.ViserServer(host=host, port=port, label="Springtide", verbose=False)
        message_filter = guarded(server)
    if port not in (0, server.get_port()):
        server.stop()
        raise OSError(f"port {port} was taken while starting")
    if not started:
        lose("other pages of the browser may connect", "it does not call websockets.asyncio.server.serve")
    if not (started and message_filter.is_in_place) and not is_loopback(host):
        server.stop()
        raise OSError(f"with viser {viser.__version__} the lab serves loopback addresses only")
    return Opened(server, message_filter, panes)


def open_pane(panes: Panes, number: int) -> Opened:
    """The server of a pane, reached through the port of the first lab and protected with it."""
    with STARTING, panes.making() as servers, quiet():
        server = viser.ViserServer(port=0, label="Springtide", verbose=False)
    opened = Opened(server, guarded(server), panes)
    if servers:
        panes.servers[number] = servers[0]
    return opened


def guarded(server: viser.ViserServer) -> MessageFilter:
    """Filter the messages of a server's browsers, and limit the rate of the messages to them."""
    message_filter = MessageFilter(server)
    refuse_requests(server, "ShareUrlRequest", "ShareUrlDisconnect")
    message_filter.is_in_place = put_intakes(server, message_filter)
    wake_on_loop(server)
    put_small_first(server)
    return message_filter
