"""The panel on a viser server without a browser."""

import asyncio
import inspect
import math
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
import viser

from app.messages import Begin, Change, Play, RunOn, RunState
from app.panel.controls.readings import WITHHELD
from app.scenes import NAMES, scene_named
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.square_sea.parameters import SquareSeaParams
from app.server.viewer import Viewer
from sim.parameters import check_record
from tests import coroutines
from tests.app.student_lab import student_lab
from tests.waiting import wait_for


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    viewer = Viewer("127.0.0.1", 0)
    yield viewer
    viewer.shut()


def callbacks(viewer: Viewer) -> Iterator[Callable[..., Any]]:
    """All that viser calls for what a browser does: with widgets, commands, and nodes of the scene."""
    gui, scene = viewer.server.gui, viewer.server.scene
    for widget in gui._gui_input_handle_from_uuid.values():
        yield from widget._impl.update_cb
    for command in gui._command_handle_from_uuid.values():
        yield from command._impl.trigger_cb
    for pointer in scene._scene_pointer_cb:
        yield pointer.callback
    for node in scene._handle_from_node_name.values():
        yield from (entry.callback for entry in (*node._impl.click_cb, *node._impl.drag_cb))
        if isinstance(node, viser.TransformControlsHandle):
            yield from node._impl_aux.update_cb


@pytest.fixture(scope="module")
def students_lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Viewer]:
    """`springtide lab DIR`: a workbook, and the panel of a student's functions."""
    with student_lab(tmp_path_factory.mktemp("lab") / "mine") as (viewer, _):
        yield viewer


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("lab_of", ["viewer", "students_lab"])
def test_every_callback_runs_on_the_one_event_loop(request: pytest.FixtureRequest, name: str, lab_of: str) -> None:
    """viser runs others in a pool of threads, where two changes of the parameters could lose each other."""
    viewer: Viewer = request.getfixturevalue(lab_of)
    viewer.open(name)
    wait_for(lambda: viewer.served.shown_serial > 0)
    found = list(callbacks(viewer))
    assert len(found) > 20
    assert [callback for callback in found if not inspect.iscoroutinefunction(callback)] == []


def test_the_panel_shows_at_once_that_the_scene_halts(lab: Viewer) -> None:
    """Anything else it shows a few times a second."""
    lab.served.stop_threads()
    lab.panel.update(lab.loop.latest, [])
    shown = lab.panel.head.status.content
    status = lab.loop.latest.status
    state = RunState.PAUSED if status.running else RunState.RUNNING
    other = lab.loop.latest._replace(status=status._replace(state=state))
    lab.panel.status_at = time.monotonic() + 1.0
    lab.panel.update(other, [])
    assert lab.panel.head.status.content != shown


def test_the_head_tells_how_long_a_step_takes_and_who_looks(lab: Viewer) -> None:
    lab.served.stop_threads()
    for busy, visitors in ((0.0, 1), (3.5, 1), (0.0, 4)):
        lab.panel.head.show(lab.loop.latest, busy, visitors)
        words = lab.panel.head.status.content
        assert ("This step has taken 3.5 s so far." in words) is (busy > 0.0)
        assert ("4 browsers share this lab." in words) is (visitors > 1)


