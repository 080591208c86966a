"""What a browser is sent of one picture comes in one message, however slow the browser is."""

import asyncio
import threading
import time
from typing import Any

import msgspec
import viser
import websockets
import zstandard
from websockets.asyncio.client import connect

from app.server.web.guard import open_server
from app.server.web.transport import Transport
from tests import coroutines
from tests.waiting import wait_for

NODES = 12  # of the drawing, a mesh and a place each
PICTURES = 300


def unpacked(sent: bytes) -> dict[str, Any]:
    """The content of one websocket message of viser's."""
    size = int.from_bytes(sent[8:16], "little")
    inner = zstandard.ZstdDecompressor().decompress(sent[16 : 16 + size], max_output_size=100_000_000)
    return msgspec.msgpack.decode(inner)


def decoded(sent: bytes) -> list[dict[str, Any]]:
    """The messages of one websocket message of viser's."""
    return unpacked(sent)["messages"]


class SlowDict(dict):
    """A dict that lets other threads run whenever it is read."""

    def get(self, key: Any, default: Any = None) -> Any:
        time.sleep(1e-4)
        return super().get(key, default)


async def torn_messages(port: int, ended: threading.Event) -> tuple[int, int]:
    """How many messages have a part of a picture, and after how many of them not all nodes show the same one."""
    protocol = websockets.Subprotocol(f"viser-v{viser.__version__}")
    shown: dict[tuple[str, str], Any] = {}
    whole = torn = 0
    address = f"ws://127.0.0.1:{port}"
    async with connect(address, subprotocols=[protocol], max_size=None, max_queue=1) as client:
        while not ended.is_set():
            try:
                async with asyncio.timeout(0.5):
                    sent = bytes(await client.recv())
            except TimeoutError:
                continue
            parts = [message for message in decoded(sent) if str(message.get("name", "")).startswith("/node")]
            for message in parts:
                if message["type"] == "SetPositionMessage":
                    shown[message["name"], "place"] = round(message["position"][0])
                elif "text" in message.get("updates", {}):
                    shown[message["name"], "mesh"] = int(message["updates"]["text"])
            if parts and len(shown) == 2 * NODES:
                whole += 1
                torn += len(set(shown.values())) > 1
    return whole, torn


def test_mesh_and_poses_of_a_picture_come_in_one_message() -> None:
    server = open_server("127.0.0.1", 0).server
    buffer = server._websock_server.get_message_buffer()
    buffer.window_duration_sec = 0.0
    buffer.message_from_id = SlowDict(buffer.message_from_id)  # viser makes messages of it
    transport = Transport(server)
    ended = threading.Event()
    try:
        nodes = [server.scene.add_label(f"/node_{i}", "0") for i in range(NODES)]

        def draw() -> None:
            time.sleep(0.3)
            for picture in range(1, PICTURES):
                with transport.counted():
                    for node in nodes:
                        node.text = str(picture)
                    time.sleep(0.001)  # while a message with the picture before is put together
                    for node in nodes:
                        node.position = (float(picture), 0.0, 0.0)
                time.sleep(0.002)
            time.sleep(0.3)
            ended.set()

        painter = threading.Thread(target=draw)
        painter.start()
        whole, torn = coroutines.run(torn_messages(server.get_port(), ended))
        painter.join()
        assert whole > 10
        assert torn == 0
    finally:
        ended.set()
        server.stop()


def test_each_message_of_a_picture_is_counted_once(server: viser.ViserServer) -> None:
    transport = Transport(server)
    label = server.scene.add_label("/label", "")
    before = dict(transport.sent)
    with transport.counted():
        label.text = "one"
        label.position = (1.0, 0.0, 0.0)
        label.text = "two"
    label.text = "three"  # of no picture
    assert transport.sent["messages"] - before.get("messages", 0) == 3


def test_a_picture_is_not_waited_for_but_before_the_next_and_before_the_end() -> None:
    server = open_server("127.0.0.1", 0).server
    busy, loop, sent = threading.Event(), server.get_event_loop(), []
    try:
        transport = Transport(server)
        label = server.scene.add_label("/label", "")
        send, transport.send_together = transport.send_together, lambda picture: (sent.append(picture), send(picture))
        loop.call_soon_threadsafe(busy.wait)
        with transport.counted():
            label.text = "first"
        assert not sent
        threading.Timer(0.05, busy.set).start()
        with transport.counted():
            label.text = "second"
        assert sent
        transport.wait()
        assert len(sent) == 2
    finally:
        busy.set()
        server.stop()


def test_a_picture_that_viser_refuses_holds_back_no_later_one(server: viser.ViserServer) -> None:
    connection = server._websock_server
    send, refused = connection.queue_message, threading.Event()

    def refuse(message: Any) -> None:
        if getattr(message, "updates", {}).get("text") == "bad":
            refused.set()
            raise ValueError("no such text")
        send(message)

    connection.queue_message = refuse
    server.get_event_loop().call_soon_threadsafe(
        server.get_event_loop().set_exception_handler, lambda loop, context: None
    )
    transport = Transport(server)
    label = server.scene.add_label("/label", "")
    with transport.counted():
        label.text = "bad"
    assert refused.wait(10.0)
    wait_for(lambda: connection.get_message_buffer().atomic_counter == 0)
