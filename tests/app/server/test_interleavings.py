"""Two threads that meet at the worst moment, forced: each is held inside a call until the other has done its part.

`pytest -m stress` does the same 1,000 times.
"""

import itertools
import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest

from app.messages import Ask, Pause, Play, StepOnce
from app.scenes.ahead.compiling import Job
from app.scenes.contract import AnySnapshot
from app.scenes.rope.parameters import RopeParams
from app.scenes.setups import Setup
from app.server.beside import ComparedLabs
from app.server.served_scene import ServedScene
from app.server.viewer import Viewer

TIMES = pytest.mark.parametrize(
    "times", [10, pytest.param(1000, marks=[pytest.mark.stress, pytest.mark.timeout(1260)])]
)
TIMEOUT = 30.0  # [s] for a thread to come to a point


class Held:
    """A function, one call of which is held at its start until it is let go."""

    def __init__(self, function: Callable[..., Any], is_due: Callable[[], bool] = lambda: True) -> None:
        """is_due: whether the call that is made now is to be held."""
        self.function, self.is_due = function, is_due
        self.begun, self.free = threading.Event(), threading.Event()

    def __call__(self, *arguments: Any) -> Any:
        if not self.begun.is_set() and self.is_due():
            self.begun.set()
            assert self.free.wait(TIMEOUT)
        return self.function(*arguments)


def asked(viewer: Viewer, read: Callable[[], Any]) -> Any:
    """Result of a read between two steps, after all commands that were put before."""
    answer: Future[Any] = Future()
    viewer.commands.put(Ask(read, answer))
    return answer.result(TIMEOUT)


@pytest.fixture
def watched(lab: Viewer) -> Viewer:
    """A rope that somebody looks at."""
    lab.visitors = lambda: [1]  # type: ignore[method-assign]
    return lab


def outlast(thread: threading.Thread, held: Held) -> None:
    """Have a thread's held call take longer than anybody waits; it ends where somebody waits as long as it takes."""
    join = thread.join

    def join_or_give_up(timeout: float | None = None) -> None:
        if timeout is None:
            held.free.set()
            join(TIMEOUT)

    thread.join = join_or_give_up  # type: ignore[method-assign]


def fail(_: int) -> None:
    raise ValueError("a solve that ends badly")


@TIMES
@pytest.mark.parametrize("what", ["picture", "solve"])
def test_a_scene_that_is_opened_during_a_slow_one_has_nothing_of_the_old_scene(
    what: str, watched: Viewer, times: int
) -> None:
    """Open a scene while a thread of another is in a picture, or in a solve that fails in the end."""
    for number in range(times):
        old = watched.served
        solving, drawing = old.threads
        thread, held = (drawing, Held(old.view.show)) if what == "picture" else (solving, Held(fail))
        if what == "picture":
            old.view.show = held
        else:
            old.scene.advance = held
        assert held.begun.wait(TIMEOUT)
        outlast(thread, held)
        params = RopeParams(points=5 + number % 3)
        watched.open("rope", params)
        new = watched.served
        updates = noted_updates(new)
        held.free.set()
        threading.Thread.join(thread, TIMEOUT)
        assert not thread.is_alive()
        for _ in range(2):  # pictures
            assert updates.get(timeout=TIMEOUT) == (new.threads[1], params)
        status = asked(watched, new.loop.run.snapshots.status)
        assert not status.halted
        assert status.running


def noted_updates(served: ServedScene) -> "queue.SimpleQueue[tuple[threading.Thread, Any]]":
    """(thread, parameters of the snapshot) of each update of a scene's panel that begins from here on."""
    updates: queue.SimpleQueue[tuple[threading.Thread, Any]] = queue.SimpleQueue()
    update = served.panel.update

    def noted(snapshot: AnySnapshot, *rest: Any) -> None:
        updates.put((threading.current_thread(), snapshot.params))
        update(snapshot, *rest)

    served.panel.update = noted  # type: ignore[method-assign]
    return updates


class Settled(set[Job]):
    """Jobs that are compiled. One may be compiled just after somebody has looked that it is not."""

    def __init__(self) -> None:
        super().__init__()
        self.looks_left = -1  # looks until the job that is looked for is compiled; negative: it is not
        self.pause: Callable[[], None] = lambda: None  # between that and the answer, on any thread but the simulation's

    def __contains__(self, job: object) -> bool:
        found = super().__contains__(job)
        if not found:
            self.looks_left -= 1
            if self.looks_left == 0:
                self.add(job)  # type: ignore[arg-type]
                if threading.current_thread().name != "simulation":
                    self.pause()
        return found


