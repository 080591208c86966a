"""The inner parts of viser that the lab uses, each behind a function that works without it.

This file alone names them. Where viser has changed one, the lab goes without what it serves, and one line says what
that is. `tests/app/server/test_viser_names.py` takes each away in turn.
"""

import asyncio
import contextlib
import sys
import time
from collections.abc import Awaitable, Callable, Sequence
from typing import Any, TypeVar

import numpy as np
import viser

from app.render.handles.viser_types import GuiHandle, ViserConnection, ViserMessage

messages: Any = None
with contextlib.suppress(ImportError):
    from viser import _messages as messages

T = TypeVar("T")
Handler = Callable[[int, ViserMessage], Awaitable[None]]
Taker = Callable[[int, ViserMessage], None]

UNKNOWN: GuiHandle = object()
LOST: dict[str, str] = {}  # lost function -> the reason


def lose(what: str, reason: str) -> None:
    """Say once that the lab goes without something."""
    if what not in LOST:
        LOST[what] = reason
        version = getattr(viser, "__version__", "")
        print(f"springtide: viser {version} has changed inside ({reason}): {what}", file=sys.stderr, flush=True)


def attempt(use: Callable[[], T], otherwise: T, loss: str) -> T:
    """Return the result of `use`, or `otherwise` if viser lacks a name that it uses."""
    try:
        return use()
    except (AttributeError, ImportError) as error:
        lose(loss, str(error))
        return otherwise


def connection_of(server: viser.ViserServer) -> ViserConnection:
    """The websocket server of a viser server."""
    return server._websock_server


def uuid_of(handle: GuiHandle) -> str:
    """The name of a GUI element in viser's messages and page; "" if it is not known."""
    return attempt(lambda: handle._impl.uuid, "", "the page does not find its own controls")


def input_of(server: viser.ViserServer, uuid: str) -> GuiHandle | None:
    """The GUI element that a message names: None if there is no such element, UNKNOWN if viser does not say."""
    gui: Any = server.gui
    loss = "values of controls are checked less strictly"
    return attempt(lambda: gui._gui_input_handle_from_uuid.get(uuid), UNKNOWN, loss)


def send_to_all(server: viser.ViserServer, message: ViserMessage) -> None:
    """Send a message to every browser of a server."""
    connection_of(server).queue_message(message)


def message_frame(parts: Sequence[dict[str, Any]]) -> bytes:
    """Messages as viser's client reads them from a connection; empty if that is not possible.

    See `_message_producer` of viser: the size of the content and of its compressed form, then this, without arrays.
    """

    def encode() -> bytes:
        import msgspec
        import zstandard

        _ = messages.Message.as_serializable_dict  # of a viser that has this form
        stamp = {"messages": parts, "timestampSec": time.perf_counter(), "binaryBufferLengths": ()}
        inner = msgspec.msgpack.encode(stamp)
        packed = zstandard.ZstdCompressor(level=1).compress(inner)
        filling = bytes(-len(packed) % 8)
        return len(inner).to_bytes(8, "little") + len(packed).to_bytes(8, "little") + packed + filling

    return attempt(encode, b"", "a dead connection is not noticed")


def update_node(client: viser.ClientHandle, node: str, **properties: Any) -> None:
    """Give a node of the server other properties for one browser."""
    attempt(
        lambda: client._websock_connection.queue_message(messages.SceneNodeUpdateMessage(node, properties)),
        None,
        "the floor does not turn dark",
    )


def set_arrays(node: Any, **arrays: np.ndarray) -> None:
    """Set properties of a node that are arrays, in one message; nothing is sent if all of them are as they were.

    viser's own assignment takes 0.03 ms for each array, most of it to find its type. With bodies on a sea that was a
    quarter of the time of a frame. Raises RuntimeError if the node has been removed.

    Arrays are copied, in the type that the property has. One property is set always by this function or never, and
    always together with the same others: viser changes arrays in place that are being sent, and what it keeps for
    a later browser is the last message about each group of properties.
    """
    try:
        impl = node._impl
        name, removed, props, send = impl.name, impl.removed, impl.props, impl.api._queue_scene_message
        message = messages.SceneNodeUpdateMessage
    except AttributeError as error:
        lose("arrays of a frame are sent one by one", str(error))
        for key, value in arrays.items():
            setattr(node, key, value)
        return
    if removed:
        raise RuntimeError(f"The node {name} has been removed.")
    updates: dict[str, np.ndarray] = {}
    same = True
    for key, value in arrays.items():
        old = getattr(props, key)
        updates[key] = new = np.array(value, old.dtype, order="C")
        same = same and new.shape == old.shape and bool((new == old).all())
    if same:
        return
    for key, new in updates.items():
        setattr(props, key, new)
    send(message(name, dict(updates)))


