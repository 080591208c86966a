"""What the viewer's threads live through."""

import dataclasses
import time
from typing import Any

import pytest

from app.messages import Grab, StepOnce
from app.server.viewer import Viewer
from tests.app.server.test_guard import talk


def wait_for(condition: Any) -> None:
    end = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_a_picture_that_cannot_be_drawn_halts_the_run_once_and_the_threads_live(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def fail(picture: Any) -> None:
        raise ValueError("no such colour")

    monkeypatch.setattr(lab.view, "show", fail)
    lab.commands.put(StepOnce())
    wait_for(lambda: lab.loop.halted)
    assert lab.loop.halted == "The picture could not be drawn, ValueError: no such colour"
    wait_for(lambda: lab.shown == lab.loop.latest.serial)
    assert all(thread.is_alive() for thread in lab.threads)
    assert capsys.readouterr().err.count("Traceback") == 1


def test_what_is_handed_over_is_not_held_back(lab: Viewer) -> None:
    buffer = lab.server._websock_server.get_message_buffer()
    assert "window_duration_sec" in {field.name for field in dataclasses.fields(buffer)}  # as viser names it
    assert buffer.window_duration_sec == 0.0


class Client:
    """A browser, as viser's callbacks name it."""

    def __init__(self, client_id: int) -> None:
        self.client_id = client_id


def test_a_browser_that_goes_lets_go_of_what_it_held_and_of_nothing_else(lab: Viewer) -> None:
    lab.commands.put(Grab(5, (0.0, 0.0, 2.0), client=1))
    wait_for(lambda: lab.scene.held is not None)
    talk(lab.on_disconnect(Client(2)))  # type: ignore[arg-type]
    ticks = lab.loop.counts["ticks"]
    wait_for(lambda: lab.loop.counts["ticks"] > ticks + 3)
    assert lab.scene.held is not None
    talk(lab.on_disconnect(Client(1)))  # type: ignore[arg-type]
    wait_for(lambda: lab.scene.held is None)