def test_the_box_of_a_stop_speaks_of_the_values_that_are_set(lab: Viewer) -> None:
    """Words on a diverged run, with the value that would have been stable, go with that run's parameters."""

    def box() -> tuple[str, bool, bool]:
        head = lab.panel.head
        head.show(lab.loop.latest, 0.0, 1)
        words = head.status.content.partition("springtide-stopped")[2]
        return words, bool(head.remedy.button.visible), bool(head.again.visible)

    def change(stiffness: float, **also: object) -> None:
        lab.settings.set_all({"stiffness": stiffness, **also})
        lab.loop.tick(0.02)

    lab.open("rope")
    lab.served.stop_threads()
    lab.loop.run.audience = lambda: 1
    change(800.0)
    lab.loop.handle(Play())
    assert box() == ("", False, False)
    change(265_000.0)
    for _ in range(1000):
        if not lab.loop.latest.status.halted:
            lab.loop.tick(0.02)
    words, has_advice, can_reset = box()
    assert ("became unstable" in words, "of the largest stable one" in words, has_advice, can_reset) == (
        True,
        True,
        True,
        False,
    )
    change(800.0)
    words, has_advice, can_reset = box()
    assert "The run stopped with other values. These values are stable. Reset starts again." in words
    assert ("%" in words, has_advice, can_reset) == (False, False, True)
    change(500_000.0)
    words, has_advice, can_reset = box()
    assert ("These values are stable" in words, has_advice, can_reset) == (False, True, False)
    change(265_000.0)  # those of the run that stopped
    assert "became unstable" in box()[0]
    change(800.0)
    lab.settings.reset()
    lab.loop.tick(0.02)
    assert box() == ("", False, False)


@pytest.mark.parametrize("name", NAMES)
def test_the_help_says_how_buttons_are_reached_by_keys_on_a_mac(viewer: Viewer, name: str) -> None:
    viewer.open(name)
    viewer.served.stop_threads()
    words = viewer.panel.controls_tab.help.content
    assert "<b>Tab</b> to the next control, on a Mac to buttons with Option" in words


