"""After any acts and undos of two browsers the screen is that of the act before: sequences against a model of history.

The model is a stack of screens. It knows which acts begin a run, and nothing of the program: no commands, no numbers,
no merging and no compiler.
"""

import dataclasses
import itertools
import queue
import random
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.messages import Checkpoint, Command, GrabTo, Place, Release, StepOnce, TogglePlay
from app.panel.settings import SceneSettings
from app.scenes import NAMES, scene_named
from app.scenes.ahead.compiling import Compiling, Job
from app.scenes.contract import Advice
from app.server.loop.commands import CompileGate
from app.server.loop.sim_loop import SimLoop
from app.server.loop.snapshots import kept_state

MAX_ACTS = 6
STEPS = 2
SMALL: dict[str, dict[str, Any]] = {
    "rope": {"points": 5},
    "cloth": {"rows": 4, "cols": 4},
    "race": {"ropes": 2, "points": 4},
    "square_sea": {"size": "32"},
    "radial_sea": {"wave_count": 4, "bodies": 1, "rings": 16, "spokes": 16},
    "mooring": {"lines": 1, "segments": 4},
}
FORCES = {
    "rope": ("stiffness", "gravity"), "cloth": ("stiffness", "gravity"), "race": ("mass", "gravity"),
    "square_sea": ("choppiness", "amplitude"), "radial_sea": ("wind_speed", "thickness"),
    "mooring": ("drag_across", "drag_along"),
}  # fmt: skip
STARTS = {"cloth": "gather", "race": "length", "square_sea": "length", "mooring": "length"}
PRESETS = 3
BROWSERS = (1, 2)
SLOW = ("mooring", "radial_sea")


@dataclasses.dataclass
class RunSeen:
    """A run of the model, as last seen."""

    time: float | None = 0.0  # [s]; None: it resumes from somewhere, and was not seen yet
    arrays: dict[str, np.ndarray] | None = None  # None: changed since it was seen
    running: bool = False
    act: int = 0  # the program's number of it; 0: not seen
    moments: list[tuple[Any, Checkpoint, float]] = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Screen:
    """What a person sees."""

    params: Any
    preset: str
    run: RunSeen
    running: bool | None  # None: of a run that came and went unseen


class Model:
    """The screen, and those before each act."""

    def __init__(self, params: Any, preset: str) -> None:
        self.screen = Screen(params, preset, RunSeen(), True)
        self.before: list[Screen] = []
        self.after: list[Screen] = []

    def act(
        self, params: Any, preset: str = "", *, begins: bool, runs: bool = False, run: RunSeen | None = None
    ) -> None:
        """An act that leads to these parameters."""
        now = self.screen
        now.run.running = bool(now.running)
        self.before.append(now)
        self.after.clear()
        if not begins:
            now.run.arrays = None
        self.screen = Screen(
            params, preset or now.preset, (run or RunSeen()) if begins else now.run, runs or now.running
        )

    def undo(self) -> None:
        """The screen before the last act; a run continues from where it is, or from where it was left."""
        self.go(self.before, self.after)

    def redo(self) -> None:
        """The screen after the act that was undone last."""
        self.go(self.after, self.before)

    def go(self, source: list[Screen], target: list[Screen]) -> None:
        if not source:
            return
        now, self.screen = self.screen, source.pop()
        now.run.running = bool(now.running)
        target.append(now)
        if self.screen.run is now.run:
            self.screen.running = now.running
            now.run.arrays = None
        else:
            self.screen.running = self.screen.run.running if self.screen.run.act else None


class Compiler(Compiling):
    """A compiler for which everything without a grid is missing again after each `finish`."""

    def __init__(self) -> None:
        super().__init__(1)
        self.epoch = 0

    def missing(self, name: str, params: Any) -> list[Job]:
        job = Job(name, f"kernel {self.epoch}", False)
        return [job] if not params.grid and job not in self.settled else []

    def want(self, jobs: object) -> None:
        pass


