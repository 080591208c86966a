"""Undo across a preset, a reset or a new start: the run continues as if nothing had happened."""

from collections.abc import Callable

import numpy as np
import pytest

from app.messages import Begin, Checkpoint, GoBack, Pause, Play, Reset, Resume, StepOnce
from app.scenes import NAMES, scene_named
from app.scenes.setups import make_setup
from app.server.loop import run as runs
from app.server.loop.sim_loop import SimLoop
from app.server.viewer import Viewer
from tests.waiting import wait_for

TICKS = 12
TICK = 1 / 30  # [s]
SLOW = ("cloth", "mooring", "radial_sea")


def begun(name: str) -> SimLoop:
    """A scene that has run for a while and stands still, with costs that do not count."""
    loop = SimLoop(scene_named(name).make(make_setup(scene_named(name)).params), effort=lambda: 0.0)
    go_on(loop)
    loop.handle(Pause())
    return loop


def go_on(loop: SimLoop) -> None:
    for _ in range(TICKS):
        loop.tick(TICK)


def arrays_of(loop: SimLoop) -> dict[str, np.ndarray]:
    """The state of a scene."""
    found = {name: np.array(array) for name, (array, _) in loop.scene.arrays().items()}
    assert found
    return found


def check_same(loop: SimLoop, arrays: dict[str, np.ndarray]) -> None:
    for name, array in arrays_of(loop).items():
        np.testing.assert_array_equal(array, arrays[name], err_msg=name)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        pytest.param(name, change, marks=pytest.mark.long if name in SLOW and change == "preset" else ())
        for name in NAMES
        for change in ("preset", "reset", "moment")
    ],
)
def test_a_run_that_was_left_comes_back_and_goes_on_to_the_last_bit(name: str, change: str) -> None:
    kind = scene_named(name)
    loop, undisturbed = begun(name), begun(name)
    params, time, before = loop.scene.params, loop.scene.time, arrays_of(loop)
    rows = tuple(loop.run.snapshots.kept_rows)
    assert time > 0.0
    other = make_setup(kind, list(kind.presets)[1]).params
    moment = Resume(params, Checkpoint(loop.scene.keep(), {}, 1), 2)
    changes = {"preset": Begin(other, 2), "reset": Reset(2), "moment": moment}
    loop.handle(changes[change])
    loop.handle(Play())
    go_on(loop)
    number = loop.run.identity.number
    loop.handle(GoBack(params, 1, runs=True))
    assert (loop.scene.time, loop.run.running, loop.run.halted) == (time, False, "")
    assert loop.run.identity[:3] == (number + 1, 1, 0)  # so that the recording and the cameras are those of another run
    check_same(loop, before)
    loop.run.snapshots.publish()
    assert tuple(loop.run.snapshots.kept_rows)[: len(rows)] == rows
    for one in (loop, undisturbed):
        one.handle(StepOnce(5))
    check_same(loop, arrays_of(undisturbed))


def test_a_run_that_is_too_large_begins_again_and_the_panel_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runs, "MAX_BYTES", 1000.0)
    loop = begun("rope")
    params = loop.scene.params
    loop.handle(Begin(make_setup(scene_named("rope"), "Pendulum").params, 2))
    assert (len(loop.runs.left.runs), loop.runs.left.memory.bytes) == (0, 0)
    loop.handle(GoBack(params, 1, runs=True))
    assert (loop.scene.time, loop.run.running, loop.run.snapshots.status().restarted) == (0.0, True, True)
    loop.tick(10.0)
    assert not loop.run.snapshots.status().restarted


def test_the_words_on_a_run_that_is_not_kept_go_with_that_run(monkeypatch: pytest.MonkeyPatch) -> None:
    loop = begun("rope")
    params = loop.scene.params
    loop.handle(Reset(2))
    monkeypatch.setattr(runs, "MAX_BYTES", 0.0)
    loop.runs.left = runs.LeftRuns()
    loop.handle(GoBack(params, 1, runs=True))
    assert loop.run.snapshots.status().restarted
    loop.handle(Reset(3))
    assert not loop.run.snapshots.status().restarted


@pytest.mark.parametrize("change", ["undo", "moment"])
def test_a_speed_never_crosses_two_runs(change: str) -> None:
    loop = begun("rope")
    params, moment = loop.scene.params, loop.scene.keep()
    loop.handle(Play())
    go_on(loop)
    loop.handle(Reset(2))
    loop.handle(Play())
    loop.tick(0.1)
    command = GoBack(params, 1, runs=True)
    loop.handle(command if change == "undo" else Resume(params, Checkpoint(moment, {}, 1), 3))
    speeds: list[float | None] = []
    for _ in range(20):
        loop.tick(0.1)
        speeds.append(loop.latest.status.actual_speed)
    known = [speed for speed in speeds if speed is not None]
    assert speeds[0] is None
    assert len(known) > 10
    assert all(0.5 < speed < 1.5 for speed in known), known


def test_memory_is_bounded_and_the_oldest_go_first(monkeypatch: pytest.MonkeyPatch) -> None:
    loop = begun("rope")
    loop.handle(Reset(2))
    size = loop.runs.left.memory.bytes
    assert size == sum(loop.runs.left.runs[0].arrays.values()) > 0
    monkeypatch.setattr(runs, "MAX_BYTES", 3.5 * size)
    for act in range(3, 30):
        loop.handle(Reset(act))
        assert loop.runs.left.memory.bytes <= 3.5 * size
    assert loop.runs.left.runs[-1].act == 28
    assert loop.runs.left.pop(1) is None
    kept = [run.act for run in loop.runs.left.runs]
    assert kept == list(range(kept[0], 29))
    for act in kept:
        assert loop.runs.left.pop(act) is not None
    assert loop.runs.left.memory.bytes == 0


def test_a_run_that_never_began_leaves_the_one_before_untouched() -> None:
    """A preset whose kernels are still compiled, and an undo that comes first."""
    loop = begun("rope")
    time = loop.scene.time
    loop.handle(GoBack(loop.scene.params, 1, runs=True))
    assert (loop.scene.time, loop.run.identity.number) == (time, 1)


@pytest.mark.parametrize("change", [lambda lab: lab.settings.load("Pendulum"), lambda lab: lab.settings.reset()])
def test_undo_gives_back_the_screen(lab: Viewer, change: Callable[[Viewer], None]) -> None:
    """As a user meets it: a rope over the sphere, another preset or a reset, one step, undo."""
    lab.visitors = lambda: [1]  # type: ignore[method-assign]
    lab.settings.load("Over the sphere")
    wait_for(lambda: lab.loop.scene.time > 0.5 and lab.loop.run.running)
    lab.settings.post(Pause())
    wait_for(lambda: not lab.loop.run.running)
    time, before = lab.loop.scene.time, arrays_of(lab.loop)
    number = lab.loop.run.identity.number
    change(lab)
    lab.settings.post(StepOnce())
    wait_for(lambda: lab.loop.run.identity.number > number and not lab.loop.run.running)
    lab.settings.undo()
    # Its snapshot comes once the whole run is back.
    wait_for(lambda: (status := lab.loop.latest.status).run.number == number + 2 and status.time == time)
    check_same(lab.loop, before)
    assert not lab.loop.run.running
    assert lab.panel.head.preset.value == "Over the sphere"
