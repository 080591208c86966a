"""Every button of every tab, pressed as viser passes on a browser's press: none raises, and each shows its effect."""

import asyncio
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser
from viser import _messages

from app.messages import Command
from app.panel.recording.files import CHARTS, PLOTS
from app.panel.sharing import share
from app.panel.sharing.compare import ComparisonCalls
from app.scenes import NAMES
from app.server.viewer import Viewer
from tests.app.channels import say
from tests.app.student_lab import student_lab
from tests.waiting import wait_for

SAMPLE = ("rope", "radial_sea")  # whose panels are pressed in every run of the tests
CLIENT = 1
BUTTONS = (viser.GuiButtonHandle, viser.GuiButtonGroupHandle)
# Words of a button that confirm its action; the others show it elsewhere.
CONFIRMED = {share.KEEP: "Kept in the list", share.REMOVE: "Removed"}


class Camera(SimpleNamespace):
    """A camera with watchers, which need not be hashable."""

    def on_update(self, callback: object) -> None:
        """It never reports."""


class Client:
    """A browser as the panel's callbacks see it; it records messages to it."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self.client_id, self.gui, self.sent = CLIENT, gui, []
        self.camera = Camera(
            position=np.ones(3), look_at=np.zeros(3), up_direction=np.array([0.0, 0.0, 1.0]), fov=1.0, wxyz=np.ones(4),
            near=0.1, far=100.0, image_width=32, image_height=16,
        )  # fmt: skip

    def add_notification(self, *said: object, **how: object) -> SimpleNamespace:
        self.sent.append(said)
        return SimpleNamespace()

    def send_file_download(self, name: str, content: bytes, **how: object) -> None:
        self.sent.append((name, len(content)))

    def get_render(self, height: int, width: int, **how: object) -> np.ndarray:
        return np.full((height, width, 4), 255, np.uint8)

    def flush(self) -> None:
        """Nothing waits."""

    @property
    def state(self) -> object:
        return len(self.sent), [np.array(value).tolist() for value in vars(self.camera).values()]


class Pressed:
    """A scene with its panel, threads stopped so that nothing changes but by what is pressed."""

    def __init__(self, viewer: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
        self.viewer, self.panel = viewer, viewer.panel
        self.gui = viewer.server.gui
        self.client = Client(viewer.server.gui)
        self.posted: list[Command] = []
        self.asked: list[object] = []  # of the viewer
        monkeypatch.setattr(self.gui, "_resolve_client", lambda number: self.client)
        monkeypatch.setattr(viewer.settings, "post", self.posted.append)
        monkeypatch.setattr(viewer.settings, "open_scene", self.asked.append)
        monkeypatch.setattr(self.panel.recorder, "wake", self.update)
        assert self.panel.compare is not None
        asked = ComparisonCalls(lambda *given: self.asked.append(given), lambda: self.asked.append("end"), lambda: ())
        monkeypatch.setattr(self.panel.compare, "beside", asked)

    def buttons(self) -> Iterator[tuple[Any, str]]:
        """Handles of the visible buttons, with the name of each; a press may replace a handle."""
        for handle in list(self.gui._gui_input_handle_from_uuid.values()):
            if isinstance(handle, BUTTONS) and handle.visible:
                yield from ((handle, name) for name in getattr(handle, "options", ("",)))

    def press(self, handle: Any, name: str) -> None:
        """Pass a press on to viser, as from a browser; errors of the callback are raised here."""
        updates = {"value": name or True}
        coroutine = self.gui._handle_gui_updates(CLIENT, _messages.GuiUpdateMessage(handle._impl.uuid, updates))
        asyncio.run_coroutine_threadsafe(coroutine, self.viewer.server.get_event_loop()).result(60.0)
        files = self.panel.share.files
        wait_for(lambda: not files.busy.locked())
        self.update()

    def update(self) -> None:
        """Update the panel, as the viewer's thread does at each frame."""
        self.panel.status_at = self.panel.marks_at = 0.0
        self.panel.recorder.advance(time.monotonic())
        self.panel.update(self.viewer.loop.latest, [])

    def shown(self) -> object:
        """State visible to a user: the panel's texts and values, and what was sent, posted and requested."""
        handles = list(self.gui._gui_input_handle_from_uuid.values())
        texts = [getattr(handle, name, None) for handle in handles for name in ("options", "label", "visible")]
        lines = [line.content for line in self.panel.share.lines.values()]
        recorder, stability_map = self.panel.recorder, self.panel.controls_tab.map
        return (
            texts, [str(handle.value) for handle in handles if not isinstance(handle, BUTTONS)], lines,
            len(self.posted), len(self.asked), self.client.state, recorder.position, recorder.playing,
            stability_map and stability_map.asked, self.panel.guide and self.panel.guide.answer.content,
        )  # fmt: skip


@pytest.fixture
def students_lab(tmp_path: Path) -> Iterator[Viewer]:
    """`springtide lab DIR`, which has all tabs."""
    with student_lab(tmp_path / "mine") as (viewer, _):
        yield viewer


@pytest.mark.parametrize("name", [pytest.param(one, marks=() if one in SAMPLE else pytest.mark.long) for one in NAMES])
def test_every_button_of_every_tab_is_pressed(
    name: str, students_lab: Viewer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    viewer = students_lab
    viewer.visitors = lambda: [1]  # type: ignore[method-assign]
    viewer.open(name)
    wait_for(lambda: sum(kept.state is not None for kept in viewer.panel.recorder.all_frames()) > 1)
    viewer.served.stop_threads()
    pressed = Pressed(viewer, monkeypatch)
    pressed.panel.share.name.value = "Mine"
    assert pressed.panel.guide is not None
    pressed.panel.guide.workbook.go(3)  # not the first one, before which there is none
    pressed.update()
    done: list[tuple[object, str]] = []
    silent: list[str] = []
    while left := [press for press in pressed.buttons() if (press[0]._impl.uuid, press[1]) not in done]:
        handle, label = left[0]
        before = pressed.shown()
        pressed.press(handle, label)
        done.append((handle._impl.uuid, label))
        if pressed.shown() == before and label not in CONFIRMED.values():
            silent.append(label or handle.label)
        if label in CONFIRMED:
            assert CONFIRMED[label] in handle.options
    for topic, value in (("link", ""), ("save", ""), ("plots", PLOTS), ("plots", CHARTS)):
        before = pressed.shown()
        say(pressed.panel.share.channel, topic, value, client=pressed.client)
        wait_for(lambda before=before: pressed.shown() != before)
    say(pressed.panel.share.channel, "link", "", client=pressed.client)
    answers = [answer.number for answer in pressed.panel.share.channel._answers]
    assert len(set(answers)) == 2  # each press has a separate answer
    labels = [label for _, label in done]
    assert {*CONFIRMED, "Play", "Pause", "Step", "Reset"} <= {
        *labels,
        "Play" if "Pause" in labels else "Pause",
    }
    assert silent == []
    assert "Traceback" not in capsys.readouterr().err
