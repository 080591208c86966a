"""Presets: shown as changed, loaded again, undone."""

from pathlib import Path

import pytest

from app.messages import Pause
from app.panel.history import EarlierSettings, History
from app.scenes.mooring.parameters import MooringParams
from app.scenes.rope.parameters import RopeParams
from app.server.viewer import Viewer


def test_a_changed_preset_says_so_and_can_be_loaded_again(lab: Viewer) -> None:
    panel = lab.panel
    first = panel.head.preset.value
    panel.settings.set("stiffness", 2000.0)
    assert panel.head.preset.value == f"{first} (changed)"
    assert first in panel.head.preset.options  # so that a browser can choose it
    panel.settings.load(first)
    assert panel.head.preset.value == first
    assert f"{first} (changed)" not in panel.head.preset.options
    assert panel.settings.params == RopeParams()


def test_a_change_of_the_look_leaves_the_preset_as_it_is(lab: Viewer) -> None:
    lab.settings.set("speed", 0.5)
    assert "changed" not in lab.panel.head.preset.value


def test_a_value_set_back_is_no_change(lab: Viewer) -> None:
    lab.settings.set("stiffness", 2000.0)
    lab.settings.set("stiffness", 800.0)
    assert "changed" not in lab.panel.head.preset.value


def test_a_file_is_named_in_place_of_the_preset() -> None:
    file = Path(__file__).parents[2] / "sim" / "mooring" / "moordyn" / "files" / "chain.txt"
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open("mooring", MooringParams(moordyn_file=str(file), time_step=1e-3))
        assert viewer.panel.head.preset.value == "chain.txt"
        viewer.settings.load(next(iter(viewer.panel.kind.presets)))
        assert "chain.txt" not in viewer.panel.head.preset.options
    finally:
        viewer.shut()


def test_a_preset_starts_running(lab: Viewer) -> None:
    lab.served.stop_threads()
    lab.loop.handle(Pause())
    lab.settings.load("Lab scene: 50 points")
    lab.loop.tick(0.0)
    assert lab.loop.run.running


def test_a_preset_and_a_change_can_be_undone(lab: Viewer) -> None:
    panel = lab.panel
    first = panel.head.preset.value
    panel.settings.set("stiffness", 2000.0)
    panel.settings.load("Lab scene: 50 points")
    panel.settings.undo()
    assert panel.settings.params == RopeParams(stiffness=2000.0)
    assert panel.head.preset.value == f"{first} (changed)"
    assert panel.controls["stiffness"].field.value == "2000"
    panel.settings.undo()
    assert panel.settings.params == RopeParams()
    panel.settings.undo()
    assert panel.settings.params == RopeParams()


def test_a_slider_that_is_moved_is_one_change() -> None:
    history = History()
    for stiffness in range(1, 50):
        history.note(EarlierSettings("rope", RopeParams(stiffness=float(stiffness)), "first"), number="stiffness")
    history.note(EarlierSettings("rope", RopeParams(mass=3.0), "first"), number="mass")
    now = EarlierSettings("rope", RopeParams(), "now")
    assert history.take_last(now) == EarlierSettings("rope", RopeParams(mass=3.0), "first")
    assert history.take_last(now) == EarlierSettings("rope", RopeParams(stiffness=1.0), "first")
    assert history.take_last(now) is None


def test_each_act_that_begins_a_run_has_a_number_to_which_undo_returns() -> None:
    history, settings = History(), EarlierSettings("rope", RopeParams(), "a")
    acts = ("points", True), ("mass", False), ("", True), ("", True), ("points", True)
    assert [history.note(settings, number=number, begins=begins) for number, begins in acts] == [2, 2, 3, 4, 5]
    assert history.note(settings, number="points", begins=True) == 5  # the same change
    back = [history.take_last(EarlierSettings("rope", RopeParams(), "now")) for _ in range(5)]
    assert [settings.act for settings in back if settings is not None] == [4, 3, 2, 2, 1]
    assert history.note(settings, begins=True) == 6  # no number comes twice


def test_a_drag_is_one_change_however_slow_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr("app.panel.history.time.monotonic", lambda: now)
    history, settings = History(), EarlierSettings("rope", RopeParams(), "a")

    def drag(waits: list[float], client: int) -> None:
        nonlocal now
        history.press(client)
        for wait in waits:
            now += wait
            history.note(settings, number="mass", client=client)
        history.release(client)

    drag([0.1, 1.5, 30.0], 1)
    history.note(settings, number="mass", client=1)  # what the page sent last comes after the release
    assert len(history.settings) == 1
    drag([0.2], 1)
    assert len(history.settings) == 2
    now += 1.5
    history.note(settings, number="mass", client=1)  # an arrow key
    now += 0.5
    history.note(settings, number="mass", client=1)
    assert len(history.settings) == 3
    history.press(2)
    history.release(3)
    now += 5.0
    history.note(settings, number="mass", client=2)
    now += 5.0
    history.note(settings, number="mass", client=2)
    assert len(history.settings) == 4
    now += 5.0
    history.release(2)  # or it has left
    now += 5.0
    history.note(settings, number="mass", client=2)
    assert len(history.settings) == 5


def test_changes_of_two_browsers_are_two_acts(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr("app.panel.history.time.monotonic", lambda: now)
    history, settings = History(), EarlierSettings("rope", RopeParams(), "a")
    for client in (1, 2, 1):  # of the same number, at once
        history.note(settings, number="mass", client=client)
    assert len(history.settings) == 3
    history.press(1)
    for count in (4, 5):  # another browser types meanwhile
        now += 5.0
        history.note(settings, number="mass", client=2)
        assert len(history.settings) == count
    history.note(settings, number="mass", client=1)
    history.press(2)  # and touches a slider
    now += 5.0
    history.note(settings, number="mass", client=1)
    assert len(history.settings) == 6
