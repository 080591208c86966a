"""Words about work that takes long outlive the scene in which it was asked for."""

import asyncio
import threading
from types import SimpleNamespace
from typing import Any

import pytest

from app.panel.recording import files as module
from app.panel.recording.files import ARRAYS, PICTURE, REPLAY
from app.server.viewer import Viewer
from tests.waiting import wait_for


class Browser:
    """A browser that is told and sent things."""

    def __init__(self) -> None:
        self.words: list[Any] = []
        self.sent: list[str] = []

    def add_notification(self, title: str, body: str, **_: object) -> SimpleNamespace:
        self.words.append(SimpleNamespace(title=title, body=body, loading=True))
        return self.words[-1]

    def send_file_download(self, name: str, content: bytes, **_: object) -> None:
        self.sent.append(name)


def ask(lab: Viewer, browser: Browser, what: str) -> None:
    event: Any = SimpleNamespace(client=browser, target=SimpleNamespace(value=what))
    asyncio.run(lab.panel.share.files.on_file(event))


@pytest.fixture
def late(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """Files are made once this is set."""
    event = threading.Event()

    def after(name: str) -> None:
        made = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *given: event.wait(30.0) and made(*given))

    after("recording_npz")
    monkeypatch.setattr(module, "take_picture", lambda *_, **__: event.wait(30.0) and b"picture")
    return event


@pytest.mark.parametrize("what", [REPLAY, ARRAYS])
def test_a_file_is_sent_and_said_whatever_scene_is_shown_by_then(lab: Viewer, late: threading.Event, what: str) -> None:
    lab.visitors = lambda: [1]  # type: ignore[method-assign]
    wait_for(lambda: len(lab.panel.recorder.frames) > 3)
    files, make, browser = lab.panel.share.files, lab.panel.share.files.make_replay, Browser()
    files.make_replay = lambda *given: (late.wait(30.0) and make(*given)) or ""
    ask(lab, browser, what)
    ask(lab, browser, what)
    assert browser.words[1].body == "Another file is still being created."
    lab.open("cloth")
    late.set()
    wait_for(lambda: not browser.words[0].loading)
    assert browser.words[0].body.endswith("MB, was sent to the browser.")
    assert len(browser.sent) == 1
    assert browser.sent[0].startswith("springtide-rope")
    wait_for(lambda: not files.busy.locked())


def test_a_picture_of_another_scene_is_not_sent(lab: Viewer, late: threading.Event) -> None:
    browser = Browser()
    files = lab.panel.share.files
    ask(lab, browser, PICTURE)
    lab.open("cloth")
    late.set()
    wait_for(lambda: not browser.words[0].loading)
    assert browser.words[0].body == "Couldn't create the file: another scene was opened before it was ready"
    assert browser.sent == []
    assert not files.busy.locked() or files.busy.acquire(timeout=5.0)
