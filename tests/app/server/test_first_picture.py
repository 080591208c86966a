"""A run begins with the first whole picture of a page, and waits for nobody who draws none."""

import time
from types import SimpleNamespace
from typing import Any, cast

import msgspec
import pytest

from app.render.handles.channel import channel_of
from app.render.handles.viser_inside import uuid_of
from app.render.injection import ShaderInjector, injector_of
from app.server.first_picture import PATIENCE, FirstPicture
from app.server.viewer import Viewer
from tests import coroutines
from tests.app.channels import text_of
from tests.app.server.web.test_beat import page
from tests.stress.clients import CAMERA
from tests.waiting import wait_for


def picture_of(whole: set[int]) -> FirstPicture:
    """The first picture of a scene that the clients 1 and 2 await, which are pages. whole: those that have it."""
    return FirstPicture(cast(ShaderInjector, SimpleNamespace(whole=whole)), {1, 2})


def test_pages_wait_for_the_first_of_them_that_has_the_picture() -> None:
    whole: set[int] = set()
    first = picture_of(whole)
    assert first.audience([], 0) == 0
    assert first.audience([1, 2], 2) == 0
    whole.add(2)
    assert first.audience([1, 2], 2) == 2
    whole.clear()
    assert first.audience([1], 1) == 1  # a page that comes later finds the run


def test_a_picture_of_a_page_that_has_left_does_not_count() -> None:
    first = picture_of({2})
    assert first.audience([1], 1) == 0


@pytest.mark.parametrize("clients", [[3], [1, 3]])
def test_a_program_is_not_waited_for(clients: list[int]) -> None:
    assert picture_of(set()).audience(clients, len(clients)) == len(clients)


def test_a_lab_without_shaders_does_not_wait() -> None:
    assert FirstPicture(None, {1}).audience([1], 1) == 1


def test_the_wait_has_an_end_counted_from_the_first_page() -> None:
    first = picture_of(set())
    assert first.audience([], 0, lambda: 0.0) == 0
    assert first.audience([1], 1, lambda: 1000.0) == 0
    assert first.audience([1], 1, lambda: 1000.0 + PATIENCE) == 0
    assert first.audience([1], 1, lambda: 1001.0 + PATIENCE) == 1


def test_a_run_stands_at_its_start_until_the_page_has_the_whole_picture() -> None:
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open("rope")
        injector = injector_of(viewer.server)
        assert injector is not None

        def report(*, is_whole: bool, scene: int = 0) -> dict[str, Any]:
            channel = channel_of(viewer.server)
            value = {"scene": scene or channel.state_of("picture")["scene"], "isWhole": is_whole, "nodes": ["/rope"]}
            uuid = uuid_of(channel.field)
            return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": text_of("drawn", value)}}

        async def visit() -> tuple[float, float]:
            async with page(viewer.port, "/?page=a") as client:
                await client.send(msgspec.msgpack.encode(CAMERA))
                await client.send(msgspec.msgpack.encode(report(is_whole=False)))
                await client.send(msgspec.msgpack.encode(report(is_whole=True, scene=-1)))  # of another scene
                end = time.monotonic() + 2.0
                while time.monotonic() < end:
                    await client.recv()
                waited = viewer.scene.time
                await client.send(msgspec.msgpack.encode(report(is_whole=True)))
                end = time.monotonic() + 60.0
                while time.monotonic() < end and viewer.scene.time == 0.0:
                    await client.recv()
                return waited, viewer.scene.time

        waited, after = coroutines.run(visit())
        assert waited == 0.0
        assert after > 0.0
        wait_for(lambda: not viewer.message_filter.pages)
    finally:
        viewer.shut()


def test_the_viewers_thread_survives_an_error_of_the_recording_and_the_page_says_so(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab.open("rope")
    served = lab.served

    def fail(*_: object) -> None:
        raise MemoryError("no room")

    monkeypatch.setattr(served.panel.recorder, "note", fail)
    wait_for(lambda: bool(lab.loop.run.halted))
    assert lab.loop.run.halted == "The recording could not go on, MemoryError: no room"
    assert all(thread.is_alive() for thread in served.threads)
    wait_for(lambda: "no room" in lab.panel.head.status.content)