def compiler_of(lab: Viewer, patch: pytest.MonkeyPatch) -> Settled:
    """Have RK4 compiled only where the test says so."""
    settled = Settled()

    def missing(name: str, params: Any) -> list[Job]:
        job = Job(name, "rk4", False)
        return [job] if params.integrator == "rk4" and not set.__contains__(settled, job) else []

    patch.setattr(lab.compiling, "missing", missing)
    patch.setattr(lab.compiling, "want", lambda jobs: None)
    patch.setattr(lab.compiling, "settled", settled)
    return settled


@TIMES
def test_a_preset_that_is_undone_while_it_is_compiled_never_begins(
    watched: Viewer, monkeypatch: pytest.MonkeyPatch, times: int
) -> None:
    """Undo a preset that waits for the compiler: it is never begun, and what follows is taken."""
    compiler_of(watched, monkeypatch)
    begun: list[Any] = []
    scene, panel, (undone, ready, *_) = watched.scene, watched.panel, watched.panel.kind.presets
    reset = scene.reset
    monkeypatch.setattr(scene, "reset", lambda: (begun.append(scene.params), reset()))
    for number in range(times):
        before, begun_runs = panel.settings.params, watched.loop.run.identity.number
        panel.settings.load_params(RopeParams(integrator="rk4", gravity=9.0), undone)
        assert asked(watched, lambda: scene.params) == before
        panel.settings.undo()
        assert asked(watched, lambda: scene.params) == before
        panel.settings.set("gravity", 1.0 + number % 7)
        assert asked(watched, lambda: scene.params.gravity) == 1.0 + number % 7  # type: ignore[attr-defined]
        assert watched.loop.run.identity.number == begun_runs
        assert not watched.loop.run.halted
        if number % 5 == 4:
            panel.settings.load_params(RopeParams(gravity=2.0), ready)
            assert asked(watched, lambda: watched.loop.run.identity.number) == begun_runs + 1
    assert all(params.integrator != "rk4" for params in begun)
    assert len(begun) == times // 5


@TIMES
def test_a_preset_that_settles_late_is_not_lost(watched: Viewer, monkeypatch: pytest.MonkeyPatch, times: int) -> None:
    """Have the compiler end just after somebody has looked: the preset is begun all the same."""
    settled = compiler_of(watched, monkeypatch)
    settled.pause = lambda: asked(watched, lambda: None)
    panel, preset = watched.panel, next(iter(watched.panel.kind.presets))
    for number in range(times):
        settled.clear()
        settled.looks_left = 1 + number % 4
        panel.settings.load_params(RopeParams(integrator="rk4", gravity=1.0 + number), preset)
        for _ in range(8):  # ticks
            asked(watched, lambda: None)
        assert watched.loop.run.identity.number == number + 2
        assert watched.scene.params is panel.settings.params
        assert not watched.loop.run.halted


@TIMES
def test_a_comparison_that_ends_in_a_tick_does_not_halt_the_lab(
    watched: Viewer, pane: Viewer, monkeypatch: pytest.MonkeyPatch, times: int
) -> None:
    """End a comparison while the first lab's tick is at the clock that both share."""
    setup, loop = Setup("rope", RopeParams(stiffness=2000.0), {}, ""), watched.loop
    for number in range(times):
        comparison = ComparedLabs(watched, lambda _: pane)
        comparison.begin([setup], resume=False)
        assert asked(watched, lambda: loop.run.seat) is comparison.seats[watched]
        with monkeypatch.context() as point:
            held = held_at_the_clock(watched, comparison, point, number % 3)
            assert held.begun.wait(TIMEOUT)
            comparison.end()
            held.free.set()
            status = asked(watched, loop.run.snapshots.status)
        assert not status.halted
        assert loop.run.seat is None
        watched.commands.put(Pause())
        time = asked(watched, lambda: loop.scene.time)
        watched.commands.put(StepOnce())
        assert asked(watched, lambda: loop.scene.time) == pytest.approx(time + loop.scene.step)
        watched.commands.put(Play())


def held_at_the_clock(lab: Viewer, comparison: ComparedLabs, point: pytest.MonkeyPatch, place: int) -> Held:
    """Hold the first lab's tick between the test for a seat and its use, while the clock runs, or in a step by hand."""
    loop, clock = lab.loop, comparison.clock
    if place == 0:
        looks = itertools.count()
        held = Held(loop.run.audience, lambda: loop.clock.busy_since is not None and next(looks) == 1)
        point.setattr(loop.run, "audience", held)
        return held
    name = ("advance", "step_by_hand")[place - 1]
    held = Held(getattr(clock, name))
    point.setattr(clock, name, held)
    if name == "step_by_hand":
        lab.commands.put(StepOnce())
    return held


@pytest.fixture
def pane(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A lab to show beside another; it is kept from one comparison to the next."""
    viewer = Viewer("127.0.0.1", 0)
    viewer.visitors = lambda: [1]  # type: ignore[method-assign]
    monkeypatch.setattr(viewer, "shut", lambda: None)
    yield viewer
    monkeypatch.undo()
    viewer.shut()