def change_buffers(recording: Any, change: Callable[[Any], Any]) -> None:
    """Replace each binary buffer of viser's recording by the result of `change`."""

    def replace() -> None:
        recording._binary_buffers = [change(buffer) for buffer in recording._binary_buffers]

    attempt(replace, None, "replay files are larger")


def refuse_requests(server: viser.ViserServer, *names: str) -> None:
    """Take viser's handlers of these messages away."""

    def refuse() -> None:
        for name in names:
            connection_of(server).unregister_handler(getattr(messages, name))

    attempt(refuse, None, "messages that the lab does not use are handled")


def forget_client(server: viser.ViserServer, client: int) -> None:
    """Do not count a browser that has left; viser may have counted it by a late message."""
    known: dict[int, Any] = getattr(server, "_connected_clients", {})
    known.pop(client, None)


def intercept(
    server: viser.ViserServer, join: Callable[[int, list[Handler]], Taker], leave: Callable[[int], None]
) -> bool:
    """Pass the messages of each browser through the function that `join` returns. False if that is not possible.

    join: called with a browser's id and viser's handlers of its messages. leave: called when the browser has left.
    """

    def put() -> bool:
        connection = connection_of(server)
        handle: Handler = connection._handle_incoming_message
        takers: dict[int, Taker] = {}

        async def take(client_id: int, message: ViserMessage) -> None:
            if client_id in takers:
                takers[client_id](client_id, message)

        async def ignore(client_id: int, message: ViserMessage) -> None:
            """The same message as the server is given: one taker serves both."""

        def connect(client: ViserConnection) -> None:
            takers[client.client_id] = join(client.client_id, [handle, client._handle_incoming_message])
            client._handle_incoming_message = ignore

        def disconnect(client: ViserConnection) -> None:
            takers.pop(client.client_id, None)
            leave(client.client_id)

        connection.on_client_connect(connect)
        connection.on_client_disconnect(disconnect)
        connection._handle_incoming_message = take
        return True

    return attempt(put, False, "messages of browsers are not checked")


def send_at_once(server: viser.ViserServer) -> None:
    """Do not hold messages back for 17 ms to send them together: flushing each frame costs more."""

    def set_window() -> None:
        buffer = connection_of(server).get_message_buffer()
        _ = buffer.window_duration_sec
        buffer.window_duration_sec = 0.0

    attempt(set_window, None, "answers are 17 ms late")


class LoopEvent(asyncio.Event):
    """An event that only its own event loop sets."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__()
        self.loop = loop

    def set(self) -> None:
        """Set it; nothing on another thread."""
        with contextlib.suppress(RuntimeError):  # no event loop runs on this thread
            if asyncio.get_running_loop() is self.loop:
                super().set()


def wake_on_loop(server: viser.ViserServer) -> None:
    """Wake the tasks that send messages on viser's event loop alone.

    viser sets their event twice: on the thread that has a message, and then on its event loop. If the thread does so
    after a task has read the event and before it waits, the task is not woken, and the second time changes nothing: its
    browser gets no message any more until another one connects. To be called before a browser connects.
    """
    loop = server.get_event_loop()

    def replace(connection: ViserConnection) -> None:
        buffer = connection.get_message_buffer()
        _ = buffer.message_event  # without it a new viser waits for something else, and nothing is replaced
        buffer.message_event = LoopEvent(loop)

    def put() -> None:
        connection = connection_of(server)
        replace(connection)
        connection.on_client_connect(replace)

    attempt(put, None, "a page may stop taking messages")


def pass_windows_through(server: viser.ViserServer, change: Callable[[Any], Any]) -> None:
    """Let `change` make of each iterator over groups of messages that are sent another one."""

    def put() -> None:
        buffer = connection_of(server).get_message_buffer()
        windows: Callable[..., Any] = buffer.window_generator

        def changed(*arguments: object, **options: object) -> Any:
            return change(windows(*arguments, **options))

        buffer.window_generator = changed

    attempt(put, None, "slow connections are not paced")


def watch_messages(server: viser.ViserServer, take: Callable[[ViserMessage], bool]) -> Callable[[Sequence[Any]], None]:
    """Show `take` each message for all browsers before it is sent; those that it takes are not.

    Returns a function that sends messages as one, on viser's event loop.
    """

    def put() -> Callable[[Sequence[Any]], None]:
        connection = connection_of(server)
        send, buffer = connection.queue_message, connection.get_message_buffer()
        start, end = buffer.atomic_start, buffer.atomic_end

        def queue_message(message: ViserMessage) -> None:
            if not take(message):
                send(message)

        def send_together(parts: Sequence[ViserMessage]) -> None:
            # Within, viser wakes its event loop once and not for each message.
            start()
            try:
                for message in parts:
                    send(message)
            finally:
                end()

        connection.queue_message = queue_message
        return send_together

    def send_nothing(parts: Sequence[ViserMessage]) -> None:
        """Nothing has been taken."""

    return attempt(put, send_nothing, "frames are sent in parts")