class Lab:
    """A scene, its settings and loop without threads, and the model beside them."""

    def __init__(self, name: str, rng: random.Random, *, compiles: bool) -> None:
        self.kind, self.rng = scene_named(name), rng
        self.params = dataclasses.replace(self.kind.params(), **SMALL[name])
        commands: queue.SimpleQueue[Command] = queue.SimpleQueue()
        server: Any = SimpleNamespace(get_clients=dict)
        self.settings = SceneSettings(server, self.kind, self.params, commands.put)
        self.loop = SimLoop(self.kind.make(self.params), commands, effort=lambda: 0.0, clock=lambda: 0.0)
        self.compiler = Compiler()
        self.gate = CompileGate(self.compiler, self.kind, self.loop.record, self.loop.runs.keep_dropped)
        if compiles:
            self.loop.admit = self.gate.admit
        self.model = Model(self.params, self.settings.loaded)
        self.see()

    # ----- acts

    def changed(self, name: str) -> Any:
        """Another value of a number, near that of the start."""
        value = getattr(self.params, name)
        return value * self.rng.choice([1.0, 1.01, 1.02, 1.03, 1.04]) if value else 0.01 * self.rng.random()

    def set(self, values: dict[str, Any], *, starts: bool = False) -> None:
        params = dataclasses.replace(self.model.screen.params, **values)
        if params != self.model.screen.params:
            self.model.act(params, begins=starts)
        self.settings.set_all(values, self.rng.choice(BROWSERS))
        self.later()

    def later(self) -> None:
        """Let a time pass after which a change of the same number is another act."""
        self.settings.history.changed_at -= 100.0  # [s]

    def look(self) -> None:
        self.set({"grid": not self.model.screen.params.grid})

    def force(self) -> None:
        name = self.rng.choice(FORCES[self.kind.name])
        self.set({name: self.changed(name)})

    def several(self) -> None:
        starts = STARTS.get(self.kind.name)
        names = [*FORCES[self.kind.name], *([starts] if starts else [])]
        values = {name: self.changed(name) for name in names}
        self.set(values, starts=bool(starts) and values[starts] != getattr(self.model.screen.params, starts))

    def start(self) -> None:
        name = STARTS.get(self.kind.name)
        if name is not None:
            value = self.changed(name)
            self.set({name: value}, starts=value != getattr(self.model.screen.params, name))

    def slide(self, browser: int) -> None:
        """A browser moves the slider that it holds, however long it takes: an act."""
        name = STARTS.get(self.kind.name, FORCES[self.kind.name][0])
        now, values = self.model.screen.params, []
        while not values or values[-1] == getattr(now, name):  # it ends elsewhere than it began
            values.append(self.changed(name))
        for value in values:
            self.settings.set(name, value, browser)
            self.later()
            if self.rng.random() < 0.3:
                self.loop.tick(0.0)
        self.model.act(dataclasses.replace(now, **{name: values[-1]}), begins=name in STARTS.values())

    def drag(self) -> None:
        """A slider from press to release."""
        browser = self.rng.choice(BROWSERS)
        self.settings.history.press(browser)
        self.slide(browser)
        self.settings.history.release(browser)
        self.later()

    def drag_beside_another(self) -> None:
        """A browser holds a slider, which the other changes too: each drag is an act."""
        holder, other = self.rng.sample(BROWSERS, 2)
        for browser in (holder, other):
            self.settings.history.press(browser)
        for browser in (holder, other, holder):
            self.slide(browser)
        for browser in (holder, other):
            self.settings.history.release(browser)
        self.later()

    def undo_under_a_hand(self) -> None:
        """The other browser undoes in the middle of a drag, which is another act from there on."""
        browser = self.rng.choice(BROWSERS)
        self.settings.history.press(browser)
        self.slide(browser)
        self.undo()
        self.slide(browser)
        self.settings.history.release(browser)
        self.later()

    def preset(self) -> None:
        number = self.rng.randrange(PRESETS)
        names = FORCES[self.kind.name]
        params = dataclasses.replace(
            self.params, grid=bool(number), **{names[0]: getattr(self.params, names[0]) * (1.0 + 0.01 * number)}
        )
        name = list(self.kind.presets)[min(number, len(self.kind.presets) - 1)]
        self.model.act(params, name, begins=True, runs=True)
        self.settings.load_params(params, name)

    def reset(self) -> None:
        self.model.act(self.model.screen.params, begins=True)
        self.settings.reset()

    def plots(self) -> None:
        self.settings.toggle_plots()
        self.model.act(self.settings.params, begins=False)
        names = [*self.kind.plots, *self.kind.curves]
        assert len({getattr(self.settings.params, name) for name in names}) == 1

    def advice(self) -> None:
        name = FORCES[self.kind.name][1]
        value = self.changed(name)
        self.model.act(dataclasses.replace(self.model.screen.params, **{name: value}), begins=True)
        self.settings.follow(Advice(name, value, ""))

    def moment(self) -> None:
        moments = self.model.screen.run.moments
        if moments:
            params, state, time = self.rng.choice(moments)
            run = RunSeen(time, None, moments=[one for one in moments if one[2] <= time])
            self.model.act(params, begins=True, runs=True, run=run)
            self.settings.resume(params, state)

    def pull(self) -> None:
        """A drag of a point or a body, from press to release."""
        if self.gate.held:
            self.settle()
        now = self.model.screen
        run = RunSeen(now.run.time, None, moments=list(now.run.moments))
        self.model.act(now.params, begins=True, run=run)
        for place in ((0.1, 0.0, 0.2), (0.2, 0.0, 0.2)):
            self.settings.drag(GrabTo(1, place, 7))
        self.settings.drag(Release(7))

    def place(self) -> None:
        """The same of something with arrows."""
        if self.gate.held:
            self.settle()
        now = self.model.screen
        run = RunSeen(now.run.time, None, moments=list(now.run.moments))
        self.model.act(now.params, begins=True, run=run)
        for x in (0.1, 0.2):
            self.settings.drag(Place("sphere", (x, 0.0, 0.2)))
        self.settings.history.number = ""  # later

    def undo(self) -> None:
        self.model.undo()
        self.settings.undo()

    def redo(self) -> None:
        self.model.redo()
        self.settings.redo()

    # ----- between acts

    def step(self) -> None:
        self.see()
        self.settings.post(StepOnce(STEPS))
        self.loop.tick(0.0)
        screen = self.model.screen
        screen.running = False
        assert screen.run.time is not None
        screen.run.time += STEPS * self.loop.scene.step
        screen.run.arrays = None
        self.see()

    def play(self) -> None:
        self.see()
        self.settings.post(TogglePlay())
        self.model.screen.running = not self.model.screen.running

    def settle(self) -> None:
        """Compile and handle everything that waits."""
        for _ in range(5):
            self.loop.tick(0.0)
            self.compiler.settled.add(Job(self.kind.name, f"kernel {self.compiler.epoch}", False))
        assert not self.gate.held
        assert self.loop.commands.empty()
        self.compiler.epoch += 1

    def see(self) -> None:
        """Compare the screen with that of the model."""
        self.settle()
        screen, loop, settings = self.model.screen, self.loop, self.settings
        run, scene, status = screen.run, loop.scene, loop.run.snapshots.status()
        assert not loop.run.halted
        assert settings.params == screen.params
        assert scene.params == screen.params
        assert settings.loaded == screen.preset
        screen.running = status.running if screen.running is None else screen.running
        assert status.running == screen.running
        assert run.act in (0, status.run.act)
        others = [before.run.act for before in self.model.before if before.run is not run]
        assert status.run.act not in others
        assert settings.history.act == status.run.act
        assert run.time == pytest.approx(scene.time, abs=1e-9)
        arrays = {name: np.array(array) for name, (array, _) in scene.arrays().items()}
        arrays.pop("foam", None)  # grows with each picture
        for name, array in (run.arrays or {}).items():
            np.testing.assert_array_equal(arrays[name], array, err_msg=name)
        if not any(np.isclose(time, run.time) for _, _, time in run.moments):
            run.moments.append((screen.params, kept_state(loop.run), run.time))
        run.arrays, run.act, run.running = arrays, status.run.act, screen.running


