"""What the viewer's threads live through."""

import dataclasses
import re
import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.messages import GrabTo, Play, Reset, RunState, StepOnce, TogglePlay
from app.panel.recording.recorder import MAX_RATE
from app.scenes import scene_named
from app.scenes.ahead.compiling import Job
from app.scenes.rope import scene as rope_scene
from app.server.viewer import Viewer
from sim.parameters import check_record
from tests import coroutines
from tests.waiting import wait_for


def test_a_picture_that_cannot_be_drawn_halts_the_run_once_and_the_threads_live(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    def fail(picture: Any) -> None:
        raise ValueError("no such colour")

    monkeypatch.setattr(lab.view, "show", fail)
    lab.commands.put(StepOnce())
    wait_for(lambda: lab.loop.run.halted)
    assert lab.loop.run.halted == "The picture could not be drawn, ValueError: no such colour"
    wait_for(lambda: lab.served.shown_serial == lab.loop.latest.serial)
    assert all(thread.is_alive() for thread in lab.served.threads)
    assert capsys.readouterr().err.count("Traceback") == 1


@pytest.mark.parametrize("method", ["note", "follow", "advance"])
def test_an_error_anywhere_on_the_viewer_s_thread_halts_the_run_and_the_thread_lives(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    """Also outside of the drawing: an old picture with buttons that seem to work would be left."""
    own = getattr(lab.panel.recorder, method)
    errors = iter([MemoryError("no room for a frame")])

    def fail_once(*given: Any) -> Any:
        for error in errors:
            raise error
        return own(*given)

    monkeypatch.setattr(lab.panel.recorder, method, fail_once)
    lab.commands.put(StepOnce())
    wait_for(lambda: lab.loop.run.halted)
    assert lab.loop.run.halted.endswith(", MemoryError: no room for a frame")
    wait_for(lambda: lab.served.shown_serial == lab.loop.latest.serial)
    assert all(thread.is_alive() for thread in lab.served.threads)


def test_a_frame_of_the_recording_is_shown_and_then_the_present_again(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames: list[object] = []
    show = lab.view.show
    monkeypatch.setattr(lab.view, "show", lambda frame: (frames.append(frame), show(frame)))
    recorder = lab.panel.recorder
    for _ in range(3):
        kept = len(recorder.frames)
        time.sleep(1 / MAX_RATE)
        lab.commands.put(StepOnce())
        wait_for(lambda kept=kept: len(recorder.frames) > kept)
    recorder.step(-2)
    wait_for(lambda: frames and frames[-1] is recorder.frames[-3].frame)
    recorder.show_present()
    wait_for(lambda: frames[-1] is lab.loop.latest.frame)


@pytest.mark.parametrize("first_look", [False, True])
def test_a_scene_opens_with_its_defaults_and_at_a_first_look_with_what_moves(first_look: bool) -> None:
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open("rope", **({"first_look": True} if first_look else {}))
        kind = scene_named("rope")
        expected = kind.presets[kind.opening] if first_look else {}
        assert viewer.panel.settings.params == check_record(kind.params, expected)
        assert viewer.panel.compare is not None
        assert viewer.panel.compare.channel.state_of("panes") == []
    finally:
        viewer.shut()


def test_what_is_handed_over_is_not_held_back(lab: Viewer) -> None:
    buffer = lab.server._websock_server.get_message_buffer()
    assert "window_duration_sec" in {field.name for field in dataclasses.fields(buffer)}  # as viser names it
    assert buffer.window_duration_sec == 0.0


def test_the_first_picture_of_a_sea_of_another_size_leaves_the_camera_where_it_was_placed(lab: Viewer) -> None:
    kind = scene_named("square_sea")
    params = check_record(kind.params, {**kind.presets["Storm over"], "size": "64", "mesh": "32"})
    lab.open("square_sea", params, paused=True)
    view: Any = lab.view
    wait_for(lambda: view.last is not None)
    camera = lab.server.initial_camera
    np.testing.assert_allclose([camera.position, camera.look_at], lab.view.first_view(params))


class Client:
    """A browser, as viser's callbacks name it."""

    def __init__(self, client_id: int) -> None:
        self.client_id = client_id


def test_a_browser_that_goes_lets_go_of_what_it_held_and_of_nothing_else(lab: Viewer) -> None:
    scene: Any = lab.scene
    lab.commands.put(GrabTo(5, (0.0, 0.0, 2.0), client=1))
    wait_for(lambda: scene.handles.grab.grabbed is not None)
    coroutines.run(lab.release(Client(2)))  # type: ignore[arg-type]
    ticks = lab.loop.run.counts["ticks"]
    wait_for(lambda: lab.loop.run.counts["ticks"] > ticks + 3)
    assert scene.handles.grab.grabbed is not None
    coroutines.run(lab.release(Client(1)))  # type: ignore[arg-type]
    wait_for(lambda: scene.handles.grab.grabbed is None)


def panel_text(viewer: Viewer) -> str:
    """All HTML in the panel."""
    messages = viewer.server._websock_server.get_message_buffer().message_from_id.values()
    return " ".join(str(getattr(getattr(message, "props", None), "content", "")) for message in messages)


@pytest.mark.parametrize("where", ["scene", "view", "first frame"])
def test_a_scene_that_cannot_be_opened_leaves_a_page_that_says_why_and_offers_the_others(
    lab: Viewer, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    def fail(*_: Any) -> Any:
        raise MemoryError("no room for a cloth")

    kind = scene_named("cloth")
    if where == "scene":
        monkeypatch.setattr("app.server.viewer.scene_named", lambda name: replace(kind, make=fail))
    elif where == "view":
        monkeypatch.setattr("app.server.served_scene.view_named", lambda name: fail)
    else:
        monkeypatch.setattr(type(kind.make(kind.params())), "frame", fail)
    with pytest.raises(MemoryError):
        lab.open("cloth")
    assert lab.served.threads == []
    assert "cloth could not be opened" in panel_text(lab)
    assert "no room for a cloth" in panel_text(lab)
    monkeypatch.undo()
    lab.want("rope")
    wait_for(lambda: lab.is_open and lab.panel.kind.name == "rope" and lab.served.shown_serial > 0)


@pytest.fixture
def picky(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rope that cannot be built with one stiffness."""
    build = rope_scene.build

    def build_or_not(params: Any, *places: Any, **touch: Any) -> Any:
        if params.stiffness == 1234.0:
            raise ValueError("stiffness: 1234 is not allowed; allowed: another one")
        return build(params, *places, **touch)

    monkeypatch.setattr(rope_scene, "build", build_or_not)


@pytest.mark.parametrize("opened", [True, False])
def test_values_with_which_a_scene_cannot_begin_leave_its_panel_which_puts_them_right(
    lab: Viewer, picky: None, capsys: pytest.CaptureFixture, opened: bool
) -> None:
    """In a link or on the command line, and as a preset or a set-up of a scene that runs."""
    lab.visitors = lambda: [1]  # type: ignore[method-assign]
    wrong = check_record(scene_named("rope").params, {"stiffness": 1234.0, "points": 5})
    if opened:
        lab.open("rope", wrong)
    else:
        lab.settings.load_params(wrong, next(iter(lab.panel.kind.presets)))
    panel = lab.panel
    assert panel.settings.params == wrong
    assert panel.controls["stiffness"].field.value == "1234"
    wait_for(lambda: lab.loop.run.halted)
    said = "The scene cannot begin with these values. stiffness: 1234 is not allowed; allowed: another one"
    for command in (Play(), TogglePlay(), StepOnce(), GrabTo(3, (0.0, 0.0, 0.0)), Reset()):
        lab.commands.put(command)
        wait_for(lambda: lab.commands.empty() and not lab.loop.waiting)
        assert lab.loop.run.halted == said
        assert not lab.loop.run.running
    wait_for(lambda: said in panel.head.status.content)
    assert lab.loop.latest.status.state is RunState.UNMADE
    assert not panel.head.remedy.button.visible  # a shorter step does not help
    panel.settings.set("damping", 3.0)  # which alone would let the motion continue
    wait_for(lambda: lab.scene.params.damping == 3.0)
    assert lab.loop.run.halted == said
    panel.settings.set("stiffness", 500.0)
    wait_for(lambda: lab.loop.run.running and len(lab.loop.latest.frame.points) == 5)
    assert lab.loop.latest.status.time < 5.0
    assert (lab.scene.params.stiffness, lab.loop.run.halted) == (500.0, "")
    assert "Traceback" not in capsys.readouterr().err


def test_a_scene_comes_back_with_the_parameters_it_was_first_opened_with(lab: Viewer) -> None:
    params = check_record(scene_named("cloth").params, {"stiffness": 321.0})
    lab.open("cloth", params)
    lab.open("rope")
    lab.open("cloth")
    assert lab.settings.params == params


def test_of_several_scenes_asked_for_only_the_last_is_opened(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    make = lab.make
    monkeypatch.setattr(lab, "make", lambda name, *rest: (opened.append(name), make(name, *rest)))
    with lab.changing:  # whatever is asked for while a scene is being opened
        for name in ("cloth", "square_sea", "rope") * 100 + ("cloth",):
            lab.want(name)
        time.sleep(0.05)
    wait_for(lambda: lab.is_open and lab.panel.kind.name == "cloth" and lab.requests.waiting.empty())
    assert len(opened) <= 2


def test_ending_does_not_wait_for_a_long_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    viewer.loop.run.audience = lambda: 1
    solving, ended = threading.Event(), threading.Event()
    monkeypatch.setattr(viewer.scene, "advance", lambda steps: (solving.set(), ended.wait(10.0)))
    assert solving.wait(10.0)
    start = time.monotonic()
    viewer.shut()
    assert time.monotonic() - start < 3.0
    ended.set()


def test_ending_while_a_scene_is_opened_leaves_no_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    viewer = Viewer("127.0.0.1", 0)
    compiling, compiled = threading.Event(), threading.Event()
    monkeypatch.setattr(viewer.preparation, "compile", lambda *_, **__: (compiling.set(), compiled.wait(20.0)))
    opening = threading.Thread(target=viewer.open, args=("rope",))
    opening.start()
    assert compiling.wait(10.0)
    viewer.shut()
    compiled.set()
    opening.join(20.0)
    assert not opening.is_alive()
    assert viewer.current is None


def pretend_to_compile(viewer: Viewer, monkeypatch: pytest.MonkeyPatch, seen: list[str]) -> None:
    """The cloth has one piece to compile; while it is, what the page says is noted."""

    def wait(jobs: object, timeout: float) -> bool:
        if viewer.is_open:
            viewer.served.show_latest()
        seen.append(panel_text(viewer))
        return True

    monkeypatch.setattr(viewer.compiling, "missing", lambda name, params: [Job("cloth", "the solver", False)])
    monkeypatch.setattr(viewer.compiling, "want", lambda jobs: None)
    monkeypatch.setattr(viewer.compiling, "wait", wait)


def test_a_scene_goes_on_while_another_is_compiled_and_says_so(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []
    lab.served.stop_threads()
    pretend_to_compile(lab, monkeypatch, seen)
    lab.open("cloth")
    assert len(seen) == 1
    assert "compiling the solver" in seen[0]
    assert re.search(r"compiling the solver, \d s\. This is done once", seen[0])
    assert "springtide-panel" in seen[0]  # the scene before is still there
    assert "springtide-progress" not in seen[0]
    assert lab.panel.kind.name == "cloth"
    assert "compiling the solver" not in panel_text(lab)


def test_the_first_scene_covers_the_page_until_it_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []
    viewer = Viewer("127.0.0.1", 0)
    try:
        pretend_to_compile(viewer, monkeypatch, seen)
        viewer.open("cloth")
        assert "springtide-progress" in seen[0]
        assert "springtide-panel" not in seen[0]
        assert "springtide-progress" not in panel_text(viewer)
    finally:
        viewer.shut()


def test_plot_rows_of_snapshots_that_were_never_shown_reach_the_charts(lab: Viewer) -> None:
    lab.served.stop_threads()
    lab.loop.run.audience = lambda: 1
    lab.settings.set("plot_tip", True)
    for _ in range(30):
        lab.loop.tick(1 / 60)
    lab.loop.commands.put(Reset())
    for _ in range(20):
        lab.loop.tick(1 / 60)
    lab.served.show_latest()  # the only one
    times = [row[0] for row in lab.panel.plots.rows]
    assert len(times) >= 5
    assert times == sorted(times)
    assert times[0] == 0.0  # from the reset on: its mark has arrived too


def test_a_long_solve_is_said_in_the_status(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    said = threading.Event()
    monkeypatch.setattr(lab.scene, "advance", lambda steps: said.wait(30.0))
    lab.loop.run.audience = lambda: 1
    wait_for(lambda: "This step has taken" in lab.panel.head.status.content)
    said.set()


@pytest.mark.parametrize("count", [100, pytest.param(1000, marks=pytest.mark.stress)])
def test_presets_under_load_each_start_on_exactly_their_own_record(lab: Viewer, count: int) -> None:
    """Presets and sliders at once, as fast as they can be put, while the simulation runs."""
    lab.loop.run.audience = lambda: 1
    starts: list[Any] = []
    scene: Any = lab.scene
    reset = scene.reset
    scene.reset = lambda: (starts.append(scene.params), reset())
    presets = list(lab.panel.kind.presets)
    records = []
    for number in range(count):
        lab.settings.load(presets[number % len(presets)])
        records.append(lab.settings.params)
        lab.settings.set("gravity", 1.0 + number % 7)  # a hand on a slider right after
        if number % 10 == 0:
            time.sleep(0.005)
    allowed = {id(record) for record in records}
    wait_for(lambda: lab.scene.params is lab.settings.params)
    assert len(starts) > count / 50
    assert all(id(params) in allowed for params in starts)
    assert starts[-1] is records[-1]