def test_lines_under_controls_are_written_some_times_a_second(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    lab.served.stop_threads()
    calls: list[object] = []
    monkeypatch.setattr(lab.panel.controls_tab, "show_marks", lambda *_: calls.append(None))
    lab.panel.marks_at = -math.inf
    for _ in range(5):
        lab.panel.update(lab.loop.latest, [])
    assert len(calls) == 1


@pytest.mark.parametrize("name", ["rope", "square_sea"])
def test_the_map_is_drawn_where_there_is_one(viewer: Viewer, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    viewer.open(name)
    viewer.served.stop_threads()
    tab, drawn = viewer.panel.controls_tab, []
    assert (tab.map is not None) is (name == "rope")
    if tab.map is not None:
        monkeypatch.setattr(tab.map, "draw", lambda: drawn.append(name))
    tab.show_marks(viewer.loop.latest, frozenset())
    assert drawn == ([name] if name == "rope" else [])


def test_notes_that_answer_a_question_are_withheld(viewer: Viewer) -> None:
    viewer.open("radial_sea")
    wait_for(lambda: viewer.panel.controls_tab.readings.notes)
    viewer.served.stop_threads()
    readings = viewer.panel.controls_tab.readings
    first, *_ = readings.notes
    for hidden in (frozenset({first}), frozenset[str]()):
        readings.show(viewer.loop.latest, hidden)
        withheld = {heading for heading, one in readings.notes.items() if WITHHELD in one.text.content}
        assert withheld == hidden


def test_a_line_under_a_hidden_control_is_hidden_too(lab: Viewer) -> None:
    lab.served.stop_threads()
    control = lab.panel.controls["sphere_radius"]
    assert not control.visible
    control.write("as wide as a ball")
    assert control.line is not None
    assert "as wide as a ball" in control.line.content
    assert not control.line.visible
    lab.settings.set("sphere", True)
    assert control.line.visible


def test_a_preset_is_loaded_once_by_its_key_and_once_from_the_list(lab: Viewer) -> None:
    posted: list[Any] = []
    panel = lab.panel
    panel.settings.post = posted.append
    before = panel.head.preset.value
    command = next(c for c in lab.server.gui._command_handle_from_uuid.values() if "Pendulum" in c._impl.props.label)
    pressed: list[Any] = command._impl.trigger_cb
    for callback in pressed:
        coroutines.run(callback(SimpleNamespace(target=command, client_id=1)))
    assert panel.head.preset.value == "Pendulum" != before
    time.sleep(0.3)  # viser tells of the assignment to the list, too
    assert posted == [Begin(panel.settings.params, panel.settings.history.act)]
    panel.head.preset.value = before
    chosen: list[Any] = panel.head.preset._impl.update_cb
    for callback in chosen:
        coroutines.run(callback(SimpleNamespace(target=panel.head.preset, client_id=1)))
    time.sleep(0.3)
    assert [type(command) for command in posted] == [Begin, Begin]


def test_a_mooring_whose_lines_are_too_short_offers_a_length_under_its_control(viewer: Viewer) -> None:
    viewer.open("mooring", check_record(scene_named("mooring").params, {"length": 40.0, "segments": 12}))
    panel = viewer.panel
    wait_for(lambda: "length" in panel.controls_tab.remedies.made)
    button = panel.controls_tab.remedies.made["length"].button
    assert (button.label, button.visible) == ("Use 84.5 m", True)
    assert panel.controls["length"].line is not None
    assert "cannot reach" in panel.controls["length"].line.content
    posted: list[Any] = []
    panel.settings.post = posted.append
    for callback in button._impl.update_cb:
        coroutines.run(callback(SimpleNamespace(target=button, client_id=1)))
    assert panel.settings.params.length == 84.5
    assert [type(command) for command in posted] == [Change]
    assert posted[0].params == panel.settings.params
    folders = [one.folder.order for one in panel.controls_tab.readings.notes.values()]
    assert list(panel.controls_tab.readings.notes) == ["Tensions", "Bed and slack"]
    assert panel.controls_tab.readings.readout.order < folders[0] < folders[1] < panel.controls.folders["Line"].order
    viewer.commands.put(posted[0])
    wait_for(lambda: not button.visible)
    assert "cannot reach" not in panel.controls["length"].line.content


SIMPLE = {  # scene -> parameters, what the panel says in a simple drawing, and a word of the key that it has else
    "rope": ({}, "no colours of the tension", "slack"),
    "mooring": ({"segments": 12}, "no colours of the tension", "slack"),
    "cloth": ({"rows": 8, "cols": 8, "colour": "strain"}, "no colours of the strain", "springtide-scale"),
}


@pytest.mark.parametrize("plain", [True, False])
def test_a_simple_drawing_has_no_key_to_colours_that_are_not_drawn_and_no_cutaway(plain: bool) -> None:
    lab = Viewer("127.0.0.1", 0, plain=plain)
    lab.visitors = lambda: [1]  # type: ignore[method-assign]
    try:
        for name, (values, said, key) in SIMPLE.items():
            lab.open(name, check_record(scene_named(name).params, values))
            wait_for(lambda: lab.served.shown_serial > 2 and lab.panel.controls_tab.readings.readout.content != "")
            text = lab.panel.controls_tab.readings.readout.content
            assert (said in text) == plain, name
            assert (key in text) != plain, name
        lab.open("radial_sea", RadialSeaParams(cutaway=True, particles=100, wave_count=16))
        line = lab.panel.controls["cutaway"]
        wait_for(lambda: lab.served.shown_serial > 2 and (line.text != "") == plain)
        assert ("no cutaway" in line.text) == plain
        assert (lab.view.walls is None) == plain
    finally:
        lab.shut()


def test_a_sea_that_is_stepped_offers_to_run_on_to_a_high_crest(viewer: Viewer) -> None:
    viewer.open("square_sea", SquareSeaParams(size="64", mesh="32"))
    panel = viewer.panel
    assert panel.controls_tab.run_on is not None
    assert not panel.controls_tab.run_on.visible
    panel.settings.set("order", 2)
    assert panel.controls_tab.run_on.visible
    posted: list[object] = []
    panel.settings.post = posted.append
    for callback in panel.controls_tab.run_on._impl.update_cb:
        asyncio.run(callback(SimpleNamespace(client_id=1, target=panel.controls_tab.run_on)))
    assert [type(command) for command in posted] == [RunOn]
    panel.settings.set("order", 1)
    assert not panel.controls_tab.run_on.visible