def play_sequence(name: str, seed: int, *, compiles: bool) -> None:
    rng = random.Random(f"{name} {seed} {compiles}")
    lab = Lab(name, rng, compiles=compiles)
    acts = [
        lab.look, lab.force, lab.several, lab.start, lab.drag, lab.drag_beside_another, lab.undo_under_a_hand,
        lab.preset, lab.reset, lab.plots, lab.advice, lab.moment, lab.pull, lab.place,
    ]  # fmt: skip
    for _ in range(rng.randint(1, MAX_ACTS)):
        rng.choice([*acts, *[lab.undo] * 4, *[lab.redo] * 2])()
        between = rng.random()
        if between < 0.25:
            lab.step()
        elif between < 0.35:
            lab.play()
        elif between < 0.6:
            lab.see()
        elif between < 0.8:
            lab.loop.tick(0.0)
    lab.see()
    while lab.model.before:
        lab.undo()
        if rng.random() < 0.7:
            lab.see()
    lab.undo()  # which does nothing
    lab.see()
    while lab.model.after:
        lab.redo()
        if rng.random() < 0.7:
            lab.see()
    lab.redo()
    lab.see()


@pytest.mark.parametrize(
    ("name", "compiles"),
    [
        pytest.param(name, compiles, marks=pytest.mark.long if name in SLOW and not compiles else ())
        for name in NAMES
        for compiles in (False, True)
    ],
)
def test_the_screen_after_acts_and_undos_is_that_of_the_act_before(name: str, compiles: bool) -> None:
    for seed in range(8):
        play_sequence(name, seed, compiles=compiles)


@pytest.mark.parametrize("undoes", ["another moment", "a reset", "a moment that waits, too"])
def test_an_undo_goes_back_to_a_moment_that_waited_for_the_compiler(undoes: str) -> None:
    lab = Lab("rope", random.Random(), compiles=True)
    lab.step()
    with_grid = lab.params, kept_state(lab.loop.run)
    lab.look()
    lab.step()
    without = lab.settings.params, kept_state(lab.loop.run)
    time = lab.loop.scene.time
    lab.look()
    lab.step()
    acts = {
        "another moment": lambda: lab.settings.resume(*with_grid),
        "a reset": lab.settings.reset,
        "a moment that waits, too": lambda: lab.settings.resume(*without),
    }
    lab.settings.resume(*without)
    lab.loop.tick(0.0)
    assert lab.gate.held
    acts[undoes]()
    lab.loop.tick(0.0)
    lab.settings.undo()
    lab.settle()
    status = lab.loop.run.snapshots.status()
    assert (status.time, status.running, status.restarted) == (time, True, False)
    assert lab.loop.scene.params == without[0]


@pytest.mark.stress
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("compiles", [False, True], ids=["", "compiled"])
@pytest.mark.parametrize("name", NAMES)
def test_the_screen_after_many_acts_and_undos_is_that_of_the_act_before(name: str, compiles: bool) -> None:
    """2,000 sequences in all."""
    for seed in itertools.islice(itertools.count(1000), 167):
        play_sequence(name, seed, compiles=compiles)
