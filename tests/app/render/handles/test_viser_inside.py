"""Arrays of a node as they are sent, and the wake-up of the task that sends."""

import asyncio
import contextlib
import sys
import threading
from typing import Any

import numpy as np
import pytest
import viser
from viser.infra._async_message_buffer import AsyncMessageBuffer

from app.render.handles.viser_inside import LOST, attempt, input_of, set_arrays, uuid_of, wake_on_loop
from tests.waiting import wait_for

TURNS = np.array([[1.0, 0.0, 0.0, 0.0]])


@pytest.fixture
def sent(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    found: list[Any] = []
    monkeypatch.setattr(server._websock_server, "queue_message", found.append)
    return found


def test_one_message_with_copies_where_something_changed(server: viser.ViserServer, sent: list[Any]) -> None:
    vertices, faces = np.eye(3), np.array([[0, 1, 2]])
    node = server.scene.add_batched_meshes_simple("/a", vertices, faces, TURNS, np.zeros((1, 3)))
    sent.clear()
    places = np.array([[1.0, 2.0, 3.0]])
    set_arrays(node, batched_positions=places, batched_wxyzs=TURNS)
    places[:] = 9.0
    assert [message.name for message in sent] == ["/a"]
    updates = sent[0].updates
    assert {name: value.tolist() for name, value in updates.items()} == {
        "batched_positions": [[1.0, 2.0, 3.0]],
        "batched_wxyzs": TURNS.tolist(),
    }
    assert updates["batched_positions"].dtype == np.float32
    assert node.batched_positions.tolist() == [[1.0, 2.0, 3.0]]
    set_arrays(node, batched_positions=np.array([[1.0, 2.0, 3.0]]), batched_wxyzs=TURNS)
    assert len(sent) == 1  # nothing changed
    set_arrays(node, batched_positions=places, batched_wxyzs=TURNS)
    assert updates["batched_positions"].tolist() == [[1.0, 2.0, 3.0]]  # what is on its way does not change


def test_a_control_is_known_by_the_name_that_messages_have(server: viser.ViserServer) -> None:
    slider = server.gui.add_slider("size", 0.0, 1.0, 0.1, 0.5)
    assert input_of(server, uuid_of(slider)) is slider
    assert input_of(server, "no such name") is None


def test_a_removed_node_is_refused(server: viser.ViserServer) -> None:
    node = server.scene.add_mesh_simple("/a", np.eye(3), np.array([[0, 1, 2]]))
    node.remove()
    with pytest.raises(RuntimeError, match="/a has been removed"):
        set_arrays(node, vertices=np.zeros((3, 3)))


def test_a_name_that_viser_lacks_is_told_once_and_done_without(capsys: pytest.CaptureFixture[str]) -> None:
    try:
        for _ in range(2):
            assert attempt(lambda: viser.no_such_name, 7, "a test of this") == 7
        said = capsys.readouterr().err
        assert said.count("a test of this") == 1
        assert "has changed inside" in said
    finally:
        LOST.pop("a test of this", None)


def test_a_message_that_comes_as_the_sending_task_begins_to_wait_is_sent(server: viser.ViserServer) -> None:
    """For all browsers, and for one of them."""
    wake_on_loop(server)
    connection, loop = server._websock_server, server.get_event_loop()
    client = viser.infra.WebsockClientConnection(7, viser.infra._infra._ClientHandleState(
        AsyncMessageBuffer(loop, persistent_messages=False), loop))  # fmt: skip
    for called in connection._client_connect_cb:
        if not asyncio.iscoroutinefunction(called):
            called(client)
    for sender in (connection, client):
        check_wake_up(sender, loop)


def check_wake_up(sender: Any, loop: asyncio.AbstractEventLoop) -> None:
    """Send a message on another thread after the task of the messages has read its event and before it waits."""
    buffer, make = sender.get_message_buffer(), loop.create_future
    message = viser._messages.GuiUpdateMessage("late", {"value": 1})
    sent: list[Any] = []
    interrupted: list[bool] = []

    def create_future() -> "asyncio.Future[Any]":
        caller = sys._getframe(1)
        if caller.f_locals.get("self") is buffer.message_event and not interrupted:
            interrupted.append(True)
            thread = threading.Thread(target=sender.queue_message, args=[message])
            thread.start()
            thread.join()
        return make()

    async def send() -> None:
        async with contextlib.aclosing(buffer.window_generator(1)) as windows:
            async for window in windows:
                sent.extend(window)

    loop.create_future = create_future
    sending = asyncio.run_coroutine_threadsafe(send(), loop)
    try:
        wait_for(lambda: interrupted)
        wait_for(lambda: message in sent, 20.0)
    finally:
        loop.create_future = make
        sending.cancel()
